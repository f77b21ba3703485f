"""Pictures of screens in 256 colours: a third of the bytes, and nobody sees a difference."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from ship_gym.writing import atomic_path

_COLOURS, _KEPT = 256, 64  # of the picture; of them kept as they are: grounds, text, large lines


def write_small(png: bytes, file: Path) -> None:
    """Write a picture with few colours.

    The commonest stay as they are. The others are chosen among all that appear, however rarely:
    thin lines and their marks in a legend keep their own.
    """
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(np.uint32)
    packed = pixels[..., 0] << 16 | pixels[..., 1] << 8 | pixels[..., 2]
    found, where, counts = np.unique(packed, return_inverse=True, return_counts=True)
    colours = np.stack([found >> 16, found >> 8 & 255, found & 255], axis=1).astype(np.uint8)
    order = np.argsort(-counts, kind="stable")
    palette = colours[order[:_KEPT]]
    if len(rest := colours[order[_KEPT:]]):
        made = Image.fromarray(rest[None]).quantize(
            _COLOURS - _KEPT, Image.Quantize.MEDIANCUT, kmeans=2
        )
        chosen = np.array(made.getpalette()[: 3 * (_COLOURS - _KEPT)], np.uint8)
        palette = np.concatenate([palette, chosen.reshape(-1, 3)])
    exact = palette.astype(np.float32)
    nearest = ((exact**2).sum(1) - 2.0 * colours.astype(np.float32) @ exact.T).argmin(1)
    picture = Image.fromarray(nearest[where].reshape(packed.shape).astype(np.uint8))
    picture.putpalette(palette.ravel().tolist())
    with atomic_path(file) as temporary:
        picture.save(temporary, format="PNG", optimize=True)
