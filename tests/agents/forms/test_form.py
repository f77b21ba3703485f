"""Forms from configuration: defaults, and one clear line for what does not go together."""

import dataclasses

import pytest
from ship_gym_agents.forms import Form, form_from

from ship_gym.config import ConfigError


def test_an_empty_section_is_the_plain_policy():
    assert form_from({}) == Form() == Form("direct", "", 1.0, 0.0, 1, ("observation",), (), False)


def test_a_form_goes_through_a_card():
    form = form_from({"action": "guidance", "base": "drift_los", "scale": 0.5, "lags": [1, 4]})
    assert form_from(dataclasses.asdict(form)) == form
    lists = {k: list(v) if isinstance(v, tuple) else v for k, v in vars(form).items()}
    assert form_from(lists) == form  # as JSON gives it back


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"actoin": "direct"}, "did you mean 'action'"),
        ({"action": "residul"}, "unknown form.action 'residul'; did you mean 'residual'"),
        ({"features": ["observr"], "base": "pid"}, "did you mean 'observer'"),
        ({"features": []}, "at least one block"),
        ({"features": ["products"]}, "at least one block besides 'products'"),
        ({"features": ["observation", "observation"]}, "each is allowed once"),
        ({"action": "residual"}, "form.base is empty: action = 'residual' needs"),
        ({"action": "guidance"}, "form.base is empty: action = 'guidance' needs"),
        ({"features": ["observer"]}, "form.base is empty: the block 'observer'"),
        ({"features": ["route"]}, "form.base is empty: the block 'route'"),
        ({"scale": 0.5}, "with action = 'direct' the decision is the whole action"),
        ({"action": "increment", "scale": 0.0}, "form.scale = 0: a decision would do nothing"),
        ({"action": "increment", "scale": 1.5}, "form.scale = 1.5: allowed is 0 to 1"),
        (
            {"action": "guidance", "base": "pid", "scale": 30.0},
            "form.scale = 30.0: allowed is 0 to",
        ),
        ({"every": 0}, "form.every = 0: allowed is 1 to"),
        ({"lags": [0]}, "form.lags = (0,): allowed are 1 to"),
        ({"lags": [2, 2]}, "each is allowed once"),
        ({"filter_noise": 0.3}, "form.filter_noise = 0.3 without form.base: allowed is 1"),
        ({"filter_noise": 0.0, "base": "pid"}, "form.filter_noise = 0.0: allowed is 0.01 to 100"),
    ],
)
def test_what_does_not_go_together_is_refused(values, message):
    with pytest.raises(ConfigError) as told:
        form_from(values)
    assert message in str(told.value)
