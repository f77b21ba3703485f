"""What `import ship_gym` costs and promises."""

import pkgutil
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


def modules():
    return sorted(found.name for found in pkgutil.iter_modules(ship_gym.__path__))


@pytest.mark.parametrize("first", ["simulation", "physics"])
def test_every_module_is_there_without_an_import_of_its_own(first):
    """In a process in which nothing has imported the first of them yet."""
    code = (
        f"import ship_gym, sys; assert 'ship_gym.{first}' not in sys.modules\n"
        f"for name in {[first, *modules()]!r}:\n"
        "    assert getattr(ship_gym, name) is sys.modules[f'ship_gym.{name}'], name\n"
        "    assert name in dir(ship_gym), name"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_names_of_a_module_and_of_a_class_differ():
    """On a disk that ignores case ``ship_gym.Sea`` and ``ship_gym.sea`` are two things still."""
    assert isinstance(ship_gym.Sea, type) and not isinstance(ship_gym.sea, type)
    assert ship_gym.Track is ship_gym.tracks.Track


def test_private_names_and_files_are_not_loaded():
    for name in ("_nothing", "__wrapped__", "README", "no.such"):
        assert not hasattr(ship_gym, name)
