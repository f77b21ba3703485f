"""What is compiled does what its Python source says: the same voyages, interpreted."""

import inspect
import json

import numpy as np
import pytest

from tests.recipes.recipe import ROOT, run


def voyage():
    """States, observations and rewards of two ships in a seaway, one with two propellers."""
    import numpy as np

    import ship_gym

    sea = {"sea.wave_height": 3.0, "sea.peak_period": 9.0, "sea.spreading": 1.0}
    wind = {"sea.states": [], "sea.wind_speed": 15.0, "sea.gusts": True, "sea.current_speed": 1.0}
    failure = {"failure.time": 3.0, "failure.rudder_rate": 0.5, "failure.heading_bias_deg": 3.0}
    env = ship_gym.ShipVectorEnv(
        2, ship=["kcs", "onrt"], privileged=True, overrides={**sea, **wind, **failure}
    )
    observations, _ = env.reset(seed=3)
    sim, rows = env.episodes.sim, [observations.tolist()]
    for k in range(12):
        observations, rewards, *_ = env.step(np.full((2, 1), 1.0 if k < 6 else -0.5))
        rows.append([observations.tolist(), rewards.tolist()])
    return {"rows": rows, "state": sim.state.tolist(), "waves": sim.waves.tolist()}


def flat(values):
    """All numbers of nested lists."""
    if isinstance(values, list):
        return [x for value in values for x in flat(value)]
    return [values]


@pytest.mark.compiled  # interpreted, it would be compared with itself
def test_compiled_is_interpreted():
    """Within 1e-9, relative; float32 observations too."""
    code = f"{inspect.getsource(voyage)}\nimport json\nprint(json.dumps(voyage()))"
    python, compiled = json.loads(run(code, ROOT)), voyage()
    for name in compiled:
        one, other = flat(compiled[name]), flat(python[name])
        assert len(one) == len(other) > 10
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9, err_msg=name)
