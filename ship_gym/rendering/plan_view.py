"""PlanView: a scene as a picture, plan view on the left and instruments on the right."""

from __future__ import annotations

import numpy as np

from ship_gym.config import ConfigError, shown
from ship_gym.rendering.camera import camera_for
from ship_gym.rendering.canvas import SEA, Canvas
from ship_gym.rendering.chart import draw_chart
from ship_gym.rendering.instruments import WIDTH, draw_instruments
from ship_gym.rendering.scene import Scene

_DESIGN = (960, 540)  # the picture that the layout is made for
_SIZES = {"width": (640, 3840), "height": (360, 2160)}


class PlanView:
    """Draws scenes, all at one size; knows nothing from one picture to the next.

    Parameters
    ----------
    width, height : int
        Size of the picture [pixel], even (video formats want it so), 640 to 3840 by 360 to 2160.
        Text is as large as the smaller of width / 960 and height / 540 allows.

    Raises
    ------
    ConfigError
        Another size.
    """

    def __init__(self, width: int = 960, height: int = 540):
        self.width, self.height = _checked("width", width), _checked("height", height)
        self._unit = min(self.width / _DESIGN[0], self.height / _DESIGN[1])

    def draw(self, scene: Scene) -> np.ndarray:
        """The picture of a scene; the same scene gives the same bytes.

        Returns
        -------
        numpy.ndarray
            uint8, shape (height, width, 3), RGB.
        """
        canvas = Canvas(self.width, self.height, self._unit, SEA)
        chart = canvas.width - WIDTH
        draw_chart(canvas, camera_for(scene, chart, canvas.height), scene)
        draw_instruments(canvas, scene, chart)
        return canvas.pixels()


def _checked(field: str, value: int) -> int:
    low, high = _SIZES[field]
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not low <= value <= high or value % 2:
        raise ConfigError(
            f"{field} = {shown(value)}: allowed is an even integer from {low} to {high}"
        )
    return int(value)
