"""Who does the parts of a large work: this process, others of this machine, or a Ray cluster.

The work is that of a benchmark, whose units are sailed, unless another is given. All three call the
same function, so that what they find is the same. Each yields (number, result) in the order in
which parts are finished; closing the iterator ends what is still under way.
"""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, NamedTuple

from ship_gym.config import ConfigError, check_known
from ship_gym.evaluation.unit import lost, sail
from ship_gym.provenance import git_commit, versions

ENGINES = ("local", "ray")
_DIED = "the process of the controller ended"
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

Units = Mapping[int, Any]
Found = Generator[tuple[int, Any], None, None]


class Work(NamedTuple):
    """What is done with each unit; both functions and all units are sent to other processes.

    Attributes
    ----------
    do : callable
        Result of a unit.
    lost : callable
        Result of a unit whose process ended, from the unit and a text that says so.
    """

    do: Callable[[Any], Any]
    lost: Callable[[Any, str], Any]


SAILING = Work(sail, lost)


def engine_of(
    name: str, jobs: int, address: str | None, work: Work = SAILING
) -> Callable[[Units], Found]:
    """The engine of a name, ready to do units by their numbers.

    Raises
    ------
    ConfigError
        An unknown engine, or an address without Ray.
    ImportError
        Ray is asked for and not installed; says how to install it.
    """
    if check_known("engine", name, ENGINES) == "ray":
        ray = _ray()
        return lambda units: on_ray(ray, units, jobs, address, work)
    if address is not None:
        raise ConfigError(f"address = {address!r}: only the engine 'ray' has one")
    if jobs == 1:
        return lambda units: in_this_process(units, work)
    return lambda units: in_processes(units, jobs, work)


def in_this_process(units: Units, work: Work = SAILING) -> Found:
    """Do units one after the other here."""
    for number, unit in units.items():
        yield number, work.do(unit)


def in_processes(units: Units, jobs: int, work: Work = SAILING) -> Found:
    """Do units in processes of this machine, each with one thread.

    A controller may end its process. The units that were under way then are done again, each in a
    process of its own; the one that ends that too is lost.
    """
    waiting = dict(units)
    while waiting:
        under_way: dict[Future, int] = {}
        try:
            for number, sailed in _pooled(dict(waiting), jobs, under_way, work):
                del waiting[number]
                yield number, sailed
        except BrokenProcessPool:
            for number in under_way.values():
                yield number, _alone(waiting.pop(number), work)


def _alone(unit: Any, work: Work) -> Any:
    try:
        return next(_pooled({0: unit}, 1, {}, work))[1]
    except BrokenProcessPool:
        return work.lost(unit, _DIED)


def _pooled(units: Units, jobs: int, under_way: dict[Future, int], work: Work) -> Found:
    """Do units in a pool; `under_way` holds those that are, no more than the pool can take."""
    context, before = multiprocessing.get_context("spawn"), set(multiprocessing.active_children())
    with _environment(_ONE_THREAD):
        pool = ProcessPoolExecutor(min(jobs, len(units)), context, begin_worker)
        todo = iter(units.items())
        try:
            while True:
                while len(under_way) < jobs and (item := next(todo, None)) is not None:
                    under_way[pool.submit(work.do, item[1])] = item[0]
                if not under_way:
                    return
                for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                    result = future.result()
                    yield under_way.pop(future), result
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in set(multiprocessing.active_children()) - before:
                process.terminate()


@contextlib.contextmanager
def _environment(variables: Mapping[str, str]) -> Iterator[None]:
    """Environment variables for processes that are started meanwhile."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def begin_worker() -> None:
    """In a process of a pool: leave Ctrl-C to the parent, and end with it, however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end_with_parent() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()


def _ray() -> Any:
    try:
        import ray
    except ImportError:
        raise ImportError('engine ray needs ray: pip install "ship-gym[ray]"') from None
    return ray


def on_ray(ray: Any, units: Units, jobs: int, address: str | None, work: Work = SAILING) -> Found:
    """Do units as Ray tasks: on the cluster at `address`, or on `jobs` workers of this machine.

    Raises
    ------
    ConfigError
        No cluster there, or one of its machines runs another version of this package.
    """
    started = not ray.is_initialized()
    if started:
        _start(ray, jobs, address)
    remote = ray.remote(num_cpus=1)(_do_there)
    todo = iter(units.items())
    under_way: dict[Any, Any] = {}
    try:
        while True:
            while len(under_way) < 2 * jobs and (item := next(todo, None)) is not None:
                under_way[remote.remote(work.do, item[1], code())] = item
            if not under_way:
                return
            for reference in ray.wait(list(under_way))[0]:
                number, unit = under_way.pop(reference)
                yield number, _answer(ray, reference, unit, work)
    finally:
        for reference in under_way:
            ray.cancel(reference, force=True)
        if started:
            ray.shutdown()


def _start(ray: Any, jobs: int, address: str | None) -> None:
    where = {"num_cpus": jobs, "include_dashboard": False} if address is None else {}
    try:
        ray.init(address=address or "local", log_to_driver=False, logging_level="error", **where)
    except (ConnectionError, ValueError) as error:
        raise ConfigError(f"--address {address}: no Ray cluster answers there: {error}") from None


def _answer(ray: Any, reference: Any, unit: Any, work: Work) -> Any:
    """What a task gave; a unit that ends its worker again and again is lost."""
    try:
        answer = ray.get(reference)
    except ray.exceptions.WorkerCrashedError:
        return work.lost(unit, _DIED)
    if isinstance(answer, ConfigError):
        raise answer
    return answer


def _do_there(do: Callable[[Any], Any], unit: Any, expected: tuple[str, str]) -> Any:
    """Do a unit on a machine of the cluster; an error that a user can mend is given back."""
    if code() != expected:
        return ConfigError(
            f"a machine of the cluster runs ship-gym {' '.join(code())}, this one "
            f"{' '.join(expected)}: install the same on both"
        )
    try:
        return do(unit)
    except ConfigError as error:
        return error


@functools.cache
def code() -> tuple[str, str]:
    """Version and commit of the package in this process."""
    return versions()["ship-gym"], git_commit()
