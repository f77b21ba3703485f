"""The faults of scripts/mutate.py: what they change, and that nothing else moves."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCE = '''"""Text 1.0."""
LIMIT = 60.0

def f(a: int, b, *, on=True):
    """Doc 2.0."""
    if a < 3:
        raise ValueError(f"{a + 1} is too small")
    c = -a + g(
        b,
        a,
    )
    for k in range(1, a):
        c -= max(0.0,
                 b[k + 1, 0])
    return min(c, 5)
'''
EXPECTED = {
    ("constant", "LIMIT = 60.0", "LIMIT = 66.0"),
    ("constant", "def f(a: int, b, *, on=True):", "def f(a: int, b, *, on=False):"),
    ("off by one", "if a < 3:", "if a <= 3:"),
    ("constant", "if a < 3:", "if a < 4:"),
    ("sign", "c = -a + g(", "c =  a + g("),
    ("sign", "c = -a + g(", "c = -a - g("),
    ("swapped arguments", "b,", "a,"),
    ("off by one", "for k in range(1, a):", "for k in range(1, a - 1):"),
    ("constant", "for k in range(1, a):", "for k in range(2, a):"),
    ("swapped arguments", "for k in range(1, a):", "for k in range(a, 1):"),
    ("sign", "c -= max(0.0,", "c += max(0.0,"),
    ("constant", "c -= max(0.0,", "c -= max(1.0,"),
    ("removed limit", "c -= max(0.0,", "c -= (b[k + 1, 0]"),
    ("off by one", "b[k + 1, 0])", "b[k + 2, 0])"),
    ("off by one", "b[k + 1, 0])", "b[k + 1, 1])"),
    ("removed limit", "return min(c, 5)", "return (c)"),
    ("constant", "return min(c, 5)", "return min(c, 6)"),
}


@pytest.fixture
def mutants(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    import _mutants

    return _mutants


def test_the_faults_of_a_small_module(mutants, tmp_path):
    (tmp_path / "m.py").write_text(SOURCE)
    found = list(mutants.mutants_of(tmp_path, "m.py", "physics"))
    assert {(m.kind, m.before, m.after) for m in found} == EXPECTED
    assert len({m.key for m in found}) == len(found) == len(EXPECTED)
    for m in found:
        changed = m.applied(SOURCE.encode())
        ast.parse(changed)
        assert changed.count(b"\n") == SOURCE.count("\n")
        assert m.lines[0] <= m.line <= m.lines[1]


def test_faults_of_the_packages_are_source_and_keep_their_lines(mutants):
    count = 0
    for path, area in list(mutants.modules(ROOT))[::7]:
        source = (ROOT / path).read_bytes()
        for m in list(mutants.mutants_of(ROOT, path, area))[::5]:
            ast.parse(m.applied(source))
            assert m.applied(source).count(b"\n") == source.count(b"\n"), m.key
            count += 1
    assert count > 50


def test_a_seed_draws_the_same_faults_and_a_glob_limits_them():
    def drawn(*arguments):
        command = [sys.executable, "scripts/mutate.py", "--list", "--json", *arguments]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)

    first = drawn("--count", "40", "--seed", "3")
    assert len(set(first)) == 40 and drawn("--count", "40", "--seed", "3") == first
    sea = drawn("--count", "5", "--only", "ship_gym/sea/*.py")
    assert len(sea) == 5 and all(key.startswith("ship_gym/sea/") for key in sea)
