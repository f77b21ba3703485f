"""pytest plugin of ``mutate.py``: runs the named tests only, in their order, each within a limit.

Settings come by environment variables: ``MUTATE_TESTS`` lists node ids, ``MUTATE_LIMIT`` is the
longest that one test may take [s] and ``MUTATE_TIMES`` a file to which each test that passed adds
a line of its time and its id.
"""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest


def pytest_collection_modifyitems(config, items):
    names = os.environ.get("MUTATE_TESTS")
    if not names:
        return
    order = {name: k for k, name in enumerate(Path(names).read_text().splitlines())}
    chosen = sorted((i for i in items if i.nodeid in order), key=lambda i: order[i.nodeid])
    config.hook.pytest_deselected(items=[i for i in items if i.nodeid not in order])
    items[:] = chosen


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem):
    limit = float(os.environ.get("MUTATE_LIMIT", "0"))
    if not limit:
        return (yield)
    signal.signal(signal.SIGALRM, _too_slow)
    signal.setitimer(signal.ITIMER_REAL, limit, 1.0)  # again, where hypothesis tries again
    try:
        return (yield)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _too_slow(*_):
    raise pytest.skip.Exception("too slow with kernels in Python")


def pytest_runtest_logreport(report):
    times = os.environ.get("MUTATE_TIMES")
    # where pytest-xdist runs the tests, its controller hears of all of them
    if (
        times
        and report.when == "call"
        and report.passed
        and "PYTEST_XDIST_WORKER" not in os.environ
    ):
        with open(times, "a") as stream:
            stream.write(f"{report.duration:.3f} {report.nodeid}\n")
