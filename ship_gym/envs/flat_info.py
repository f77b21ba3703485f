"""Infos without dicts inside, for clients that keep each entry as an array, such as TorchRL."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ship_gym.config import check_known

FORMS = ("nested", "flat")


def is_flat(form: str) -> bool:
    """Whether the option ``info`` of an environment asks for flat infos.

    Raises
    ------
    ConfigError
        Not one of `FORMS`.
    """
    check_known("info", form, FORMS)
    return form == "flat"


def flat(info: Mapping[str, Any]) -> dict[str, Any]:
    """A plain dict of numpy numbers and arrays: the entry b of the dict a becomes ``a.b``.

    Parameters
    ----------
    info : mapping
        Of one environment, or of a batch in Gymnasium's form, each key with a ``_key`` mask; the
        masks of a dict's entries take its place (``_a.b``).
    """
    found: dict[str, Any] = {}
    for key, value in info.items():
        if isinstance(value, Mapping):
            for name, entry in value.items():
                masks = name.startswith("_")
                found[f"_{key}.{name[1:]}" if masks else f"{key}.{name}"] = _array(entry)
        elif not isinstance(info.get(key[1:]), Mapping):  # else the mask of a dict
            found[key] = _array(value)
    return found


def _array(value: Any) -> Any:
    """The value itself if it is an array, else a numpy number.

    True and False are arrays of no dimension: of numpy's own, Gymnasium's SyncVectorEnv would make
    an array of objects.
    """
    if isinstance(value, np.ndarray):
        return value
    made = np.asarray(value)
    return made if made.dtype == np.bool_ else made[()]
