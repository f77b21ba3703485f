"""What type checkers and editors see of the packages (py.typed)."""

import ast
import tomllib
from pathlib import Path

import pytest
import ship_gym_agents

import ship_gym

ROOT = Path(__file__).parents[2]
SCRIPT = Path(__file__).with_name("user_script.py")
# Lines that mypy passes over. May only get fewer: put here what is left.
IGNORES = 10


def shown_to_checkers(package) -> dict[str, str]:
    """Public name -> module it is imported from, in the ``if TYPE_CHECKING`` of a package."""
    tree = ast.parse(Path(package.__file__).read_text(encoding="utf-8"))
    [block] = [
        node
        for node in tree.body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ]
    found = {}
    for node in block.body:
        if isinstance(node, ast.AnnAssign):
            found[node.target.id] = "ship_gym.envs.classes"
            continue
        for alias in node.names:
            assert alias.asname == alias.name, "`as` makes it public to a strict checker"
            found[alias.name] = node.module
    return found


def test_checkers_see_what_loads():
    assert shown_to_checkers(ship_gym) == ship_gym._PUBLIC


def test_checkers_see_what_loads_of_the_agents():
    module = "ship_gym_agents.controllers"
    assert shown_to_checkers(ship_gym_agents) == dict.fromkeys(ship_gym_agents._PUBLIC, module)


@pytest.mark.parametrize("package", [ship_gym, ship_gym_agents])
def test_packages_say_that_they_are_typed(package):
    assert Path(package.__file__).with_name("py.typed").exists()


def test_no_module_is_left_out():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    left_out = [one for one in settings["tool"]["mypy"]["overrides"] if "ignore_errors" in one]
    assert not left_out, "a module that is not clean inside: mend it"


def test_few_lines_are_left_out():
    found = [
        f"{path.relative_to(ROOT)}:{number}"
        for folder in ("ship_gym", "agents/ship_gym_agents")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if "# type: ignore" in line
    ]
    assert len(found) <= IGNORES, found


def check_script(script: Path, folder: Path) -> tuple[str, int]:
    """What ``mypy --strict`` of a user says of a script: of ours it sees what is installed."""
    api = pytest.importorskip("mypy.api")
    settings = folder / "mypy.ini"
    settings.write_text(
        "[mypy]\nstrict = True\n"
        f"mypy_path = {ROOT}:{ROOT / 'agents'}\n"
        f"cache_dir = {folder / 'cache'}\n"
        "[mypy-ship_gym.*,ship_gym_agents.*]\nfollow_imports = silent\n"
        "[mypy-torch.*,stable_baselines3.*,sb3_contrib.*,scipy.*,numba.*,matplotlib.*,ray.*]\n"
        "follow_imports = skip\nignore_missing_imports = True\n"
    )
    out, errors, code = api.run(["--config-file", str(settings), str(script)])
    return out + errors, code


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where mypy keeps what it knows of the package, half a minute of work, for the next script."""
    return tmp_path_factory.mktemp("mypy")


@pytest.mark.slow
def test_script_of_a_user_passes_mypy_strict(folder):
    said, code = check_script(SCRIPT, folder)
    assert code == 0, said


@pytest.mark.slow
def test_wrong_use_is_told(folder):
    script = folder / "wrong.py"
    script.write_text(
        "import ship_gym\n"
        "ship_gym.load_ship(3.5)\n"
        "ship_gym.load_sea('calm').no_such\n"
        "ship_gym.ShipEnv(control=1)\n"
    )
    said, code = check_script(script, folder)
    assert code == 1
    for line, kind in ((2, "arg-type"), (3, "attr-defined"), (4, "arg-type")):
        assert f"wrong.py:{line}: error:" in said and f"[{kind}]" in said, said
