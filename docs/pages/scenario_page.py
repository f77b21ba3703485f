"""The page of the scenarios: their files, and every key with default, unit and meaning."""

from __future__ import annotations

import dataclasses
import json
import re
import typing
from collections.abc import Mapping
from itertools import takewhile
from pathlib import Path

from pages.docstrings import Field, fields, intro, table
from pages.headroom import INTRO, headroom_table
from ship_gym.config import merged
from ship_gym.envs.env import ShipEnv
from ship_gym.scenarios import Scenario, available_scenarios, load_scenario, scenario, sea_range
from ship_gym.scenarios.scenario import scenario_class, stated
from ship_gym.sea.spectra import WaveSystem
from ship_gym.sea.state import Sea
from ship_gym.tasks import TASKS

FOLDER = Path(scenario.__file__).parent
_INTRO = """\
A scenario says everything that an environment is: task, ship, times, sea, limits, rewards. Choose
one, replace some of its keys, or write one:

```toml
# my_scenario.toml: only what differs from its base
base = "heading_ss5_beam"
ship = "dtc"

[sea]
current_speed = 0.5
```

```python
import gymnasium as gym, ship_gym

gym.make("ShipGym/HeadingKeeping-v0", scenario="heading_ss5_beam")
gym.make("ShipGym/HeadingKeeping-v0", overrides={"sea.states": ["ss5"], "reward.rudder": 0.5})
gym.make("ShipGym/HeadingKeeping-v0", scenario="my_scenario.toml")
```

Unknown keys and values that are not allowed are refused; the message names the nearest key, or
says what is allowed.

A fleet is one scenario sailed by several ships, each in the same seas: `ShipVectorEnv(64,
ship=["kcs", "kvlcc2", "onrt"])` trains one policy on all of them, and a benchmark over `--ships`
judges one controller on each."""

# where a key is explained whose own class refers to another one ("As in ...") or says nothing
_ELSEWHERE = {Scenario: (ShipEnv,), sea_range.SeaRange: (WaveSystem, Sea)}
_SUFFIXES = {"_deg": "deg", "_deg_s": "deg/s"}  # of names outside SI
_UNIT = re.compile(r" ?\[([^\]]+)\]")


@dataclasses.dataclass(frozen=True)
class Key:
    """One key of a scenario.

    Attributes
    ----------
    name : str
        As in ``overrides``, e.g. ``sea.states``.
    unit : str
        Empty where its class states none.
    meaning : str
        Markdown.
    """

    name: str
    unit: str
    meaning: str


def keys_of(cls: type, prefix: str = "") -> list[Key]:
    """Keys of one section (or of the top level), as its class documents them."""
    inner = section_classes() if cls is Scenario else ()
    names = [field.name for field in dataclasses.fields(cls) if field.name not in inner]
    return [_key(prefix, name, _explained(name, cls)) for name in names]


def section_classes() -> dict[str, list[type]]:
    """Name to classes of the sections of the scenarios; tasks may have a class of their own."""
    found: dict[str, list[type]] = {}
    for task in TASKS.own():
        for name, cls in typing.get_type_hints(scenario_class(TASKS[task])).items():
            if dataclasses.is_dataclass(cls) and cls not in found.setdefault(name, []):
                found[name].append(cls)
    return found


def section_keys(section: str) -> list[Key]:
    """Keys of a section, as the first of its classes that has one documents it."""
    keys = [keys_of(cls, f"{section}.") for cls in section_classes()[section]]
    return list({key.name: key for part in reversed(keys) for key in part}.values())


def all_keys() -> dict[str, Key]:
    """Every key of a scenario by name, those without a section first."""
    found = keys_of(Scenario)
    for section in section_classes():
        found += section_keys(section)
    return {key.name: key for key in found}


def value_of(resolved: Scenario, name: str) -> typing.Any:
    """Value of a dotted key."""
    value: typing.Any = resolved
    for part in name.split("."):
        value = getattr(value, part)
    return value


def has_key(resolved: Scenario, name: str) -> bool:
    """Whether a scenario has a dotted key."""
    try:
        value_of(resolved, name)
    except AttributeError:
        return False
    return True


def shown(value: typing.Any) -> str:
    """A value as a scenario file has it, in Markdown."""
    return "not set" if value is None else f"`{json.dumps(value)}`"


