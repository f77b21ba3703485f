"""A served ship in a thread, and the autopilot of docs/examples/nmea_pid.py that steers her."""

import contextlib
import importlib.util
import threading
from pathlib import Path

import pytest

pytest.importorskip("pynmea2")
pytest.importorskip("pyproj")

from ship_gym_agents import make_controller
from ship_gym_agents.serve.ports import Ports
from ship_gym_agents.serve.server import Server
from ship_gym_agents.serve.vessel import SteeredShip

from ship_gym.charts import Chart

EXAMPLE = Path(__file__).resolve().parents[3] / "docs" / "examples" / "nmea_pid.py"
PATIENCE = 60.0  # [s]; a test that hangs ends


@pytest.fixture(scope="session")
def nmea_pid():
    spec = importlib.util.spec_from_file_location("nmea_pid", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def vessel(controller="pid", **given):
    return SteeredShip(make_controller(controller), **given)


@contextlib.contextmanager
def served(ship, chart=None, kinds=("tcp", "udp"), **how):
    """A server that sails in a thread; at the end it is stopped, and must end."""
    failed = []
    with Ports(port=0, kinds=kinds) as ports:
        server = Server(ship, ports, chart or Chart.about(54.0, 8.0), **how)

        def run():
            try:
                server.run()
            except BaseException as error:
                failed.append(error)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        try:
            yield server, ports, thread
        finally:
            server.stop()
            thread.join(PATIENCE)
            assert not thread.is_alive()
        if failed:
            raise failed[0]
