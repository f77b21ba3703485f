"""Rerun's viewer: on loopback only, pictures without a window, one line where it cannot run."""

from __future__ import annotations

import socket
import urllib.request

import numpy as np
import pytest

from ship_gym.recording import Trajectory

pytest.importorskip("rerun")
Image = pytest.importorskip("PIL.Image")

from ship_gym.recording.rerun_export import program, viewer  # noqa: E402 (needs rerun)


@pytest.fixture
def file(tmp_path):
    """A run that goes north."""
    t = np.arange(20.0)
    columns = {"t": t, "x": 7.0 * t, "y": 0.0 * t, "psi": 0.0 * t, "u": 7.0 + 0.0 * t}
    Trajectory(columns, {"task": "heading_keeping"}).to_rrd(tmp_path / "run.rrd")
    return tmp_path / "run.rrd"


def shot(file, out, **how):
    """Picture of a viewer; skipped where none can be taken."""
    try:
        viewer.screenshot(file, out, **how)
    except viewer.NoViewer as error:
        pytest.skip(str(error))
    return np.asarray(Image.open(out).convert("RGB")).astype(int)


def test_pictures_have_the_size_and_the_time_that_are_asked_for(file, tmp_path):
    late = shot(file, tmp_path / "a.png", size=(800, 600))
    early = shot(file, tmp_path / "b.png", time=3.0, size=(800, 600))
    assert late.shape == early.shape == (600, 800, 3) and (early != late).any()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "b.png", "run.rrd"]


def test_light_pictures_are_light(file, tmp_path):
    bar = (slice(4, 20), slice(200, 400))  # of the window's title
    assert shot(file, tmp_path / "dark.png", size=(800, 600))[bar].mean() < 60
    assert shot(file, tmp_path / "light.png", size=(800, 600), light=True)[bar].mean() > 200


def test_without_a_driver_it_is_one_line_and_no_file(file, tmp_path, monkeypatch, capfd):
    for name in ("VK_ICD_FILENAMES", "VK_DRIVER_FILES"):
        monkeypatch.setenv(name, str(tmp_path / "no driver"))
    monkeypatch.setenv("WGPU_BACKEND", "vulkan")
    with pytest.raises(viewer.NoViewer) as refused:
        viewer.screenshot(file, tmp_path / "a.png")
    assert "\n" not in str(refused.value) and not (tmp_path / "a.png").exists()
    assert capfd.readouterr() == ("", "")  # no panic on the screen


def test_without_its_program_it_says_so(file, tmp_path, monkeypatch):
    monkeypatch.setattr(program, "_PROGRAMS", ())
    monkeypatch.setattr(program.shutil, "which", lambda name: None)
    with pytest.raises(viewer.NoViewer, match="install rerun-sdk again"):
        viewer.serve_web(file)


def test_a_window_needs_a_screen(file, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(viewer.NoViewer, match="no screen here"):
        viewer.show(file)
    monkeypatch.setenv("DISPLAY", ":0")
    assert viewer.has_screen()


def test_the_web_is_served_on_loopback_only_and_ends(file):
    served = viewer.serve_web(file)
    try:
        assert served.address.startswith("http://127.0.0.1:")
        page = urllib.request.urlopen(served.address, timeout=10).read()
        assert b"rerun" in page.lower()
        port = int(served.address.split(":")[2].split("/")[0])
        for address in outside():
            with socket.socket() as probe:
                assert probe.connect_ex((address, port)) != 0
    finally:
        served.stop()
    assert not program.listens(port)


def outside() -> list[str]:
    """Addresses of this machine beside loopback."""
    found = {entry[4][0] for entry in socket.getaddrinfo(socket.gethostname(), None)}
    return [one for one in found if ":" not in one and not one.startswith("127.")]
