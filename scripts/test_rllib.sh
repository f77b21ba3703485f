#!/usr/bin/env bash
# Installs RLlib beside Ship Gym and trains with it: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/test_rllib.sh [--seconds N] [--wheel FILE]

Makes a virtual environment in a temporary folder with ship-gym[rllib], which brings RLlib with the
one version of gymnasium that it asks for; trains PPO of RLlib on ShipGym/HeadingKeeping-v0, first
on single environments by their id, then on the native vector environment as docs/examples does;
checks that what comes out are finite numbers.

  --seconds N   of each training (default 30)
  --wheel FILE  install this wheel of Ship Gym instead of the checkout
  -h, --help    this text

Environment: PYTHON (Python >= 3.11 to use).

Examples:
  bash scripts/test_rllib.sh
  bash scripts/test_rllib.sh --seconds 5 --wheel dist/ship_gym-0.1.0-py3-none-any.whl
HELP
}

seconds=30
source_="$ROOT"
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --seconds | --wheel)
        [ $# -gt 1 ] || die "$1 needs a value (see --help)"
        if [ "$1" = --seconds ]; then seconds="$2"; else source_="$(realpath "$2")"; fi
        shift
        ;;
    *) die "unknown argument: $1 (see --help)" ;;
    esac
    shift
done
[[ "$seconds" =~ ^[0-9]+$ ]] || die "--seconds $seconds: must be a whole number"
[ -e "$source_" ] || die "--wheel $source_: no such file"

set_up_beside rllib "$source_" "2 GB"

say "RLlib on single environments, $seconds s"
"$PY" "$ROOT/scripts/_train_rllib.py" "$seconds"
say "RLlib on the native vector environment"
"$PY" "$ROOT/docs/examples/ppo_rllib.py" --iterations "$((1 + seconds / 2))" --judge 4
say "RLlib trains beside Ship Gym: $((SECONDS - started)) s"
