"""What is looked at in the blocks of README and docs without running them, in seconds.

Pages run as a whole in ``test_pages`` and ``test_tutorials``. Here the syntax of a block in Python,
its imports, its dotted names and the arguments of ``gym.make`` are checked; of every command that
the program, the verb and its options, the script or the extra exist; that TOML, JSON and XML can be
read. What is not run has the mark ``<!-- not run: why -->`` before it, and is in `MARKED`, so that
the exceptions are seen here; it is checked even so.
"""

import ast
import contextlib
import inspect
import json
import re
import shlex
import tomllib
from xml.etree import ElementTree

import click
import gymnasium as gym
import pytest
from ship_gym_agents.cli import VERBS, load_verb

import ship_gym
from tests.docs.blocks import PAGES, ROOT, SHELL, Block, blocks_of, commands

ALL = [block for page in PAGES for block in blocks_of(page)]
PYTHON = [block for block in ALL if block.language == "python"]
SHELLS = [block for block in ALL if block.language in (*SHELL, "console")]
MARKED = {("docs/fit_hull.md", "the files of HMRI are not in the package")}
SESSIONS = {  # commands with what they print, and the test that compares it
    "docs/cosimulation.md": "tests/cosim/test_example.py",
    "docs/hulls.md": "tests/seakeeping/test_hull_mesh.py",
}
READ = {"toml": tomllib.loads, "json": json.loads, "xml": ElementTree.fromstring}
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
    "optional-dependencies"
]
FOLDER = re.compile(
    r"(/__init__)?\.py$"
)  # ship_gym/tasks/speed/__init__.py is ship_gym/tasks/speed
# other programs than ours that the pages name
OTHERS = {"git", "source", "pre-commit", "cd", "my_master"}


def test_there_is_something_to_check():
    assert len(PYTHON) > 40 and len(SHELLS) > 20


def test_exceptions_are_those_that_are_listed():
    assert {(block.page, block.why) for block in ALL if block.why} == MARKED
    assert {block.page for block in ALL if block.language == "console"} == set(SESSIONS)
    assert all((ROOT / test).exists() for test in SESSIONS.values())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_block_says_its_language(page):
    """Indented code and fences without a language would be seen by no test."""
    outside, before = True, ""
    for line in page.read_text("utf-8").splitlines():
        if line.startswith("```"):
            assert not outside or line != "```", f"{page}: a fence without a language"
            outside = not outside
        assert not (outside and not before and line.startswith("    ")), f"{page}: {line}"
        before = line


@pytest.mark.parametrize("block", [b for b in ALL if b.language in READ], ids=str)
def test_data_can_be_read(block: Block):
    assert READ[block.language](block.code) is not None


@pytest.mark.parametrize("block", PYTHON, ids=str)
def test_python_compiles_and_names_what_exists(block: Block):
    tree = ast.parse(block.code)
    names = {"gym": gym, "ship_gym": ship_gym}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            take(node, names, block.page)
    stored = {
        n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            check_dotted(ast.unparse(node), {k: v for k, v in names.items() if k not in stored})
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("gym.make", "gym.make_vec"):
            check_make(node)


def take(node, names, page):
    """Import what belongs to us; libraries of an extra may be missing, a page's own files are."""
    if getattr(node, "module", None) == "__future__":
        return
    try:
        exec(compile(ast.Module([node], []), "page", "exec"), names)
    except ModuleNotFoundError as error:
        own = error.name.replace(".", "/")
        ours = error.name.partition(".")[0] in ("ship_gym", "ship_gym_agents")
        assert not ours or own in {FOLDER.sub("", f) for f in files_of(page)}, error


def files_of(page):
    """Files that the blocks of a page are."""
    return [block.file for block in ALL if block.page == page and block.file]


def check_dotted(text, names):
    """``ship_gym.a.b`` leads to something."""
    if re.fullmatch(r"[A-Za-z_][\w.]*", text) and text.partition(".")[0] in names:
        eval(text, dict(names))


def check_make(call):
    """The id is registered and takes these arguments."""
    if not isinstance(call.args[0], ast.Constant) or call.args[0].value not in gym.registry:
        return  # a task of the page itself: its file is run elsewhere
    spec = gym.spec(call.args[0].value)
    vector = ast.unparse(call.func) == "gym.make_vec"
    entry = spec.vector_entry_point if vector else spec.entry_point
    made = gym.envs.registration.load_env_creator(entry) if isinstance(entry, str) else entry
    own = {"num_envs", "vectorization_mode"} if vector else {"max_episode_steps"}
    allowed = own | set(inspect.signature(made).parameters)
    assert {keyword.arg for keyword in call.keywords if keyword.arg} <= allowed


@pytest.mark.parametrize("block", SHELLS, ids=str)
def test_commands_name_what_exists(block: Block):
    for line in commands(block.code):
        for part in re.split(r" (?:&&|\|) ", line):
            check_command([w for w in shlex.split(part, comments=True) if w != "&"])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_commands_in_a_line_name_what_exists(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    for line in re.findall(r"`(ship-gym [a-z][^`\n]*)`", text):
        check_command(shlex.split(line, comments=True))


def check_command(words):
    """Program and what it is given."""
    while words and re.fullmatch(r"[A-Z_]+=.*", words[0]):
        words = words[1:]
    program, *rest = words
    if program == "ship-gym":
        check_verb(rest)
    elif program in ("python", "bash") and not rest[0].startswith("-"):
        assert (ROOT / rest[0]).exists(), words
    elif program == "pip":
        for given in re.findall(r"(?:^|\s)(?:\.|ship-gym)\[([\w,]+)\]", " ".join(rest)):
            assert set(given.split(",")) <= set(EXTRAS), words
    else:
        assert program in OTHERS | {"python", "bash"} or (ROOT / program).exists(), words


def check_verb(words):
    """The verb exists and takes these options; values are those of a user."""
    assert words[0] in VERBS or words[0].startswith("-"), words
    if words[0].startswith("-"):
        return
    command, words = load_verb(words[0]), words[1:]
    context = click.Context(command, info_name="verb", resilient_parsing=True)
    while isinstance(command, click.Group) and words:
        below = command.get_command(context, words[0])
        assert below is not None, words
        command, words = below, words[1:]
        context = click.Context(command, parent=context, resilient_parsing=True)
    context.resilient_parsing = False
    with contextlib.suppress(click.BadOptionUsage):  # named without its value, or may stand alone
        command.make_parser(context).parse_args(list(words))


@pytest.mark.parametrize(
    "line", ["ship-gym trian", "ship-gym train --minuets 2", "bash scripts/gone.sh", "rm -rf ."]
)
def test_a_command_that_is_not_there_is_noticed(line):
    with pytest.raises((AssertionError, click.NoSuchOption)):
        check_command(line.split())


def test_a_name_that_is_not_there_is_noticed():
    for code in (
        "import ship_gym.gone",
        "ship_gym.gone()",
        'gym.make("ShipGym/HeadingKeeping-v0", g=1)',
    ):
        with pytest.raises((AssertionError, AttributeError)):
            test_python_compiles_and_names_what_exists(Block("page", 1, "python", code, None))
