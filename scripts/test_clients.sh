#!/usr/bin/env bash
# Installs TorchRL, skrl and Tianshou beside Ship Gym and trains with them: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/test_clients.sh [--slow] [--wheel FILE]

Makes a virtual environment in a temporary folder with ship-gym[clients], which brings TorchRL, skrl
and Tianshou, and runs the tests that need them: the adapter for Tianshou and TorchRL's GymWrapper
against loops of our own, the examples of docs/examples and the blocks of pages. A test that is
skipped for want of a library is an error here.

  --slow        also train with each for a minute, and see that it has learned to steer
  --wheel FILE  install this wheel of Ship Gym instead of the checkout
  -h, --help    this text

Environment: PYTHON (Python >= 3.11 to use).

Examples:
  bash scripts/test_clients.sh
  bash scripts/test_clients.sh --slow --wheel dist/ship_gym-0.1.0-py3-none-any.whl
HELP
}

source_="$ROOT"
learns=" and not learns"
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --slow) learns="" ;;
    --wheel)
        [ $# -gt 1 ] || die "$1 needs a value (see --help)"
        source_="$(realpath "$2")"
        shift
        ;;
    *) die "unknown argument: $1 (see --help)" ;;
    esac
    shift
done
[ -e "$source_" ] || die "--wheel $source_: no such file"

set_up_beside clients,minari,render "$source_" "1.5 GB" pytest

# The installed package, not the checkout: tests and pages are copied, and nothing else is there.
cp -r "$ROOT/tests" "$ROOT/docs" "$ROOT"/*.md .
cat >pytest.ini <<'INI'
[pytest]
addopts = --import-mode=importlib
markers =
    slow: trains
    compiled: needs compiled kernels
INI
say "The tests that need them"
"$PY" -m pytest -q -rs -p no:cacheprovider tests/agents/test_tianshou_env.py tests/envs/test_torchrl.py \
    tests/examples tests/docs/test_pages.py -k "(tianshou or skrl or torchrl)$learns" | tee "$work/log"
! grep -q "skipped" "$work/log" || die "tests were skipped (see above)"
say "TorchRL, skrl and Tianshou sail with Ship Gym: $((SECONDS - started)) s"
