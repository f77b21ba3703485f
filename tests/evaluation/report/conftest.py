"""Made-up results of a benchmark: no ship sails, so that the report alone is tested."""

import numpy as np
import pytest

from ship_gym.evaluation.episodes_table import Results, table_of
from ship_gym.evaluation.metrics import metrics_of
from ship_gym.tasks import TASKS

SCENARIOS = {
    "heading_keeping": ("heading", "basic", "heading_keeping"),
    "heading_ss6_quartering": ("heading", "seaway", "heading_keeping"),
    "course_changing": ("course", "basic", "course_changing"),
}
SHIPS = ("kcs", "kvlcc2")
SEEDS = range(2_000_000, 2_000_008)
# controller -> kind, error of the measure by that of doing nothing, wear
CONTROLLERS = {
    "constant": ("classical", 1.0, 1.0),
    "pid": ("classical", 0.25, 120.0),
    "lqg": ("classical", 0.22, 150.0),
    "ppo_kcs": ("policy", 0.3, 300.0),
    "mine": ("own", 0.28, 90.0),
}


def row(scenario, ship, controller, seed, rng):
    """One episode; `mine` breaks every fourth one of kvlcc2 off."""
    suite, tier, task = SCENARIOS[scenario]
    kind, share, wear = CONTROLLERS[controller]
    measure = TASKS[task].headline
    found = {
        "suite": suite, "version": "ShipBench-1", "scenario": scenario, "tier": tier, "task": task,
        "ship": ship, "controller": controller, "kind": kind, "seed": seed, "measure": measure,
        "wave_height": 3.0, "wave_period": 9.0, "wave_encounter_deg": 45.0 * (seed % 8) - 175.0,
        "wind_speed": 10.0, "wind_encounter_deg": 0.0, "current_speed": 0.0, "error": "",
        "decision_ms": 0.1 * len(controller),
    }  # fmt: skip
    if controller == "mine" and ship == "kvlcc2" and seed % 4 == 3:
        error = "mine, seed 2000003, interval 17: ZeroDivisionError: <division> by zero"
        return found | {"outcome": "error", "failed": True, "length": 17, "error": error}
    sea = 40.0 * (1.0 + 0.3 * np.sin(seed)) * (2.0 if ship == "kvlcc2" else 1.0)
    value = sea * share * rng.lognormal(0.0, 0.05)
    metrics = {name: value * (k + 1.0) for k, name in enumerate(metrics_of(task))}
    metrics |= {"rudder_travel": wear * rng.lognormal(0.0, 0.1), "rudder_reversals": wear / 2.0}
    metrics |= {"success": 1.0, measure: value, "speed_loss": 0.1}
    end = {"outcome": "end of time", "failed": False, "length": 600, "value": value}
    return found | metrics | end


def made_up(controllers=tuple(CONTROLLERS), scenarios=tuple(SCENARIOS), seeds=SEEDS):
    """Results of some controllers; the policy sails kcs alone."""
    rng = np.random.default_rng(0)
    rows = [
        row(scenario, ship, controller, seed, rng)
        for scenario in scenarios
        for ship in SHIPS
        for controller in controllers
        if controller != "ppo_kcs" or ship == "kcs"
        for seed in seeds
    ]
    about = {
        "suites": {"heading": {"sha256": "0" * 64}},
        "seeds": list(seeds),
        "controllers": {
            "pid": {"kind": "classical", "source": "gains/pid_kcs.toml"},
            "ppo_kcs": {"kind": "policy", "trained on": {"ship": "kcs", "samples": 2_000_000}},
        },
        "versions": {"python": "3.13", "ship-gym": "0.1.0"},
        "machine": {"cpu": "a <processor> & more", "cores": 2},
        "command": "ship-gym benchmark --suite heading",
    }
    return Results(table_of(rows), about)


@pytest.fixture(scope="session")
def results():
    return made_up()


@pytest.fixture(scope="session")
def many():
    """Enough episodes for small p-values."""
    return made_up(seeds=range(2_000_000, 2_000_024), scenarios=("heading_keeping",))
