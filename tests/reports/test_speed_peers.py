"""Other simulators: called as they document it, skipped where they are not, never fatal."""

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from ship_gym.reports import speed_peers
from ship_gym.reports.speed_child import Work


def module(monkeypatch, name, **content):
    made = ModuleType(name)
    made.__dict__.update(content)
    monkeypatch.setitem(sys.modules, name, made)
    return made


def test_missing_and_broken_ones_are_told(monkeypatch):
    def broken():
        raise AttributeError("renamed")

    monkeypatch.setattr(
        speed_peers,
        "PEERS",
        {
            "no_such_simulator": ("a step", None, "there"),
            "json": ("a step", broken, "there"),
            "math": ("a step", lambda: Work(lambda k: sum(range(1000)), 10), "there"),
        },
    )
    monkeypatch.setattr(speed_peers, "OURS", {})
    missing, failed, found = speed_peers.measure_peers(1, 0.001)
    assert missing["seconds"] is None and missing["reason"] == "not installed (there)"
    assert failed["seconds"] is None and failed["reason"] == "failed: AttributeError: renamed"
    assert found["seconds"] > 0.0


def test_mmgdynamics_gets_back_what_it_gave(monkeypatch):
    given = []

    def pstep(X, pos, vessel, dT, nps, delta, psi, water_depth, fl_psi, fl_vel, w_vel, beta_w):
        given.append((X, pos, psi, dT))
        return [X[0] + 1.0, 0.0, 0.0], (pos[0] + 1.0, 0.0, psi + 0.1)

    module(monkeypatch, "mmgdynamics", pstep=pstep, Vessel=SimpleNamespace)
    module(monkeypatch, "mmgdynamics.calibrated_vessels", kvlcc2_l64={"L": 64.0})
    work = speed_peers.mmgdynamics()
    for k in range(3):
        work.call(k)
    assert given[2] == ([5.85, 0.0, 0.0], [2.0, 0.0], pytest.approx(0.2), 1.0)


def test_vehicle_simulator_gets_back_what_it_gave(monkeypatch):
    class ShipClarke83:
        nu, u_actual = np.zeros(6), np.zeros(1)

        def stepInput(self, t):
            return np.ones(1)

        def dynamics(self, eta, nu, u_actual, u_control, sampleTime):
            return nu + u_control, u_actual + sampleTime

    seen = []

    def attitude(eta, nu, dt):
        seen.append((eta[0], nu[0], dt))
        return eta + nu * dt

    module(monkeypatch, "python_vehicle_simulator")
    module(monkeypatch, "python_vehicle_simulator.lib")
    module(monkeypatch, "python_vehicle_simulator.lib.gnc", attitudeEuler=attitude)
    module(monkeypatch, "python_vehicle_simulator.vehicles", shipClarke83=ShipClarke83)
    work = speed_peers.python_vehicle_simulator()
    for k in range(3):
        work.call(k)
    assert seen == [(0.0, 1.0, 1.0), (1.0, 2.0, 1.0), (3.0, 3.0, 1.0)]


def test_shipmmg_turns_our_kvlcc2():
    """Steady turn of the 7 m model under 10 deg in it: she turns and keeps most of her speed."""
    shipmmg = pytest.importorskip("shipmmg.mmg_3dof", reason="extra 'peers' not installed")
    basic, derivatives, speed, n = speed_peers.shipmmg_ship()
    time = np.arange(101.0)
    found = shipmmg.simulate_mmg_3dof(
        basic, derivatives, time, np.full(101, np.radians(10.0)), np.full(101, n), u0=speed
    ).sol(100.0)
    assert 0.6 * speed < found[0] < speed
    assert abs(found[2]) == pytest.approx(0.06, rel=0.5)
    assert speed_peers.shipmmg().items == 100
