"""Arrays that live on the card: numba's view for kernels, torch's view of the same memory."""

from __future__ import annotations

from typing import Any

import numpy as np

from ship_gym.gpu.card import simulated


class _Bytes:
    """Memory of a numba array as plain bytes, shape (rows, bytes of a row), for torch.

    torch knows no records; any field of them is a view of these bytes. Holds the array, so that the
    memory lives as long as a tensor of it.
    """

    def __init__(self, array: Any, shape: tuple[int, int]):
        self._array = array
        place, _ = array.__cuda_array_interface__["data"]
        self.__cuda_array_interface__ = {
            "shape": shape,
            "typestr": "|u1",
            "data": (place, False),
            "strides": None,
            "version": 2,
        }


class Mirror:
    """An array of the host on the card, one row for each ship.

    Parameters
    ----------
    host : numpy.ndarray
        Shape (rows, ...), of numbers or records; copied to the card once.
    cuda : module
        ``numba.cuda``.
    torch : module
    device : torch.device

    Attributes
    ----------
    host : numpy.ndarray
        As given; not kept up to date.
    kernel : numba device array
        For kernels.
    rows : torch.Tensor
        uint8, shape (rows, bytes of a row): the same memory.
    """

    def __init__(self, host: np.ndarray, cuda: Any, torch: Any, device: Any):
        self._torch, self._device = torch, device
        self.host = host
        whole = np.ascontiguousarray(host)
        shape = (len(host), whole.nbytes // max(len(host), 1))
        if simulated():
            whole = whole.copy()
            self.kernel = cuda.to_device(whole)
            self.rows = torch.from_numpy(self.kernel.view(np.uint8)._ary.reshape(shape))
        else:
            self.kernel = cuda.to_device(whole)
            self.rows = torch.as_tensor(_Bytes(self.kernel, shape), device=device)

    def upload(self, which: np.ndarray, places: Any) -> None:
        """Copy rows of the host.

        Parameters
        ----------
        which : numpy.ndarray
            Their numbers, shape (m,).
        places : torch.Tensor
            The same on the card.
        """
        packed = np.ascontiguousarray(self.host[which]).view(np.uint8).reshape(len(which), -1)
        self.rows[places] = self._torch.from_numpy(packed).to(self._device)

    def tensor(self, field: str | None = None) -> Any:
        """The array, or a field of its records, as a tensor of the same memory."""
        return typed(self.rows, self.host, field, self._torch)


def typed(rows: Any, host: np.ndarray, field: str | None, torch: Any) -> Any:
    """Bytes of an array (or of one field of its records) as a tensor of its type and shape.

    Parameters
    ----------
    rows : torch.Tensor
        uint8, shape (rows, bytes of a row).
    host : numpy.ndarray
        Has the type and the shape.
    field : str or None
        Name of a field that is a number.
    """
    if field is None:
        kind, inner, first = host.dtype, host.shape[1:], 0
    else:
        assert host.dtype.fields is not None  # a record
        (kind, first), inner = host.dtype.fields[field][:2], ()
    count = int(np.prod(inner, dtype=np.int64))
    seen = rows[:, first : first + kind.itemsize * count]
    return seen.view(_torch_type(kind, torch)).reshape(len(host), *inner)


def _torch_type(kind: np.dtype, torch: Any) -> Any:
    return torch.from_numpy(np.zeros((), kind)).dtype
