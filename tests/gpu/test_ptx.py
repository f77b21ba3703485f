"""The kernels of the card compile, without a card: NVVM makes PTX of them, nvJitLink machine code.

Needs the libraries of the extra `gpu`; nothing is run.
"""

import re

import numpy as np
import pytest

import ship_gym
from ship_gym.gpu import batch

pytestmark = [pytest.mark.slow, pytest.mark.compiled]
pytest.importorskip("torch")
pytest.importorskip("numba_cuda", reason="numba-cuda is not installed: the extra gpu")
COMPUTE = (9, 0)  # H100


@pytest.fixture(scope="module")
def cuda():
    """numba.cuda that believes in a card of this compute capability."""
    from numba import cuda
    from numba.cuda import dispatcher

    try:
        cuda.compile_ptx(lambda: None, (), cc=COMPUTE)
    except Exception as error:  # of the loader: each library has its own
        pytest.skip(f"NVVM is not installed: {error}")
    card = type("Card", (), {"compute_capability": COMPUTE})()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dispatcher, "get_current_device", lambda: card)
        yield cuda


def ptx(cuda, kernel, *arguments):
    from numba import typeof, types

    signature = types.void(*(typeof(argument) for argument in arguments))
    return cuda.compile_ptx(kernel.py_func, signature, device=False, cc=COMPUTE)[0]


def linked(text):
    """Machine code, and what the assembler says of it."""
    nvjitlink = pytest.importorskip("cuda.bindings.nvjitlink")
    code = text.encode() + b"\0"
    handle = nvjitlink.create(2, [f"-arch=sm_{COMPUTE[0]}{COMPUTE[1]}", "-verbose"])
    nvjitlink.add_data(handle, nvjitlink.InputType.PTX, code, len(code), "kernel")
    nvjitlink.complete(handle)
    said = bytearray(nvjitlink.get_info_log_size(handle))
    nvjitlink.get_info_log(handle, said)
    return nvjitlink.get_linked_cubin_size(handle), said.decode(errors="replace")


def made(**options):
    envs = ship_gym.ShipVectorEnv(2, **options)
    envs.reset(seed=1)
    episodes = envs.episodes
    arrays = batch.fleet_of(episodes), batch.shared_of(episodes)
    return episodes, *arrays, batch.failing_of(episodes), np.zeros(batch.N_COUNTS, np.int32)


def test_sailing(cuda):
    from ship_gym.gpu.threads import sail_all

    episodes, fleet, shared, _, counts = made(ship=["kcs", "onrt"])
    actions = np.zeros((2, episodes.n_actions))
    text = ptx(cuda, sail_all, fleet, shared, actions, counts)
    assert ".target sm_90" in text
    # records must be aligned, or each of their numbers is read byte by byte
    assert text.count("ld.global.u8") < 0.01 * text.count("ld.global.f64")
    size, said = linked(text)
    assert size > 0 and int(re.findall(r"Used (\d+) registers", said)[-1]) <= 255


@pytest.mark.parametrize("scenario", ship_gym.TASKS)
def test_settling(cuda, scenario):
    from ship_gym.gpu.threads import settle_all

    episodes, fleet, shared, failing, counts = made(scenario=scenario, privileged=True)
    kernel = settle_all(episodes.task, True)
    text = ptx(cuda, kernel, fleet, shared, failing, counts)
    assert ".target sm_90" in text and linked(text)[0] > 0
