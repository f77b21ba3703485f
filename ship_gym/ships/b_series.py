"""Wageningen B-series torque and thrust, for propellers whose open-water curve is not printed.

Oosterveld & van Oossanen (1975), Int. Shipbuild. Prog. 22(251), polynomials at Re 2e6; the sign of
the KQ term J (AE/A0)^2 Z is negative there (one circulating copy has it positive).
"""

from __future__ import annotations

import numpy as np

# coefficient, powers of J, P/D, AE/A0, Z
_KT = """
.00880496 0000 -.204554 1000 .166351 0100 .158114 0200 -.147581 2010 -.481497 1110 .415437 0210
.0144043 0001 -.0530054 2001 .0143481 0101 .0606826 1101 -.0125894 0011 .0109689 1011 -.133698 0300
.00638407 0600 -.00132718 2600 .168496 3010 -.0507214 0020 .0854559 2020 -.0504475 3020
.010465 1620 -.00648272 2620 -.00841728 0301 .0168424 1301 -.00102296 3301 -.0317791 0311
.018604 1021 -.00410798 0221 -.000606848 0002 -.0049819 1002 .0025983 2002 -.000560528 3002
-.00163652 1202 -.000328787 1602 .000116502 2602 .000690904 0012 .00421749 0312
.0000565229 3612 -.00146564 0322
"""
_KQ = """
.00379368 0000 .00886523 2000 -.032241 1100 .00344778 0200 -.0408811 0110 -.108009 1110
-.0885381 2110 .188561 0210 -.00370871 1001 .00513696 0101 .0209449 1101 .00474319 2101
-.00723408 2011 .00438388 1111 -.0269403 0211 .0558082 3010 .0161886 0310 .00318086 1310
.015896 0020 .0471729 1020 .0196283 3020 -.0502782 0120 -.030055 3120 .0417122 2220 -.0397722 0320
-.00350024 0620 -.0106854 3001 .00110903 3301 -.000313912 0601 .0035985 3011 -.00142121 0611
-.00383637 1021 .0126803 0221 -.00318278 2321 .00334268 0621 -.00183491 1102 .000112451 3202
-.0000297228 3602 .000269551 1012 .00083265 2012 .00155334 0212 .000302683 0612 -.0001843 0022
-.000425399 0322 .0000869243 3322 -.0004659 0622 .0000554194 1622
"""


def _terms(text: str) -> list[tuple[float, tuple[int, ...]]]:
    words = text.split()
    return [
        (float(c), tuple(int(k) for k in powers))
        for c, powers in zip(words[::2], words[1::2], strict=True)
    ]


def b_series(J, pitch_ratio: float, area_ratio: float, blades: int):
    """K_T and K_Q of a B-series propeller in open water.

    Parameters
    ----------
    J : array_like
        Advance ratio u_A / (n D), valid where K_T >= 0.
    pitch_ratio, area_ratio : float
        P/D (0.5 to 1.4) and AE/A0 (0.3 to 1.05).
    blades : int
        2 to 7.

    Returns
    -------
    K_T, K_Q : numpy.ndarray
    """
    J = np.asarray(J, dtype=float)

    def total(text):
        return sum(
            c * J**s * pitch_ratio**t * area_ratio**u * blades**v
            for c, (s, t, u, v) in _terms(text)
        )

    return total(_KT), total(_KQ)
