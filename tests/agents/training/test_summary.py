import pytest
from ship_gym_agents.sb3.config import run_config
from ship_gym_agents.training.summary import summary


def card(samples, seconds, **last):
    found = {"J_steady": 2.0, "return": -1.0, "success": 1.0, "rudder_travel": 9.0, "samples": 0}
    return {
        "samples": samples,
        "seconds": seconds,
        "validation_seeds": [400_000, 400_015],
        "validations": [found, {**found, **last}],
        "best": found,
        "score": "lower is better",
    }


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (card(5000, 10.0), "5000 samples in 10 s of training, 500 per second"),
        (card(5000, 0.0), "5000 samples in 0 s of training"),
        (
            card(5000, 3.0, iteration=0.0),
            "5000 samples in 3 s of training: ended before the first iteration was complete, so "
            "nothing was learned",
        ),
        (card(5000, 10.0, iteration=1.0), "5000 samples in 10 s of training, 500 per second"),
    ],
)
def test_how_long_it_took_and_whether_anything_was_learned(given, line):
    text = summary(run_config(), given, "run").splitlines()
    assert text[0] == line
    assert text[1] == "validation on 16 seas, J_steady [deg2]: 2  2"
