"""Capytaine, imported so that it prints nothing where results are printed."""

from __future__ import annotations

import logging
from types import ModuleType


def capytaine() -> ModuleType:
    """The library, with the logging of the process as it was.

    At its first import it gives the root logger a handler that writes to stdout, where ``--json``
    prints; its warnings of panels are ours to give (``hull_checks``).

    Raises
    ------
    ImportError
        It is not installed.
    """
    root = logging.getLogger()
    handlers, level = list(root.handlers), root.level
    import capytaine

    for handler in [added for added in root.handlers if added not in handlers]:
        root.removeHandler(handler)
    root.setLevel(level)
    logging.getLogger("capytaine").setLevel(logging.ERROR)
    return capytaine
