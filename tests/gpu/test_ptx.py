"""The kernels of the card compile, without a card: NVVM makes PTX of them, nvJitLink machine code.

Needs the libraries of the extra `gpu`; nothing is run.
"""

import re

import numpy as np
import pytest

import ship_gym
from ship_gym.gpu import batch
from ship_gym.gpu.rows import leaves

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
    from numba.cuda import types
    from numba.cuda.typing.typeof import Purpose, typeof  # as a launch does

    signature = types.void(*(typeof(argument, Purpose.argument) for argument in arguments))
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


CASES = {
    "heading_keeping": {},
    "course_changing": {"privileged": True},
    "track_following": {"ship": ["kcs", "onrt"], "control": "rudder+rpm"},
}


@pytest.mark.parametrize("scenario", CASES)
def test_the_kernel_of_a_task(cuda, scenario):
    from ship_gym.gpu.threads import kernel_of

    envs = ship_gym.ShipVectorEnv(2, scenario=scenario, **CASES[scenario])
    envs.reset(seed=1)
    whole = batch.batch_of(envs.episodes)
    values = tuple(value for _, value in leaves(whole))
    kernel = kernel_of(envs.episodes.task, whole)
    text = ptx(cuda, kernel, values, 2, np.zeros(batch.N_COUNTS, np.int32))
    assert ".target sm_90" in text
    # records must be aligned, or each of their numbers is read byte by byte
    assert text.count("ld.global.u8") < 0.05 * text.count("ld.global.f64")
    size, said = linked(text)
    assert size > 0 and int(re.findall(r"Used (\d+) registers", said)[-1]) <= 255
