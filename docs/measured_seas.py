"""Sample spectra and the picture of docs/seaway.md: run ``python docs/measured_seas.py``.

The two csv files are made here from formulas, to show the form of a file; nothing was measured.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ship_gym.plotting.spectra import plot_spectrum
from ship_gym.sea import read_spectrum
from ship_gym.sea.spectra import jonswap, spreading
from ship_gym.writing import atomic_path, check_place

DOCS = Path(__file__).parent
HINDCAST, BUOY = DOCS / "spectra" / "hindcast.csv", DOCS / "spectra" / "buoy.csv"
# height [m], peak period [s], where from [deg], s of the spreading
WIND_SEA, SWELL = (2.2, 7.5, 240.0, 3.0), (1.8, 14.0, 330.0, 15.0)
DIRECTIONS = np.arange(7.5, 360.0, 15.0)  # deg, as a hindcast of 24 has them
FREQUENCIES = 0.0345 * 1.1 ** np.arange(28)  # Hz


def density(height: float, period: float, come: float, s: float) -> np.ndarray:
    """JONSWAP with cos^(2s) about a direction [m2/Hz/deg], of the bins of a hindcast."""
    S = 2.0 * np.pi * jonswap(2.0 * np.pi * FREQUENCIES, height, period)
    off = np.radians((DIRECTIONS - come + 180.0) % 360.0 - 180.0)
    D = spreading(off, s)
    return S[:, None] * D / (D.sum() * 15.0)


def written(path: Path, about: str, titles: str, rows: list[tuple[float, ...]]) -> None:
    """Write a sample."""
    lines = ["# Synthetic: made by docs/measured_seas.py from formulas, nothing was measured.",
             f"# {about}", titles]  # fmt: skip
    lines += [",".join(f"{value:.6g}" for value in row) for row in rows]
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def samples() -> None:
    """Write both samples."""
    both = density(*WIND_SEA) + density(*SWELL)
    rows = [
        (f, come, both[i, j])
        for i, f in enumerate(FREQUENCIES)
        for j, come in enumerate(DIRECTIONS)
    ]
    about = "Wind sea of 2.2 m, 7.5 s from 240 deg, and swell of 1.8 m, 14 s from 330 deg."
    written(HINDCAST, about, "frequency [Hz],direction_from [deg],density [m2/Hz/deg]", rows)
    f = np.arange(0.04, 0.5, 0.01)
    S = 2.0 * np.pi * jonswap(2.0 * np.pi * f, 3.0, 9.0)
    rows = [(a, b, 250.0, 20.0 + 60.0 * (a - 0.11) ** 2 / 0.16) for a, b in zip(f, S, strict=True)]
    about = "As a buoy has it: JONSWAP of 3 m and 9 s from 250 deg, with the spread of each band."
    titles = "frequency [Hz],density [m2/Hz],direction_from [deg],spread [deg]"
    written(BUOY, about, titles, rows)


def main() -> None:
    """Write samples and picture."""
    picture = DOCS / "measured_spectrum.png"
    for path in (HINDCAST, BUOY, picture):
        check_place(path, "docs")
    samples()
    title = "Two systems of a hindcast (synthetic) as 60 regular waves"
    plot_spectrum(read_spectrum(HINDCAST), picture, title=title)


if __name__ == "__main__":
    main()
