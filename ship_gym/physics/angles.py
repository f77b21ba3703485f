"""Angles and elementary functions in kernels, as polynomials without branches.

A library's atan2 or cosine is a call, and a loop over ships with a call in it is not compiled to
vector instructions. These are, to 1e-11 of the library's value or better (tests/physics); they are
used wherever a kernel of one ship needs such a function, so that every path gives the same bits.
"""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel

_TURN = 2.0 * math.pi
_PER_RADIAN = 1.0 / _TURN
_WHOLE = 1.5 * 2.0**52  # added, it leaves no place for fractions: rounds to the nearest
_TAN_EIGHTH = math.sqrt(2.0) - 1.0  # tan(pi / 8)


@kernel
def nearest(x):
    """The whole number nearest to x, as a float; abs(x) below 2^51."""
    return (x + _WHOLE) - _WHOLE


@kernel
def wrapped(angle):
    """Angle in [-pi, pi) [rad]."""
    found = angle - _TURN * nearest(angle * _PER_RADIAN)
    return found - _TURN if found >= math.pi else found


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
    """Cos and sin of 2 pi `turns`, to 1e-12, exact at every half turn.

    Minimax polynomials on a quarter turn to either side; the other half of the circle is folded
    onto it.
    """
    f = turns - nearest(turns)
    far = abs(f) > 0.25
    h = 0.5 - abs(f) if far else abs(f)
    z = h * h
    s = -15.079320776502824 + z * 3.6552048572530844
    s = 81.6052490338651 + z * (-76.70584121787951 + z * (42.05796603167252 + z * s))
    s = h * (6.28318530717728 + z * (-41.34170223900644 + z * s))
    c = -26.395979617004752 + z * 7.541728035845049
    c = 64.93939377230112 + z * (-85.45679109979092 + z * (60.24339125425343 + z * c))
    c = 1.0 + z * (-19.739208801382244 + z * c)
    return (-c if far else c), (s if f >= 0.0 else -s)


@kernel
def cos_sin(angle):
    """Cos and sin of an angle [rad], to 1e-12 within some hundred turns."""
    return cos_sin_of_turns(angle * _PER_RADIAN)


@kernel
def cosine(angle):
    """Cos of an angle [rad]."""
    return cos_sin(angle)[0]


@kernel
def sine(angle):
    """Sin of an angle [rad]."""
    return cos_sin(angle)[1]


@kernel
def arctan2(y, x):
    """Angle of the vector (x, y) in [-pi, pi] [rad], to 1e-12; no signed zeros.

    The ratio is folded to within tan(pi/8), where a polynomial fitted to atan (minimax) serves.
    """
    ax, ay = abs(x), abs(y)
    # not max and min, which may drop what is not a number
    big, small = (ax, ay) if ax > ay else (ay, ax)
    folded = small > _TAN_EIGHTH * big
    top = small - big if folded else small
    low = small + big if folded else big
    t = top / (low if low != 0.0 else 1.0)
    z = t * t
    p = 0.069365288914074 - z * 0.037043752238949144
    p = -0.14285319242693706 + z * (0.11102357866490058 + z * (-0.08983415449924784 + z * p))
    p = -0.333333332617941 + z * (0.19999991170200382 + z * p)
    a = t + t * z * p
    a = 0.25 * math.pi + a if folded else a
    a = 0.5 * math.pi - a if ay > ax else a
    a = math.pi - a if x < 0.0 else a
    return -a if y < 0.0 else a


@kernel
def exp_negative(x):
    """exp(x) for x <= 0, to 1e-13 (1e-9 of its value); below -30 that of -30, which is 1e-13.

    Taylor series at x / 32, then the 32nd power.
    """
    t = max(x, -30.0) / 32.0
    p = 1.0 / 3628800.0 + t * (1.0 / 39916800.0 + t * (1.0 / 479001600.0 + t / 6227020800.0))
    p = 1.0 / 5040.0 + t * (1.0 / 40320.0 + t * (1.0 / 362880.0 + t * p))
    p = 1.0 / 24.0 + t * (1.0 / 120.0 + t * (1.0 / 720.0 + t * p))
    p = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * p)))
    p = p * p
    p = p * p
    p = p * p
    p = p * p
    return p * p