def stated_keys(name: str) -> list[str]:
    """Dotted keys that a scenario of the package or one of its bases states, in their order.

    Without those of a base that only the base's task has.
    """
    resolved = load_scenario(name)
    return [key for key in _dotted(_values(name)) if has_key(resolved, key)]


def page() -> str:
    """The page in Markdown."""
    outside = TASKS.outside()
    names = [name for name in available_scenarios() if name not in outside]
    files = [[f"`{name}`", _base(name), _comment(name)] for name in names]
    defaults = {task.partition("_")[0]: load_scenario(task) for task in TASKS.own()}
    parts = [
        "# Scenarios",
        _INTRO,
        "## Scenarios of the package",
        "A name or a file; where a base is given, the scenario is that one but for what it states.",
        table(("Name", "Base", "What it is"), files),
        "## Headroom",
        f"{INTRO} Scenarios that are not here are in no standard suite: controllers do not differ "
        "in them, or nothing is measured yet.",
        headroom_table(),
        "## Every key",
        "Lengths, times and speeds are those of the full-scale ship, unless a meaning says "
        "otherwise; a model gets them Froude-scaled. Defaults that differ between the tasks name "
        "the task. A unit that is not in the table is in the meaning, or there is none.",
        "### Top level",
        _key_table(keys_of(Scenario), defaults),
    ]
    for section, classes in section_classes().items():
        keys = section_keys(section)
        parts += [f"### [{section}]", intro(classes[0]), _key_table(keys, defaults)]
    return "\n\n".join(parts) + "\n"


def _key_table(keys: list[Key], defaults: Mapping[str, Scenario]) -> str:
    rows = [[f"`{k.name}`", _default(k.name, defaults), k.unit, k.meaning] for k in keys]
    return table(("Key", "Default", "Unit", "Meaning"), rows)


def _default(name: str, defaults: Mapping[str, Scenario]) -> str:
    """Default of a key; where the tasks differ or not all have it, one for each that has."""
    values = {
        task: shown(value_of(resolved, name))
        for task, resolved in defaults.items()
        if has_key(resolved, name)
    }
    if len(values) == len(defaults) and len(set(values.values())) == 1:
        return next(iter(values.values()))
    return ", ".join(f"{task}: {value}" for task, value in values.items())


def _explained(name: str, cls: type) -> Field:
    """What the class of a key says about it, or the class that it refers to."""
    nothing = Field((name,), "")
    own = fields(cls).get(name, nothing)
    if _UNIT.sub("", own.text) and not own.text.startswith("As "):
        return own
    others = (fields(other).get(name, nothing) for other in _ELSEWHERE.get(cls, ()))
    return next((other for other in others if other.text), nothing)


def _key(prefix: str, name: str, field: Field) -> Key:
    """Key with its unit, that of its name or the one in the text; names sharing a text lead it."""
    units = _UNIT.findall(field.text)
    unit = next((u for end, u in _SUFFIXES.items() if name.endswith(end)), None)
    if unit is None:
        unit = units[0] if len(units) == 1 else ""
    text = _UNIT.sub("", field.text).strip() if units == [unit] else field.text
    if text and len(field.names) > 1:
        text = f"{', '.join(f'`{n}`' for n in field.names)}: {text[0].lower()}{text[1:]}"
    return Key(prefix + name, unit, text)


def _values(name: str) -> dict[str, typing.Any]:
    """Values of a scenario of the package on top of those of its bases, as the files state them."""
    values = stated(name)
    base = values.pop("base", None)
    return values if base is None else merged(_values(base), values)


def _dotted(values: Mapping[str, typing.Any], prefix: str = "") -> list[str]:
    """Dotted names of nested keys."""
    names: list[str] = []
    for key, value in values.items():
        is_section = isinstance(value, Mapping)
        names += _dotted(value, f"{prefix}{key}.") if is_section else [f"{prefix}{key}"]
    return names


def _base(name: str) -> str:
    base = stated(name).get("base")
    return "" if base is None else f"`{base}`"


def _comment(name: str) -> str:
    """First comment lines of a scenario file."""
    lines = (FOLDER / f"{name}.toml").read_text(encoding="utf-8").splitlines()
    return " ".join(line.lstrip("# ") for line in takewhile(lambda x: x.startswith("#"), lines))
