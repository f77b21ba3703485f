"""What the README and the pages beside it name exists: dotted names, files, blocks of Python."""

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import pytest

import ship_gym

ROOT = Path(__file__).resolve().parent.parent
NAMES = ("making", "own", "use", "validation", "autopilots", "limits", "install")
PAGES = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in NAMES)]
TEXT = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
BLOCKS = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
# without the lines of an import, which the test of the blocks runs
USED = re.sub(r"^(from|import) .*$", "", TEXT, flags=re.MULTILINE)
DOTTED = sorted(set(re.findall(r"\bship_gym(?:\.[A-Za-z_]\w*)+", USED)))
FILES = sorted(set(re.findall(r"\b(?:ship_gym|agents|scripts|docs|tests)/[\w./-]*\w", TEXT)))


def test_there_is_something_to_check():
    assert len(BLOCKS) >= 3 and len(DOTTED) >= 5 and len(FILES) >= 10


def test_dotted_names_resolve_after_import_ship_gym():
    code = "\n".join(["import ship_gym", *(f"assert {name} is not None" for name in DOTTED)])
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("name", FILES)
def test_files_exist(name):
    assert (ROOT / name).exists()


def chains(tree):
    """Attributes like ``a.b.c`` as text."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            text = ast.unparse(node)
            if re.fullmatch(r"[\w.]+", text):
                yield text


@pytest.mark.parametrize("block", BLOCKS, ids=range(len(BLOCKS)))
def test_blocks_compile_and_their_names_resolve(block):
    tree = ast.parse(block)
    names = {"gym": gym, "ship_gym": ship_gym}
    imports = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    exec(compile(ast.Module(imports, []), "page", "exec"), names)
    assert imports or BLOCKS.index(block) > 0
    for text in chains(tree):
        root = text.partition(".")[0]
        if root in names:
            eval(text, names)  # AttributeError if it is not there
    for call in ast.walk(tree):
        if isinstance(call, ast.Call) and ast.unparse(call.func) in ("gym.make", "gym.make_vec"):
            check_call(call)


def check_call(call):
    """The id is registered and takes these arguments."""
    spec = gym.spec(ast.literal_eval(call.args[0]))
    vector = ast.unparse(call.func) == "gym.make_vec"
    entry = spec.vector_entry_point if vector else spec.entry_point
    made = gym.envs.registration.load_env_creator(entry) if isinstance(entry, str) else entry
    own = {"num_envs", "vectorization_mode"} if vector else {"max_episode_steps"}
    allowed = own | set(inspect.signature(made).parameters)
    assert {keyword.arg for keyword in call.keywords} <= allowed
