"""Pictures of the documentation's recordings: what is refused, and what is written."""

from __future__ import annotations

import importlib
import io
import json

import numpy as np
import pytest

pytest.importorskip("rerun")
Image = pytest.importorskip("PIL.Image")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--out", "/proc/pictures"], "--out /proc/pictures: cannot write into /proc: "),
        (["--only", "track_curent"], "did you mean 'track_current'"),
    ],
)
def test_what_cannot_be_drawn_is_refused_before_any_work(call, tmp_path, arguments, words):
    code, out, err = call("draw_recordings.py", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1) and words in err
    assert not list(tmp_path.iterdir())


def test_a_machine_without_a_browser_is_refused(call, tmp_path, monkeypatch):
    pytest.importorskip("selenium")
    monkeypatch.setattr("shutil.which", lambda name: None)
    code, out, err = call("draw_recordings.py", "--viewers", "web", "--out", "new")
    assert (code, out) == (2, "") and not list(tmp_path.iterdir())
    assert err == (
        "error: pictures of the web viewer need chromium; Debian: chromium, chromium-driver\n"
    )


@pytest.fixture
def load(monkeypatch):
    from tests.scripts.conftest import SCRIPTS

    monkeypatch.syspath_prepend(str(SCRIPTS))
    return importlib.import_module


def test_a_time_is_asked_for_in_the_words_of_the_viewer(load):
    """By hand: field 6 { field 2 { field 1 "sim_time" } field 3 { 1: 272e9 } field 5: 1 }."""
    request = load("_web_viewer").time_request(272.0)
    name = b"\x0a\x08sim_time"
    time = b"\x08\x80\xc0\xda\xa3\xf5\x07"
    inside = b"\x12\x0a" + name + b"\x1a" + bytes([len(time)]) + time + b"\x28\x01"
    assert request == b"\x32" + bytes([len(inside)]) + inside
    number = sum((byte & 0x7F) << 7 * k for k, byte in enumerate(time[1:]))
    assert number == 272_000_000_000


def test_a_picture_in_few_colours_keeps_thin_lines(load, tmp_path):
    rng = np.random.default_rng(1)
    sky = np.linspace([20.0, 60.0, 90.0], [150.0, 170.0, 190.0], 200)[:, None] * np.ones(
        (1, 300, 1)
    )
    pixels = np.clip(sky + rng.normal(0.0, 2.0, sky.shape), 0, 255).astype(np.uint8)
    pixels[:, 250:] = 255
    red, orange = (227, 30, 40), (230, 120, 20)
    pixels[100, :40], pixels[110, :40] = red, orange
    png = io.BytesIO()
    Image.fromarray(pixels).save(png, "PNG")
    file = tmp_path / "new" / "few.png"
    load("_few_colours").write_small(png.getvalue(), file)
    few = Image.open(file)
    assert few.mode == "P" and file.stat().st_size < len(png.getvalue())
    found = np.asarray(few.convert("RGB")).astype(int)
    assert (found[:, 250:] == 255).all()  # grounds exactly
    for row, colour in ((100, red), (110, orange)):
        assert np.abs(found[row, :40] - colour).max() <= 12
    assert np.abs(found - pixels).mean() < 4.0


@pytest.mark.slow
def test_a_subject_is_recorded_and_drawn(call, tmp_path):
    from ship_gym.recording.rerun_export.viewer import NoViewer

    try:
        arguments = ["--only", "turning_circle", "--viewers", "native", "--themes", "dark"]
        code, out, err = call("draw_recordings.py", *arguments, "--out", "new", "--json")
    except NoViewer as error:
        pytest.skip(str(error))
    if "driver" in err:
        pytest.skip(err)
    assert code == 0, err
    (file,) = json.loads(out)["files"]
    with Image.open(file) as picture:
        assert picture.size == (1920, 1080)
        assert len(np.unique(np.asarray(picture))) > 50
