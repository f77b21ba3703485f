#!/usr/bin/env bash
# The wheel on each Python, with lowest and newest libraries; the sdist tests itself: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"
# shellcheck source=scripts/_core_tests.sh
source "$(dirname "${BASH_SOURCE[0]}")/_core_tests.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/test_matrix.sh [--short] [--pythons LIST] [--only lowest|newest|sdist]
                                   [test files]

Builds wheel and sdist. For each Python found of 3.11, 3.12 and 3.13: a new environment with the
wheel and the lowest versions that pyproject.toml allows, then one with the newest; in each the
core tests (those of test_lowest.sh) run against the wheel, away from the checkout, and the command
ship-gym is used. At last the unpacked sdist passes the same tests by its own code. Prints a table;
the exit code is 0 only if every line of it passes.

  --short          one cell a Python, for CI: the oldest with the lowest versions and all core tests,
                   the newest with the newest and few tests, one between them with the sdist and few
  --pythons LIST   such as 3.11,3.13 (default 3.11,3.12,3.13; one that is not there is left out)
  --only WHAT      lowest, newest or sdist alone
  -h, --help       this text
  Anything else: files of tests that run instead of the usual ones.

Environment: PYTHON (builds the wheel), SHIP_GYM_TEST_WORKERS (pytest processes, default 2).

Examples:
  bash scripts/test_matrix.sh
  bash scripts/test_matrix.sh --short
  bash scripts/test_matrix.sh --pythons 3.12 --only newest tests/physics
HELP
}

pythons=(3.11 3.12 3.13)
kinds=(lowest newest sdist)
short=no
given=() # files of tests
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --short) short=yes ;;
    --pythons)
        [ $# -gt 1 ] || die "--pythons needs versions, such as 3.11,3.13"
        IFS=, read -ra pythons <<<"$2"
        shift
        ;;
    --only)
        case "${2:-}" in
        lowest | newest | sdist) kinds=("$2") ;;
        *) die "--only needs lowest, newest or sdist" ;;
        esac
        shift
        ;;
    -*) die "unknown option: $1 (see --help)" ;;
    *) given+=("$1") ;;
    esac
    shift
done
FEW=(
    tests/envs/{test_old_gymnasium,test_streams}.py tests/physics/test_{angles,dynamics}.py
    tests/ships/test_loader.py tests/tracks/test_{files,track}.py tests/sea/test_spectra.py
    tests/evaluation/test_metrics.py tests/test_{config,csv_file,import}.py
)
choose_tests() { # KIND: sets `files`
    if [ ${#given[@]} -gt 0 ]; then
        files=("${given[@]}")
    elif [ "$short" = yes ] && [ "$1" != lowest ]; then
        files=("${FEW[@]}")
    else
        files=("${USUAL[@]}")
    fi
}

# Command of a Python X.Y: on the path, or the newest of pyenv's.
interpreter() { # X.Y
    local candidate
    for candidate in "python$1" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/python; do
        if "$candidate" -c "import ensurepip, sys; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" \
            >/dev/null 2>&1; then
            command -v "$candidate"
            return
        fi
    done
}

# In one environment; called where a failure must not end the script, so each step says || return.
cell() { # PYTHON KIND
    local python="$1" kind="$2" pins=() tests="$work/tests" files
    choose_tests "$kind"
    PY="$work/venv/bin/python"
    rm -rf "$work/venv"
    "$python" -m venv "$work/venv" || return
    if [ "$kind" = lowest ]; then
        read -ra pins <<<"$("$python" "$ROOT/scripts/_lowest.py" benchmark | tr '\n' ' ')"
    fi
    [ "$kind" = sdist ] && tests="$work/source"
    local tools=(pytest pytest-xdist hypothesis)
    (pip_install ${pins[@]+"${pins[@]}"} "$wheel[benchmark]" "${tools[@]}") || return
    cd "$tests" || return
    if [ "$kind" = lowest ]; then
        [ ${#given[@]} -gt 0 ] || run_pytest "${SCALAR[@]}" || return
        (pip_install "$("$python" "$ROOT/scripts/_lowest.py" --only rl | grep '^gymnasium==')") || return
    fi
    if [ "$kind" = sdist ]; then # its own code, not the wheel's
        "$PY" -m pip uninstall -qq -y ship-gym || return
        (pip_install --no-deps --editable .) || return
    fi
    "$PY" -m pip --disable-pip-version-check check || return
    check_origin "$kind" || return
    run_pytest "${files[@]}" || return
    use_command "$work"
}

check_origin() { # KIND: the code under test is that of the environment, or of the sdist
    local folder="$work/venv"
    [ "$1" = sdist ] && folder="$work/source"
    "$PY" - "$folder" <<'CHECK'
import pathlib, sys
import ship_gym
place = pathlib.Path(ship_gym.__file__).resolve()
assert place.is_relative_to(pathlib.Path(sys.argv[1]).resolve()), f"{place} is tested instead"
CHECK
}

versions() { # of what decides most, in one line
    "$PY" -m pip list --disable-pip-version-check --format=freeze 2>/dev/null |
        grep -E '^(numpy|scipy|numba|gymnasium|pyarrow|matplotlib)==' | tr '\n' ' '
}

run_cell() { # PYTHON X.Y KIND: a line of the table
    local started=$SECONDS result=passes
    say "Python $2, $3"
    (cell "$1" "$3") || result=FAILS
    PY="$work/venv/bin/python"
    rows+=("$(printf '%-6s %-7s %-6s %4d s  %s' "$2" "$3" "$result" $((SECONDS - started)) "$(versions)")")
    [ "$result" = passes ] || failed=yes
}

[ -x "$PY" ] || set_up
"$PY" -m build --version >/dev/null 2>&1 || set_up
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH
say "Building the sdist, and the wheel from it"
"$PY" -m build -o "$work/dist" "$ROOT" >"$work/log" 2>&1 || { cat "$work/log" && die "no build"; }
wheel="$(echo "$work"/dist/*.whl)"
mkdir "$work/source" "$work/tests"
tar -xzf "$work"/dist/*.tar.gz -C "$work/source" --strip-components 1
# Tests of the wheel: what the sdist holds without the two packages, so that nothing hides the wheel.
tar -xzf "$work"/dist/*.tar.gz -C "$work/tests" --strip-components 1
rm -r "$work/tests/ship_gym" "$work/tests/agents"

rows=()
failed=no
found=()
for version in "${pythons[@]}"; do
    if [ -n "$(interpreter "$version")" ]; then found+=("$version"); else say "No Python $version here"; fi
done
[ ${#found[@]} -gt 0 ] || die "none of these Pythons is here: ${pythons[*]}"
oldest="${found[0]}"
newest="${found[${#found[@]}-1]}"

pythons_of() { # KIND: the versions of Python that it runs on
    case "$short $1" in
    "yes lowest") echo "$oldest" ;;
    "yes sdist") echo "${found[${#found[@]}/2]}" ;;
    "yes newest" | "no sdist") echo "$newest" ;;
    *) echo "${found[*]}" ;;
    esac
}

for kind in "${kinds[@]}"; do
    for version in $(pythons_of "$kind"); do run_cell "$(interpreter "$version")" "$version" "$kind"; done
done
say "Python, versions, result, time"
printf '    %s\n' "${rows[@]}"
[ "$failed" = no ] || die "not all of them pass"
