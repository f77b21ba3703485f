#!/usr/bin/env bash
# Set up, then check everything: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/test.sh [--fast] [pytest arguments]

Makes a virtual environment (.venv) if needed, then runs ruff check, ruff format --check,
lint-imports, mypy, the fast tests and the slow tests. The exit code is 0 only if all of them pass.

  --fast              leave out the slow tests (long validation against trials)
  --kernel-coverage   nothing but the tests of the kernels, with compilation off: prints which
                      lines of the modules with kernels they run, fails below 99 %
  -h, --help          this text
  Anything else goes to all pytest runs, after our own arguments.

Environment: PYTHON (Python >= 3.11 to use), SHIP_GYM_VENV (default .venv),
SHIP_GYM_TEST_WORKERS (pytest processes, default 2).

Examples:
  bash scripts/test.sh                          # all of it, as CI does
  bash scripts/test.sh --fast tests/physics -x  # one folder, stop at the first failure
  bash scripts/test.sh --kernel-coverage        # lines of kernels that no test runs
HELP
}

# Share of the lines of modules with kernels that the tests run [%]: 99.8 measured, 4 of 1647 are
# left: an import error, an outcome without a name on the card, loads there that are not finite.
KERNEL_LINES=99

slow=yes
kernel_coverage=no
arguments=()
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --fast) slow=no ;;
    --kernel-coverage) kernel_coverage=yes ;;
    *) arguments+=("$1") ;;
    esac
    shift
done

failed=()      # names of the checks that failed
good_lines=()  # pytest's closing lines
bad_lines=()   # those of failed runs, printed last
tests_ran=no

check() { # NAME COMMAND...: run it, remember a failure, go on
    local name="$1"
    shift
    say "$name"
    "$@" || failed+=("$name")
}

run_pytest() { # NAME MARKER-EXPRESSION
    local color=no code=0
    [ -t 1 ] && color=yes
    say "$1"
    if "$PY" -m pytest -n "${SHIP_GYM_TEST_WORKERS:-2}" --color="$color" -m "$2" \
        ${arguments[@]+"${arguments[@]}"} 2>&1 | tee "$log"; then
        code=0
    else
        code=${PIPESTATUS[0]}
    fi
    if [ "$code" -eq 5 ]; then # nothing collected: fine for one of the two runs, not for both
        say "$1: none selected"
        return
    fi
    tests_ran=yes
    local line # stays empty when pytest itself crashed
    line="$(grep -E '(passed|failed|skipped|error|xfailed).* in [0-9.]+s' "$log" | tail -n 1)" || true
    if [ "$code" -eq 0 ]; then
        good_lines+=("$line")
    else
        failed+=("$1")
        bad_lines+=("$line")
    fi
}

cover_kernels() { # compiled code leaves no trace, so Python runs the kernels: about 1 minute
    local settings code=0
    settings="$(mktemp)"
    { echo "[report]" && echo "include =" && grep -rl --include="*.py" "^@kernel" ship_gym | sed "s/^/    /"; } \
        >"$settings"
    NUMBA_DISABLE_JIT=1 "$PY" -m pytest -n "${SHIP_GYM_TEST_WORKERS:-2}" \
        -m "not slow and not compiled" --cov=ship_gym "--cov-config=$settings" \
        --cov-report=term-missing:skip-covered "--cov-fail-under=$KERNEL_LINES" \
        ${arguments[@]+"${arguments[@]}"} \
        tests/physics tests/sea tests/tasks tests/tracks tests/envs/test_interval.py \
        tests/gpu/test_kernels.py || code=$?
    rm -f "$settings"
    return "$code"
}

set_up
cd "$ROOT"
export PATH="$VENV/bin:$PATH" MPLBACKEND=Agg
# As many processes as processors: threads of BLAS and torch would only wait for each other.
export OMP_NUM_THREADS="${OMP_NUM_THREADS:-1}"
log="$(mktemp)"
trap 'rm -f "$log"' EXIT

if [ "$kernel_coverage" = yes ]; then
    say "coverage of the kernels"
    cover_kernels
    exit
fi
# Once, while the checks leave a processor idle, what each process of pytest would do for itself:
# machine code that hundreds of tests share, bytecode of tests and packages. What is wrong with
# these the tests say.
prepare() {
    SHIP_GYM_ONE_VERSION=1 "$VENV/bin/ship-gym" warm-up --jobs 1 --task heading_keeping \
        --task course_changing --task track_following --task tests/recipes/hold_yaw_rate.py || true
    PYTHONDONTWRITEBYTECODE="" "$PY" -m pytest --collect-only -q || true
}

preparing=
if [ ${#arguments[@]} -eq 0 ]; then # all tests, not a few
    prepare >/dev/null 2>&1 &
    preparing=$!
fi
check "ruff check" ruff check .
check "ruff format --check" ruff format --check .
check "lint-imports" lint-imports
check "mypy" mypy
[ -z "$preparing" ] || wait "$preparing"
run_pytest "fast tests" "not slow"
[ "$slow" = no ] || run_pytest "slow tests" "slow"
[ "$tests_ran" = yes ] || failed+=("no test ran")

for name in ${failed[@]+"${failed[@]}"}; do
    say "FAILED: $name"
done
[ ${#failed[@]} -gt 0 ] || say "All checks passed"
for line in ${good_lines[@]+"${good_lines[@]}"} ${bad_lines[@]+"${bad_lines[@]}"}; do
    [ -z "$line" ] || printf '%s\n' "$line"
done
[ ${#failed[@]} -eq 0 ]
