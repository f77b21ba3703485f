"""What `import ship_gym` costs and promises."""

import subprocess
import sys

import pytest

import ship_gym

HEAVY = (
    "PIL",
    "pyproj",
    "numba",
    "torch",
    "stable_baselines3",
    "capytaine",
    "rerun",
    "matplotlib",
    "sklearn",
)


def test_import_loads_no_heavy_library():
    code = f"import ship_gym, sys; print([m for m in {HEAVY!r} if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


@pytest.mark.parametrize("name", ship_gym.__all__)
def test_public_names_exist(name):
    assert getattr(ship_gym, name) is not None
    assert name in dir(ship_gym)


def test_unknown_name():
    with pytest.raises(AttributeError, match="no_such"):
        _ = ship_gym.no_such
