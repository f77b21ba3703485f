"""WAMIT's low-order geometry data file (GDF), its symmetries unfolded."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ship_gym.config import ConfigError, cut, shown
from ship_gym.reading import check_array, read_as, read_text

MOST_FACES = 2_000_000
FAR = 1e9  # of a vertex from the origin, in the unit of the file
_FORTRAN = str.maketrans("Dd", "Ee")  # an exponent of double precision, 1.5D+01
_HEAD = {
    2: "two numbers, ULEN and GRAV",
    3: "two numbers 0 or 1, ISX and ISY",
    4: f"the number of panels, 1 to {MOST_FACES}",
}


def read_gdf(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Panels of a WAMIT low-order GDF file, its symmetries unfolded.

    Returns
    -------
    vertices : numpy.ndarray, shape (4 P, 3)
        In the file's axes and units (x forward, y to port, z up; ULEN is not applied).
    panels : numpy.ndarray, shape (P, 4)
        Anticlockwise seen from the water, so normals point out of the hull.

    Raises
    ------
    ConfigError
        A line of the head that is none, too few numbers, or a higher-order file.
    """
    lines = read_text(path, fallback="latin-1").splitlines()
    _head(path, lines, 2, float)
    ISX, ISY = _head(path, lines, 3, int)
    if not {ISX, ISY} <= {0, 1}:
        raise _wrong(path, lines, 3)
    (count,) = _head(path, lines, 4, int)
    _check_order(path, lines[3])
    if not 0 < count <= MOST_FACES:
        raise _wrong(path, lines, 4)
    corners = _corners(path, lines, count)
    for axis, wanted in enumerate((ISX, ISY)):
        if wanted:
            mirrored = corners[:, ::-1] * np.where(np.arange(3) == axis, -1.0, 1.0)
            corners = np.concatenate([corners, mirrored])
    return corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4)


def _wrong(path: str | Path, lines: list[str], number: int) -> ConfigError:
    line = shown(cut(lines[number - 1], 60)) if number <= len(lines) else "missing"
    return ConfigError(f"{path}:{number}: {line}: not a GDF file: needed are {_HEAD[number]}")


def _head(path: str | Path, lines: list[str], number: int, kind: type) -> list:
    """Numbers at the start of a line of the head, behind which a comment may stand."""
    wanted = 1 if number == 4 else 2
    try:
        found = [float(word) for word in lines[number - 1].replace(",", " ").split()[:wanted]]
        if len(found) < wanted or any(kind(value) != value for value in found):
            raise ValueError
    except (ValueError, IndexError, OverflowError):
        raise _wrong(path, lines, number) from None
    return [kind(value) for value in found]


def _check_order(path: str | Path, line: str) -> None:
    """A higher-order file has IGDEF behind the number of its patches."""
    words = line.replace(",", " ").split()
    try:
        int(words[1])
    except (IndexError, ValueError):
        return
    raise ConfigError(
        f"{path}:4: a higher-order GDF file ({words[0]} patches, IGDEF = {words[1]}): allowed is a "
        "low-order one, four corners a panel; WAMIT writes one from it (ILOWGDF > 0 in its .cfg)"
    )


def _corners(path: str | Path, lines: list[str], count: int) -> np.ndarray:
    """Corners (P, 4, 3); the panel and the line are named where they end too early."""
    words = " ".join(lines[4:]).replace(",", " ").split()
    if len(words) < 12 * count:
        raise ConfigError(
            f"{path}: ends in panel {len(words) // 12 + 1} of {count}: needed are four corners of "
            "three numbers for each"
        )
    with read_as(path, "a low-order GDF file"):
        try:
            numbers = np.array([word.translate(_FORTRAN) for word in words[: 12 * count]], float)
        except ValueError:
            at = next(i for i, word in enumerate(words) if not _is_number(word))
            raise ConfigError(
                f"{path}: panel {at // 12 + 1}, corner {at % 12 // 3 + 1}: {shown(words[at])}: "
                "needed is a number"
            ) from None
    corners = numbers.reshape(count, 4, 3)
    check_array(f"{path}: corners", corners, corners.shape, -FAR, FAR)
    return corners


def _is_number(word: str) -> bool:
    try:
        float(word.translate(_FORTRAN))
    except ValueError:
        return False
    return True
