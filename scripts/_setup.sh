# shellcheck shell=bash
# Sourced by the scripts beside it: makes the virtual environment and installs this checkout.
# Gives: ROOT (the checkout), VENV, PY (its python), say, die, set_up, set_up_beside.
# Reads: $PYTHON (a Python >= 3.11), $SHIP_GYM_VENV (where the environment lives; default .venv).

ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
VENV="${SHIP_GYM_VENV:-$ROOT/.venv}"
mkdir -p "$(dirname "$VENV")"
VENV="$(cd "$(dirname "$VENV")" && pwd -P)/$(basename "$VENV")"
PY="$VENV/bin/python"

# torch goes first and pinned, so that pip takes the small CPU build wherever the machine's index
# or wheel folder offers one, and the `rl` extra (torch>=2.13) then finds itself satisfied. On a
# machine whose index offers a CUDA build only, the same line works; the download is just larger.
TORCH="torch==2.13.0"
EXTRAS="rl,fit,rerun,plot,cad,geo,spectra,fmu,nmea,render,video,benchmark,tune,ray,docs,dev"

# Holds "unfinished" while we install, then the fingerprint of what was installed.
STAMP="$VENV/.ship-gym-stamp"
MADE="$VENV/.ship-gym-made" # says that we made this environment and may delete it

say() { printf '==> %s\n' "$*"; }

die() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}

# Make the environment ready; does nothing, in a moment, when it already is.
set_up() {
    if is_ready; then
        say "Environment is up to date: $VENV"
        return
    fi
    lock
    if ! is_ready; then # another set-up may have finished while we waited
        discard_broken
        [ -x "$PY" ] || create
        install
    fi
    unlock
}

is_ready() {
    [ -f "$STAMP" ] && usable && [ "$(cat "$STAMP")" = "$(fingerprint)" ] && complete
}

# Does the environment run, at this very path, on a Python that is new enough, with pip?
usable() {
    "$PY" -I -c 'import pip, sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 &&
        grep -qF "$VENV/bin/python" "$VENV/bin/pip" 2>/dev/null
}

# Hash of everything that decides what gets installed.
fingerprint() {
    "$PY" -I -c '
import hashlib, pathlib, sys
files = [pathlib.Path(sys.argv[1], name) for name in ("pyproject.toml", "scripts/_setup.sh")]
parts = [sys.argv[1].encode(), sys.version.encode(), *(file.read_bytes() for file in files)]
print(hashlib.sha256(b"\0".join(parts)).hexdigest())' "$ROOT"
}

# Is everything that the scripts use still there? Looks without importing, so it takes no time.
complete() {
    "$PY" -I -c '
import importlib.util as util, pathlib, sys
root, names = sys.argv[1], sys.argv[2:]
specs = {name: util.find_spec(name) for name in names}
here = pathlib.Path(specs["ship_gym"].origin).resolve().parent.parent == pathlib.Path(root)
sys.exit(not (here and all(specs.values())))' "$ROOT" ship_gym numpy scipy numba gymnasium click torch \
        stable_baselines3 sb3_contrib sklearn rerun matplotlib pyproj PIL moviepy \
        pytest xdist pytest_cov hypothesis build 2>/dev/null &&
        [ -x "$VENV/bin/ruff" ] && [ -x "$VENV/bin/lint-imports" ] && [ -x "$VENV/bin/ship-gym" ]
}

discard_broken() {
    [ -e "$VENV" ] || [ -L "$VENV" ] || return 0
    if [ -x "$PY" ] && [ ! -e "$VENV/bin/pip" ]; then # made without pip, e.g. by uv
        "$PY" -m ensurepip --default-pip >/dev/null 2>&1 || true
    fi
    local stamp reason
    stamp="$(cat "$STAMP" 2>/dev/null)" || true
    if ! usable; then
        reason="it is broken or was moved"
    elif [ "$stamp" = unfinished ]; then
        reason="its last set-up did not finish"
    elif [ "$stamp" = "$(fingerprint)" ]; then
        reason="packages are missing from it"
    else
        return 0 # sound, to be updated in place
    fi
    # A folder that somebody pointed us to and that we did not make is not ours to delete.
    if [ ! -f "$MADE" ] && [ "$VENV" != "$ROOT/.venv" ] && [ -n "$(ls -A "$VENV")" ]; then
        if usable; then return 0; fi
        die "$VENV is not a working virtual environment with pip; delete it or set SHIP_GYM_VENV"
    fi
    say "Removing $VENV: $reason"
    rm -rf "$VENV"
}

create() {
    local python
    python="$(find_python)"
    say "Making $VENV with $("$python" --version 2>&1) ($python)"
    mkdir -p "$VENV"
    touch "$MADE"
    "$python" -m venv "$VENV" || die "$python could not make a virtual environment in $VENV"
}

# First Python that runs (a pyenv shim may be there and fail), is >= 3.11 and can make venvs.
find_python() {
    local test='import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' candidate
    if [ -n "${PYTHON:-}" ]; then
        "$PYTHON" -c "$test" >/dev/null 2>&1 ||
            die "PYTHON=$PYTHON is not a working Python >= 3.11 with venv and ensurepip"
        echo "$PYTHON"
        return
    fi
    for candidate in python3.13 python3.12 python3.11 python3 python; do
        if "$candidate" -c "$test" >/dev/null 2>&1; then
            command -v "$candidate"
            return
        fi
    done
    die "no working Python >= 3.11 found (on Debian and Ubuntu it also needs python3-venv);" \
        "name one: PYTHON=/path/to/python bash scripts/test.sh"
}

install() {
    local started=$SECONDS
    echo unfinished >"$STAMP"
    say "Installing $TORCH (about 1 minute; the CPU build takes 0.8 GB of disk)"
    pip_install "$TORCH"
    say "Installing ship-gym[$EXTRAS] from this checkout (about 1 minute, 1.5 GB of disk)"
    pip_install "$TORCH" --editable "${ROOT}[$EXTRAS]"
    complete || die "pip finished, but packages are missing. $AGAIN"
    fingerprint >"$STAMP"
    say "Installed in $((SECONDS - started)) s"
}

AGAIN="Run the same command again: it starts over"

pip_install() {
    "$PY" -m pip install -qq --no-input --disable-pip-version-check "$@" ||
        die "pip failed (see above). $AGAIN"
}

# An environment of its own in a temporary folder, with what sails beside Ship Gym, for the rest of
# the script, from outside the checkout. Gives: work (the folder, deleted at the end), PY, started.
set_up_beside() { # EXTRA SOURCE SIZE [PACKAGE...]; SOURCE is the checkout or a wheel
    local extra="$1" source_="$2" size="$3" python
    shift 3
    python="$(find_python)"
    work="$(mktemp -d)"
    trap 'rm -rf "$work"' EXIT
    PY="$work/venv/bin/python"
    started=$SECONDS
    say "Installing ship-gym[$extra] for $("$python" --version) (about 1 minute, $size of disk)"
    "$python" -m venv "$work/venv"
    pip_install "$TORCH" "${source_}[$extra]" "$@"
    "$PY" -m pip --disable-pip-version-check check
    say "Installed in $((SECONDS - started)) s"
    mkdir "$work/here"
    cd "$work/here"
    unset PYTHONPATH
}

# Two set-ups at once must not write into one environment. Without flock (macOS) we go ahead.
lock() {
    command -v flock >/dev/null || return 0
    exec 9>"$VENV.lock"
    flock --nonblock 9 && return
    say "Waiting for another set-up of $VENV to finish"
    flock 9
}

unlock() { { exec 9>&-; } 2>/dev/null || true; }
