"""docs/examples/nmea_pid.py as it stands."""

import json
import runpy
import sys

import pytest

pytest.importorskip("pynmea2")
pytest.importorskip("pyproj")

from .conftest import EXAMPLE, PATIENCE, served, vessel

pytestmark = pytest.mark.compiled


@pytest.mark.parametrize("kind", ["tcp", "udp"])
def test_the_example_holds_a_heading(monkeypatch, capsys, kind):
    ship = vessel(duration=240.0)
    with served(ship, lockstep=True, patience=PATIENCE) as (server, ports, thread):
        arguments = ["--port", str(ports.port), "--heading", "15", "--orders", "240", "--json"]
        monkeypatch.setattr(sys, "argv", ["nmea_pid.py", *arguments, *["--udp"] * (kind == "udp")])
        runpy.run_path(str(EXAMPLE), run_name="__main__")
        thread.join(PATIENCE)  # the last order is under way
    found = json.loads(capsys.readouterr().out)
    assert found["orders"] == server.sailed == 240
    assert found["heading_error_deg"] < 1.0
    assert server.plain()["clients"] == {kind: 1}


def test_nobody_there_is_one_line(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["nmea_pid.py", "--port", "1"])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(EXAMPLE), run_name="__main__")
    assert end.value.code == 2
    assert capsys.readouterr().err == "error: 127.0.0.1 port 1: Connection refused\n"
