"""ship-gym serve: ends in order, refuses before it listens, records."""

import json
import os
import signal
import socket
import sys
import threading
import time
from pathlib import Path

import pytest

pytest.importorskip("pynmea2")
pytest.importorskip("pyproj")

pytestmark = pytest.mark.compiled
QUICK = ("--port", 0, "--speed-up", 1000)


def test_sails_and_tells(cli):
    code, out, err = cli("serve", *QUICK, "--duration", 5, "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["intervals"] == 50 and found["ended"] == "end of time"
    assert found["sent"]["HDT"] == 51 and found["sent"]["RMC"] == 6
    assert {address for _, address, _ in found["listened"]} == {"127.0.0.1"}
    port = found["listened"][0][2]
    assert err == f"NMEA 0183 on 127.0.0.1 port {port}, TCP and UDP; Ctrl-C ends the voyage\n"
    text = cli("serve", *QUICK, "--duration", 1, "--only", "udp")[1]
    assert "served on udp 127.0.0.1:" in text and "sent     GGA 2, HDT 11" in text


def test_a_voyage_is_recorded(cli):
    pytest.importorskip("rerun")
    from ship_gym.charts import Chart
    from ship_gym.recording import Trajectory

    record = ("serve", *QUICK, "--duration", 3, "--interval", 0.5, "--record", "a.rrd")
    code, out, err = cli(*record, "--at", 60, 5)
    assert code == 0, err
    assert "wrote a.rrd\nnext: ship-gym review show a.rrd" in out
    kept = Trajectory.from_file("a.rrd")
    assert len(kept) == 7 and kept.meta["controller"] == "nmea"
    assert kept.meta["complete"] and kept.meta["outcome"] == "end of time"
    assert Chart.from_meta(kept.meta["chart"]).place(0.0, 0.0) == (60.0, 5.0)
    assert kept.meta["frame"].startswith("x north, y east [m] in the plane about the place")
    assert cli("review", "export", "a.rrd", "--out", "a.geojson")[0] == 0
    line = json.loads(Path("a.geojson").read_text())["geometry"]
    assert line["coordinates"][0][:2] == [5.0, 60.0]
    assert cli(*record)[0] == 0  # the same again
    code, _, err = cli(*record, "--seed", 5)
    assert code == 2 and "--record a.rrd: holds a recording of nmea" in err
    assert cli(*record, "--seed", 5, "--force")[0] == 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("how", [["--speed-up", "10"], ["--lockstep"]])
def test_a_signal_ends_it_in_order(cli, number, how):
    before = signal.getsignal(number)
    free = socket.socket()
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
    free.close()

    def interrupt():
        end = time.monotonic() + 120.0
        while time.monotonic() < end:
            try:
                with socket.create_connection(("127.0.0.1", port), 1.0) as wire:
                    wire.recv(10)  # it sails
                    os.kill(os.getpid(), number)
                    return
            except OSError:
                time.sleep(0.02)

    thread = threading.Thread(target=interrupt)
    thread.start()
    code, out, err = cli("serve", "--port", port, *how, "--json")
    thread.join()
    assert code == 0, err
    assert json.loads(out)["ended"] == "stopped"
    assert signal.getsignal(number) == before


def test_a_port_beyond_this_machine_is_warned_of(cli):
    code, out, err = cli("serve", *QUICK, "--duration", 1, "--listen", "0.0.0.0", "--json")
    assert code == 0, err
    warning, _ = err.splitlines()
    assert warning.startswith("warning: listening on 0.0.0.0: whoever reaches port ")
    assert json.loads(out)["listened"][0][1] == "0.0.0.0"


ROUTE = {
    "type": "LineString",
    "coordinates": [[8.0, 54.0], [8.1, 54.05], [8.3, 54.05]],
}


def test_a_route_brings_xte_and_apb(cli, tmp_path):
    (tmp_path / "route.geojson").write_text(json.dumps(ROUTE))
    code, out, err = cli("serve", *QUICK, "--duration", 1, "--route", "route.geojson", "--json")
    assert code == 0, err
    found = json.loads(out)
    assert found["sent"]["APB"] == found["sent"]["XTE"] == 2
    assert 40.0 < found["now"]["heading_deg"] < 60.0  # of the first leg


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--listen", "localhost"], "listen = 'localhost': must be an IP address"),
        (["--scenario", "track_calm"], "is of task track_following, not heading_keeping"),
        (["--rate", "HDX=1"], "sentence of --rate 'HDX'"),
        (["--rate", "HDT=fast"], "--rate HDT=fast: must be KIND=VALUE, a number from 0 to 1000"),
        (["--talker", "HDT=gp"], "--talker HDT=gp: must be KIND=VALUE, two letters"),
        (["--udp-to", "127.0.0.1"], "--udp-to 127.0.0.1: must be an IP address and a port"),
        (["--udp-to", "192.0.2.1:2000"], "cannot be reached from 127.0.0.1; see --listen"),
        (["--udp-to", "127.0.0.1:2000", "--only", "tcp"], "with --only tcp there is no UDP"),
        (["--route", "none.rtz"], "none.rtz"),
        (["--controller", "pidd"], "did you mean 'pid'"),
        (["--duration", "1e6", "--interval", "0.01"], "interval = 0.01: allowed is 0.05"),
        (["--at", "95", "0"], "--at"),
        (["--patience", "3"], "--patience 3: is of --lockstep"),
        (["--lockstep", "--speed-up", "10"], "--speed-up 10: in --lockstep"),
        (["--speed-up", "0"], "--speed-up = 0: allowed is 0.01 to 10000"),
    ],
)
def test_bad_options_are_one_line(cli, arguments, words):
    code, out, err = cli("serve", "--duration", 1, "--port", 0, *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and words in err, err
