"""Docstring of the class of an environment id, in Gymnasium's headings, from its task."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ship_gym.scenarios.scenario import Scenario, load_scenario
from ship_gym.tasks import observations_of, privileged
from ship_gym.tasks.base import Row, Task
from ship_gym.tasks.rewards import COSTS
from ship_gym.text import table

_ACTIONS = """\
`Box(-1, 1, (1,), float32)` for `control="rudder"`, `(2,)` for `control="rudder+rpm"`.

| Num | Action | Control | Meaning |
| --- | --- | --- | --- |
| 0 | rudder command | -1 to 1 | times delta_max (35 deg); positive turns to starboard |
| 1 | propeller speed command | -1 to 1 | -`astern` n_max to n_max; if absent: self-propulsion |

Values outside are limited; NaN or a wrong shape is an error. `ship_gym.DiscreteRudder` makes
the action a choice of rudder angles. The command passes a rate-limited steering gear and an
engine with lag; the agent sees what they did."""

_REWARDS = """\
Per control interval, each term times the interval in full-scale seconds; weights are keys of
the scenario's `reward` section, values are returned in `info["reward_terms"]`."""

_DIVERGED = """\
- Termination: the state is none of a ship any more (speed, turn or a number that is not finite):
  outcome `diverged`, with the `termination` term; the last state of a ship is kept."""

_ARGUMENTS = """\
- `ship`: one of `ship_gym.available_ships()`, the path of a ship file, or a `Ship`. Times, sea,
  noise and current of a model are Froude-scaled.
- `control`: `"rudder"` or `"rudder+rpm"`.
- `surrogate`: `"regression"`, `"gp"`, `"nn"` or another one of
  `ship_gym.available_surrogates(ship)`; the ship's default if None.
- `privileged`: append {privileged} entries about sea and forces, `ship_gym.tasks.privileged`.
- `scenario`: a name of `ship_gym.available_scenarios()`, a TOML file or a mapping.
- `overrides`: keys of the scenario (`docs/environments/scenarios.md`), nested or dotted;
  unknown keys are refused. `{{"sensors.noise": False}}` for exact measurements,
  `{{"randomisation.hull_std": 0.1}}` for another ship in each episode, `{{"failure.time": 100.0,
  "failure.rudder_rate": 0.5}}` for a drill.
- `render_mode`: `"rgb_array"` (plan view with instruments) or `"human"` (live in rerun).
- `info`: `"nested"`, or `"flat"` for libraries that keep no dicts (`docs/clients.md`).

`reset(options=...)` sets what an episode starts with instead of drawing it: `heading_error_deg`,
`speed` [m/s], `position` (north, east [m]), `sea_seed` (the sea of the episode of that seed;
encounter angles that the scenario gives count from this episode's order)."""


def docstring(task: Task) -> str:
    """Docstring in Gymnasium's headings; what the task's page does not say stands as it is."""
    scenario, text = load_scenario(task.name), _sections(task.page)
    parts = [
        task.title,
        "## Description",
        text.get("Description", task.title),
        "## Action Space",
        _ACTIONS,
        "## Observation Space",
        _observation(task, text.get("Observation Space", ""), scenario),
        "## Rewards",
        f"{_REWARDS} {text.get('Rewards', '')}".strip(),
        _rewards(task, scenario),
        "## Starting State",
        text.get("Starting State", "Straight course at U0 and self-propulsion, rudder amidships."),
        "## Episode End",
        f"{text.get('Episode End', _ends(task, scenario))}\n{_DIVERGED}",
        "## Arguments",
        _example(task),
        _ARGUMENTS.format(privileged=len(privileged.OBSERVATIONS)),
        "## Version History",
        text.get("Version History", f"- v{task.version}: first version."),
    ]
    return "\n\n".join(parts) + "\n"


def observation_table(rows: Sequence[Row], first: int = 0) -> str:
    """Rows of an observation as a Markdown table, numbered from `first` on."""
    header = ("Num", "Name", "Symbol", "Unit", "Min", "Max", "Meaning")
    cells = [
        (str(k), f"`{r.name}`", r.symbol, r.unit, f"{r.low:g}", f"{r.high:g}", r.meaning)
        for k, r in enumerate(rows, start=first)
    ]
    return table(header, cells, markdown=True)


def _sections(page: str) -> dict[str, str]:
    """Texts of a page by the heading they stand under."""
    parts = re.split(r"^## (.*)$", page, flags=re.M)
    return {head.strip(): text.strip() for head, text in zip(parts[1::2], parts[2::2], strict=True)}


def _observation(task: Task, words: str, scenario: Scenario) -> str:
    rows, sensors = observations_of(task.name), scenario.sensors
    measured = "Heading, yaw rate, sway velocity" + (" and position" if task.sees_position else "")
    sizes = f"{sensors.heading_deg:g} deg, {sensors.yaw_rate_deg_s:g} deg/s, {sensors.speed:g} m/s"
    sizes += f", {sensors.position:g} m" if task.sees_position else ""
    return "\n\n".join(
        [
            f"`Box(float32)` of shape `({len(rows)},)`. {words}".strip(),
            observation_table(rows),
            f"{measured} are measured with the wave-frequency motion on top\nof the slow motion "
            "that rewards and episode ends look at, and with the sensors' noise:\n"
            f"white, standard deviation {sizes} (estimates). `info` is exact.",
        ]
    )


def _rewards(task: Task, scenario: Scenario) -> str:
    terms = [(term, getattr(scenario.reward, term.name)) for term in (*task.terms, *COSTS)]
    return "\n".join(f"- `{term.name}`: -{weight:g} {term.form}" for term, weight in terms)


def _ends(task: Task, scenario: Scenario) -> str:
    lines = [f"- Termination: {text}." for text in task.ends(scenario)]
    return "\n".join([*lines, f"- Truncation: {scenario.duration:g} s (full scale), inside."])


def _example(task: Task) -> str:
    overrides = f"\n    overrides={dict(task.example)!r}," if task.example else ""
    return f"""\
```python
import gymnasium as gym, ship_gym

gym.make(
    "{task.env_id}",
    ship="kcs",
    control="rudder",
    surrogate=None,
    privileged=False,{overrides}
)
```""".replace("'", '"')
