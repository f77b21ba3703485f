"""What a table of results says of how it was made: the parts that its readers take, checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ship_gym.keys import Keys

_PARTS = ("command", "controllers", "suites", "refused", "recordings")
_FILES = ("suite", "scenario", "ship")  # keys above those of controllers, of recorded files


def check_about(about: Any, where: str) -> dict[str, Any]:
    """The mapping, of these parts without what is null; all may be missing, as in older tables.

    Parameters
    ----------
    about : mapping
    where : str
        The file, for the message.

    Raises
    ------
    ConfigError
        An entry of another type than its readers take; says which.
    """
    given = Keys(about, where).values
    parts = {key: _without_null(given[key]) for key in _PARTS if given.get(key) is not None}
    rest = {key: value for key, value in given.items() if key not in _PARTS}
    said = Keys(rest | parts, where)
    said.text("command", "")
    for _, controller in said.table("controllers", {}).tables({}):
        controller.text("named", "")
        controller.text("kind", "")
    for _, suite in said.table("suites", {}).tables({}):
        for part in ("controls", "tasks"):
            _check_texts(suite.table(part, {}))
    for number, one in enumerate(said.items("refused", [])):
        refused = Keys(one, where, f"refused[{number}]")
        for key in ("controller", "why", "scenario", "ship"):
            refused.text(key)
    _check_files(said.table("recordings", {}).table("files", {}), len(_FILES))
    return dict(said.values)


def _check_texts(texts: Keys) -> None:
    for key in texts.values:
        texts.text(key)


def _check_files(files: Keys, depth: int) -> None:
    """Tables in tables, the innermost of names of files."""
    if depth == 0:
        return _check_texts(files)
    for _, inner in files.tables():
        _check_files(inner, depth - 1)


def _without_null(value: Any) -> Any:
    """Nested mappings without the keys that stand for nothing."""
    if not isinstance(value, Mapping):
        return value
    return {key: _without_null(one) for key, one in value.items() if one is not None}
