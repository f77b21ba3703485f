"""The one door to ``numba.cuda``: what a graphics card needs, and what of it is missing here.

numba.cuda comes from the package numba-cuda of the extra ``gpu``. With ``NUMBA_ENABLE_CUDASIM=1``
its simulator plays the card: each thread of a kernel is a Python thread, the memory of the card is
numpy's. That is for tests. It cannot call compiled kernels, so ``NUMBA_DISABLE_JIT=1`` goes with
it, and both must be set before Python starts.
"""

from __future__ import annotations

import importlib.util
import os
from typing import Any

from ship_gym.config import ConfigError

_INSTALL = "pip install 'ship-gym[gpu]'"


def simulated() -> bool:
    """Whether numba's simulator plays the card."""
    return os.environ.get("NUMBA_ENABLE_CUDASIM", "0") not in ("", "0")


def _installed(package: str) -> bool:
    return importlib.util.find_spec(package) is not None


def torch_of(device: str) -> Any:
    """The module torch, or a ConfigError that says how to get it."""
    if not _installed("torch"):
        raise ConfigError(
            f"device = {device!r}: ShipTorchEnv needs torch, which is not installed: {_INSTALL}"
        )
    import torch

    return torch


def card(device: str, index: int = 0) -> Any:
    """The module ``numba.cuda``, once everything that a card needs is there.

    Parameters
    ----------
    device : str
        As the user gave it, for the message.
    index : int
        Number of the card.

    Raises
    ------
    ConfigError
        What is missing: numba-cuda, a torch built for CUDA, a driver, a card of that number.
    """
    if simulated():
        _check_simulator(device)
    else:
        _check_card(device, index)
    from numba import cuda

    return cuda


def _check_simulator(device: str) -> None:
    if os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0"):
        raise ConfigError(
            f"device = {device!r} with NUMBA_ENABLE_CUDASIM: the simulator cannot call compiled "
            "kernels; set NUMBA_DISABLE_JIT=1 too, before Python starts"
        )


def _check_card(device: str, index: int) -> None:
    if not _installed("numba_cuda"):
        raise ConfigError(
            f"device = {device!r}: the package numba-cuda is not installed: {_INSTALL}, or use "
            "device = 'cpu'"
        )
    torch = torch_of(device)
    if torch.version.cuda is None:
        raise ConfigError(
            f"device = {device!r}: this torch ({torch.__version__}) is built without CUDA; install "
            "one with it, or use device = 'cpu'"
        )
    from numba import cuda

    if not cuda.is_available():
        raise ConfigError(
            f"device = {device!r}: no NVIDIA driver or no card is found (nvidia-smi lists what "
            "there is); use device = 'cpu'"
        )
    count = len(cuda.gpus)
    if not 0 <= index < count:
        raise ConfigError(f"device = {device!r}: there are {count} cards, from 'cuda:0' on")
