"""Parts of a batch in threads."""

import itertools
import os
import threading
import time

import pytest

import ship_gym
from ship_gym.physics import _threads
from ship_gym.physics._threads import BLOCK, in_parts, parts_of
from ship_gym.physics.step import thread_of


@pytest.mark.parametrize("n", [1, 63, 64, 65, 129, 1000, 4096])
@pytest.mark.parametrize("parts", [1, 2, 3, 16])
def test_parts_cover_every_ship_once_in_whole_blocks(n, parts):
    made = parts_of(n, parts)
    assert made[0][0] == 0 and made[-1][1] == n and len(made) <= parts
    assert all(a[1] == b[0] for a, b in itertools.pairwise(made))
    assert all(first % BLOCK == 0 and first < last for first, last in made)
    sizes = [last - first for first, last in made]
    assert max(sizes) - min(sizes) <= 2 * BLOCK


def test_each_part_is_run_and_an_error_of_one_is_raised():
    seen = set()

    def call(first, last):
        seen.add(threading.current_thread().name)
        return last - first

    assert sum(in_parts(call, 1000, 3)) == 1000 and len(seen) > 1
    assert in_parts(call, 1000, 1) == [1000]

    def wrong(first, last):
        if first > 0:
            raise ValueError("wrong")
        return 0

    with pytest.raises(ValueError, match="wrong"):
        in_parts(wrong, 1000, 2)


def test_an_error_is_told_when_all_parts_are_done():
    done = []

    def call(first, last):
        if first == 0:
            raise ValueError("wrong")
        time.sleep(0.05)
        done.append(first)

    with pytest.raises(ValueError, match="wrong"):
        in_parts(call, 1000, 2)
    assert len(done) == 1


@pytest.mark.parametrize("n", [1, 64, 65, 128, 129, 1000, 1001])
@pytest.mark.parametrize("threads", [1, 2, 3, 5, 16])
def test_every_block_of_a_part_has_the_scratch_of_that_part(n, threads):
    for thread, (first, last) in enumerate(parts_of(n, threads)):
        assert {thread_of(row, n, threads) for row in range(first, last, BLOCK)} == {thread}


def test_there_are_as_many_parts_as_scratches_whatever_changes_later(monkeypatch):
    sim = ship_gym.ShipSim("kcs", 256, parallel=True)
    scratches = len(sim.fleet.scratch)
    monkeypatch.setattr("ship_gym.simulation.usable_cores", lambda: 4 * scratches)
    assert sim.threads == scratches
    alone = ship_gym.ShipSim("kcs", 256, parallel=False)
    assert len(alone.fleet.scratch) == 1
    alone.parallel = True
    assert alone.threads == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_fork_makes_threads_of_its_own():
    in_parts(lambda first, last: last - first, 1000, 2)  # threads of this process run
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        found = in_parts(lambda first, last: last - first, 1000, 2)
        os.write(write, str(sum(found)).encode())
        os._exit(0)
    os.waitpid(child, 0)
    assert os.read(read, 10) == b"1000"


def test_there_is_a_core(monkeypatch):
    assert _threads.usable_cores() >= 1
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    assert _threads.usable_cores() >= 1
