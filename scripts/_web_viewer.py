"""Photographs of rerun's web viewer, by Chromium without a window and Mesa's software OpenGL."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# SwiftShader, Chromium's own software OpenGL, takes a minute for a frame; the rest: no window, and
# no connections but the one to this machine
_FLAGS = (
    *("--headless=new", "--hide-scrollbars", "--ignore-gpu-blocklist"),
    *("--use-gl=angle", "--use-angle=gl-egl", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
# A frame takes long in software: with pauses between frames the page also answers.
_SLOWER = """
const usual = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = draw => setTimeout(() => usual(draw), %d);
"""
_PAUSE = 500  # between frames [ms]
# The page keeps its viewer to itself, but asks it every second whether it has crashed.
_CATCH = """
const kind = wasm_bindgen.WebHandle.prototype, usual = kind.has_panicked;
kind.has_panicked = function() { window.viewer = this; return usual.call(this); };
"""
_CONTROL = """
const done = arguments[1];
window.viewer.viewer_control(new Uint8Array(arguments[0])).then(() => done(""), e => done(`${e}`));
"""
_PATIENCE = 240.0  # for a page to come to rest [s]; a busy machine needs a minute


def check_browser() -> None:
    """Refuse, before any work, a machine without what takes the photographs."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        raise ImportError(
            "pictures of the web viewer need selenium: pip install selenium"
        ) from None
    _program(*_BROWSERS)
    _program("chromedriver")


def _program(*names: str) -> str:
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        text = f"pictures of the web viewer need {names[0]}; Debian: chromium, chromium-driver"
        raise FileNotFoundError(text)
    return found


def photograph(address: str, seconds: float, size: tuple[int, int], light: bool) -> bytes:
    """PNG of a recording in the web viewer.

    Parameters
    ----------
    address : str
        Of the page that ``viewer.serve_web`` serves.
    seconds : float
        Where the time cursor stands [s].
    size : tuple of int
        Width and height [pixels].
    light : bool
        In the light theme.
    """
    options = f"renderer=webgl&persist=0&hide_welcome_screen=1&theme={'light' if light else 'dark'}"
    with _browser(size) as browser:
        browser.get(f"{address}&{options}")
        _until(lambda: browser.execute_script("return typeof wasm_bindgen !== 'undefined'"))
        browser.execute_script(_CATCH)
        _until(lambda: browser.execute_script("return window.viewer !== undefined"))
        # until the recording is there, the viewer says that it knows no such timeline
        _until(lambda: not _control(browser, time_request(seconds)))
        return _at_rest(browser)


def time_request(seconds: float) -> bytes:
    """The request, in rerun's ``viewer_control.proto``, to stop at a time."""
    from ship_gym.recording.rerun_export.log import TIMELINE

    nanoseconds = round(seconds * 1e9)
    timeline = _bytes(2, _bytes(1, TIMELINE.encode()))
    return _bytes(6, timeline + _bytes(3, b"\x08" + _varint(nanoseconds)) + b"\x28\x01")


def _bytes(field: int, content: bytes) -> bytes:
    """A field of protobuf that holds bytes."""
    return _varint(field << 3 | 2) + _varint(len(content)) + content


def _varint(number: int) -> bytes:
    made = bytearray()
    while number > 0x7F:
        made.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*made, number])


@contextmanager
def _browser(size: tuple[int, int]) -> Iterator[Any]:
    """A browser with a page of this size and slow frames."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    width, height = size
    options = webdriver.ChromeOptions()
    options.binary_location = _program(*_BROWSERS)
    as_root = ["--no-sandbox"] if os.name == "posix" and os.geteuid() == 0 else []  # must be
    for flag in (*_FLAGS, *as_root, f"--window-size={width},{height}"):
        options.add_argument(flag)
    browser = webdriver.Chrome(options=options, service=Service(_program("chromedriver")))
    try:
        page = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", page)
        slower = {"source": _SLOWER % _PAUSE}
        browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", slower)
        browser.set_script_timeout(60)
        yield browser
    finally:
        browser.quit()


def _control(browser: Any, request: bytes) -> str:
    """Ask the viewer for something; what it complains of, or nothing."""
    return browser.execute_async_script(_CONTROL, list(request))


def _until(ready: Any) -> None:
    from selenium.common.exceptions import WebDriverException

    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        try:
            if ready():
                return
        except WebDriverException:  # busy
            pass
        time.sleep(0.5)
    raise TimeoutError(f"the web viewer did not come up within {_PATIENCE:.0f} s")


def _at_rest(browser: Any) -> bytes:
    """The picture once it is the same twice: parts of the data and of the views come later."""
    from selenium.common.exceptions import WebDriverException

    end, last = time.monotonic() + _PATIENCE, b""
    while time.monotonic() < end:
        time.sleep(4.0)
        try:
            image = browser.get_screenshot_as_png()
        except WebDriverException:  # busy
            continue
        if image == last:
            return image
        last = image
    raise TimeoutError(f"the web viewer did not come to rest within {_PATIENCE:.0f} s")
