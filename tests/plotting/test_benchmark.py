"""Pictures of a benchmark: who is on the Pareto front, and that every kind of picture is drawn."""

import numpy as np
import pytest
from PIL import Image

from ship_gym.plotting.benchmark import (
    Range,
    pareto_front,
    plot_pareto,
    plot_polar,
    plot_profiles,
    plot_scores,
    styles,
)

NAMES = ["constant", "lqg", "pid"]


def test_the_front_holds_those_that_no_other_equals_or_beats():
    points = {"cheap": (1.0, 9.0), "good": (5.0, 2.0), "worse": (5.0, 3.0), "both": (6.0, 9.0)}
    assert pareto_front(points) == ["cheap", "good"]
    assert pareto_front({"one": (1.0, 1.0), "same": (1.0, 1.0)}) == ["one", "same"]


def test_styles_differ_and_doing_nothing_is_faint():
    found = styles(NAMES)
    assert list(found) == ["lqg", "pid", "constant"] and len(set(found.values())) == 3
    assert styles(["constant", "a", "b"])["constant"] == found["constant"]


@pytest.mark.parametrize(
    "draw",
    [
        lambda path, look: plot_scores(
            {"pid": Range(100.0, 90.0, 110.0), "lqg": Range(120.0, 110.0, 130.0)}, look, path
        ),
        lambda path, look: plot_profiles(
            {"pid": np.array([1.0, 1.2, 3.0]), "lqg": np.array([1.0, 1.0, 1.0])}, look, path
        ),
        lambda path, look: plot_pareto(
            {
                "pid": (Range(10.0, 9.0, 11.0), Range(1.0, 0.9, 1.1)),
                "lqg": (Range(20.0, 19.0, 21.0), Range(9.0, 8.0, 10.0)),
            },
            look,
            ("travel [deg/h]", "J [deg2]"),
            path,
            optimum=0.8,
        ),
        lambda path, look: plot_polar(
            np.arange(0.0, 181.0, 45.0), {"pid": np.array([1.0, 2.0, np.nan, 1.0, 1.0])}, look, path
        ),
    ],
    ids=["scores", "profiles", "pareto", "polar"],
)
def test_pictures_are_narrow_and_not_empty(tmp_path, draw):
    path = tmp_path / "p.png"
    draw(path, styles(NAMES))
    with Image.open(path) as image:
        assert image.width <= 540 and len(image.convert("RGB").getcolors(2**20)) > 10
