"""Angles in kernels: the range of one turn, vectors from them, and a fast cosine and sine."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel

_TURN = 2.0 * math.pi


@kernel
def wrapped(angle):
    """Angle in [-pi, pi) [rad]."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@kernel
def north_east(size, direction, north, east):
    """North and east components of vectors, shapes (m,), written: the inverse of
    ``conventions.polar``. Not numpy's cosine: its last bit depends on the size of the batch.
    """
    for i in range(len(size)):
        north[i] = size[i] * math.cos(direction[i])
        east[i] = size[i] * math.sin(direction[i])


@kernel
def cos_sin_of_turns(turns):
    """Cos and sin of 2 pi `turns`, to 1e-11; a polynomial, since two library calls cost more.

    Taylor series on a quarter turn to either side; the other half of the circle is folded onto it.
    """
    f = turns - math.floor(turns + 0.5)
    far = abs(f) > 0.25
    h = 0.5 - abs(f) if far else abs(f)
    z = (_TURN * h) * (_TURN * h)
    s = 1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0 + z / 355687428096000.0)
    s = 1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 + z * (-1.0 / 39916800.0 + z * s)))
    s = _TURN * h * (1.0 + z * (-1.0 / 6.0 + z * s))
    c = 1.0 / 479001600.0 + z * (-1.0 / 87178291200.0 + z / 20922789888000.0)
    c = 1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + z * (-1.0 / 3628800.0 + z * c)))
    c = 1.0 + z * (-0.5 + z * c)
    return (-c if far else c), (s if f >= 0.0 else -s)
