"""A picture as a PNG file."""

from __future__ import annotations

import os

import numpy as np

from ship_gym.rendering.canvas import Image
from ship_gym.writing import atomic_path

_COLOURS = 256  # a palette: half the size of a file with all colours, and no difference to see


def save_png(picture: np.ndarray, path: str | os.PathLike) -> None:
    """Write a picture, whole or not at all.

    Parameters
    ----------
    picture : numpy.ndarray
        uint8, shape (height, width, 3), RGB, as ``env.render()`` gives it.
    path : path-like
        File to write.
    """
    image = Image.fromarray(picture).quantize(_COLOURS, dither=Image.Dither.NONE)
    with atomic_path(path) as temporary:
        image.save(temporary, format="PNG", optimize=True)
