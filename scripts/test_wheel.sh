#!/usr/bin/env bash
# Build wheel and sdist, install the wheel away from the checkout, use it: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/test_wheel.sh [--clean]

Builds wheel and sdist and compares what is in them with the checkout; makes a new virtual
environment outside of it with the wheel alone; from an empty folder trains for 10 seconds,
evaluates 4 episodes, records, reviews and simulates with the command ship-gym.

  --clean      let pip fetch every library anew; by default the new environment borrows the
               libraries of .venv, but not the checkout
  -h, --help   this text

Environment: PYTHON (Python >= 3.11 to use), SHIP_GYM_VENV (default .venv).

Examples:
  bash scripts/test_wheel.sh
  bash scripts/test_wheel.sh --clean   # what a stranger's pip install does; some minutes more
HELP
}

clean=no
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --clean) clean=yes ;;
    *) die "unknown argument: $1 (see --help)" ;;
    esac
    shift
done

# The wheel holds the files of both packages that git tracks, the sdist also what tests them.
check_contents() {
    "$PY" - "$ROOT" "$1"/*.whl "$1"/*.tar.gz <<'CHECK'
import subprocess, sys, tarfile, zipfile
root, wheel, sdist = sys.argv[1:]
command = ["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"]

def tracked(*folders):
    done = subprocess.run([*command, *folders], capture_output=True, text=True, check=True)
    return done.stdout.split()

with zipfile.ZipFile(wheel) as file:
    inside = {name for name in file.namelist() if ".dist-info/" not in name}
with tarfile.open(sdist) as file:
    names = (m.name.partition("/")[2] for m in file.getmembers() if m.isfile())
    source = {name for name in names if "/" in name}
for what, found, wanted in (
    ("wheel", inside, {name.removeprefix("agents/") for name in tracked("ship_gym", "agents")}),
    ("sdist", source, set(tracked("ship_gym", "agents", "docs", "scripts", "tests"))),
):
    if odd := sorted(found ^ wanted):
        sys.exit(f"{what}: only there or only in the checkout: {', '.join(odd)}")
    print(f"    {what}: {len(found)} files, as in the checkout")
CHECK
}

# An environment with the wheel; its libraries are its own, or those of $VENV by one .pth line
# (a .pth file inside that folder, such as that of the editable checkout, is then not obeyed).
make_environment() { # FOLDER WHEEL
    "$PY" -m venv "$1"
    local pip=("$1/bin/python" -m pip install -qq --no-input --disable-pip-version-check)
    if [ "$clean" = yes ]; then
        "${pip[@]}" "$TORCH"
        "${pip[@]}" "$TORCH" "$2[rl,rerun,plot]"
    else
        local site='import sysconfig; print(sysconfig.get_path("purelib"))'
        "$PY" -c "$site" >"$("$1/bin/python" -c "$site")/borrowed.pth"
        "${pip[@]}" --no-deps --ignore-installed "$2"
    fi
}

# What a stranger does first.
use_it() { # CHECKOUT
    python - "$1" <<'CHECK'
import pathlib, sys
import ship_gym, ship_gym_agents
for package in (ship_gym, ship_gym_agents):
    place = pathlib.Path(package.__file__).resolve()
    assert not place.is_relative_to(sys.argv[1]), f"{place} is the checkout"
    assert place.is_relative_to(sys.prefix), f"{place} is not in the new environment"
CHECK
    ship-gym --help >/dev/null
    say "Train 10 seconds"
    ship-gym train --minutes 0.17 --out runs/wheel
    say "Evaluate, record, review, simulate"
    ship-gym evaluate --policy runs/wheel --episodes 4 >/dev/null
    ship-gym evaluate --controller ppo_kcs pid --episodes 4 --out runs/pid.json
    ship-gym record --policy runs/wheel --out runs/voyage.rrd >/dev/null
    ship-gym review metrics runs/voyage.rrd
    ship-gym simulate --out runs/turn.png | tail -n 3
    ship-gym list ships
}

set_up
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
started=$SECONDS
say "Building the sdist, and the wheel from it"
"$PY" -m build -o "$work/dist" "$ROOT" >"$work/log" 2>&1 || { cat "$work/log" && die "no build"; }
check_contents "$work/dist"
say "Installing the wheel in $work"
make_environment "$work/venv" "$work"/dist/*.whl
say "Built and installed in $((SECONDS - started)) s"
mkdir "$work/empty"
cd "$work/empty"
export PATH="$work/venv/bin:$PATH" MPLBACKEND=Agg
unset PYTHONPATH
use_it "$ROOT"
say "The wheel works: $((SECONDS - started)) s"
