"""docs/policy_forms.md: its examples load and reset, its table names every block and action."""

import re
import tomllib
from pathlib import Path

import pytest
from ship_gym_agents.forms import Helm, form_from
from ship_gym_agents.forms import features as features_module
from ship_gym_agents.forms.actions import ACTIONS
from ship_gym_agents.forms.features import BLOCKS, PRODUCTS

from ship_gym import load_scenario, load_ship

PAGE = (Path(__file__).parents[3] / "docs" / "policy_forms.md").read_text(encoding="utf-8")
FORMS = [
    found["form"]
    for found in map(tomllib.loads, re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL))
    if "form" in found
]


def scenario_for(form):
    if form.base == "just_in_time":
        return "track_economy"
    return "track_following" if form.base == "drift_los" else "heading_keeping"


@pytest.mark.parametrize("values", FORMS)
def test_examples_can_be_sailed(values):
    helm = Helm(form_from(values))
    helm.reset(2, load_ship("kcs"), load_scenario(scenario_for(helm.form)))
    assert len(helm.names) == len(helm.signs) > 0


def test_every_block_and_action_is_in_the_tables():
    assert len(FORMS) == 6
    for name in (*BLOCKS, PRODUCTS, *ACTIONS):
        assert re.search(rf"^\| `{name}` \|", PAGE, re.MULTILINE), name
    for name in (*BLOCKS, PRODUCTS):
        assert f"\n``{name}``" in features_module.__doc__, name
