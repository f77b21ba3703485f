#!/usr/bin/env bash
# Tests with the lowest versions of libraries that pyproject.toml allows: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"
# shellcheck source=scripts/_core_tests.sh
source "$(dirname "${BASH_SOURCE[0]}")/_core_tests.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/test_lowest.sh [--extras NAMES] [pytest arguments]

Makes a virtual environment in a temporary folder with the lowest version of each library that
pyproject.toml allows, and runs the tests in it that say most in little time: physics, sea, ships,
tracks, tasks, environments, evaluation and the command line. First the scalar environments with
the lowest gymnasium, then everything with the lowest that has the native vector environment.

  --extras NAMES   extras whose lowest versions are there too, as in pip (default benchmark)
  -h, --help       this text
  Anything else goes to pytest: files named here are run instead of the usual ones.

Environment: PYTHON (default python3.11, the lowest), SHIP_GYM_TEST_WORKERS (pytest processes,
default 2).

Examples:
  bash scripts/test_lowest.sh
  bash scripts/test_lowest.sh --extras fit,plot tests/plotting tests/surrogates/test_fit.py
HELP
}

extras=(benchmark)
arguments=()
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --extras)
        [ $# -gt 1 ] || die "--extras needs names, such as fit,plot"
        IFS=, read -ra extras <<<"$2"
        shift
        ;;
    *) arguments+=("$1") ;;
    esac
    shift
done

PYTHON="${PYTHON:-$(command -v python3.11 || true)}" # empty: the first that is new enough
python="$(find_python)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
PY="$work/venv/bin/python" # of _setup.sh, for pip_install
started=$SECONDS
cd "$ROOT"

lowest="$("$python" scripts/_lowest.py ${extras[@]+"${extras[@]}"})"
read -ra pins <<<"${lowest//$'\n'/ }"
vectors="$("$python" scripts/_lowest.py --only rl | grep '^gymnasium==')"
say "Installing ${pins[*]} for $("$python" --version)"
"$python" -m venv "$work/venv"
pip_install "${pins[@]}" pytest pytest-xdist hypothesis --editable .
"$PY" -m pip --disable-pip-version-check check

if [ ${#arguments[@]} -eq 0 ]; then
    say "Scalar environments with the lowest gymnasium"
    run_pytest "${SCALAR[@]}"
    arguments=("${USUAL[@]}")
fi
say "Tests with $vectors, the lowest with native vector environments"
pip_install "$vectors"
run_pytest "${arguments[@]}"
say "The command line"
use_command "$work"
say "The lowest versions pass: $((SECONDS - started)) s"
