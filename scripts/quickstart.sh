#!/usr/bin/env bash
# From a fresh checkout to a trained autopilot: see --help.
set -euo pipefail
# shellcheck source=scripts/_setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/_setup.sh"

usage() {
    cat <<'HELP'
Usage: bash scripts/quickstart.sh [--short]

Makes a virtual environment (.venv) if needed, trains a heading autopilot for the container ship
KCS for two minutes, judges it beside the PID on a page, records a voyage and simulates a turning
circle. What is learned is a correction of a classical autopilot, so it begins as good as that one;
the page says whether it became better. Everything lands in runs/quickstart; what an earlier run
left there moves to runs/quickstart.previous.

  --short      train for 12 seconds only and judge on 8 episodes (a smoke test, not an autopilot)
  -h, --help   this text

Environment: PYTHON (Python >= 3.11 to use), SHIP_GYM_VENV (default .venv), RECIPE (plan of
training, default heading_gauss_newton), SUITE (what it is judged on, default
scripts/quickstart_suite.toml, which is of headings).

Examples:
  bash scripts/quickstart.sh
  PYTHON=python3.12 bash scripts/quickstart.sh --short
HELP
}

out=runs/quickstart
recipe=${RECIPE:-heading_gauss_newton}
suite=${SUITE:-scripts/quickstart_suite.toml}
minutes=2
episodes=64
while [ $# -gt 0 ]; do
    case "$1" in
    -h | --help) usage && exit 0 ;;
    --short) minutes=0.2 episodes=8 ;;
    *) die "unknown argument: $1 (see --help)" ;;
    esac
    shift
done

# The whole job; every flag of the verbs is here and nowhere else.
job() {
    step "Training for $minutes minutes ($recipe)" \
        train --recipe "$recipe" --minutes "$minutes" --out "$out"
    step "Judging it beside pid and adaptive on $episodes voyages that it has never seen" \
        benchmark --suite "$suite" --controllers "$out" pid adaptive --seeds "$episodes" \
        --out "$out/benchmark"
    step "Recording one voyage" \
        record --policy "$out" --out "$out/rollout.rrd"
    step "Simulating a turning circle" \
        simulate --out "$out/turning_circle.png"
}

step() { # WHAT VERB ARGUMENTS...
    say "$1"
    shift
    ship-gym "$@"
}

set_up
cd "$ROOT"
export PATH="$VENV/bin:$PATH" MPLBACKEND=Agg
if [ -e "$out" ]; then
    rm -rf "$out.previous"
    mv "$out" "$out.previous"
fi
mkdir -p "$out"
started=$SECONDS
job

say "Done in $((SECONDS - started)) s. In $ROOT/$out:"
for file in "$out"/*; do
    echo "      ${file##*/}"
done
cat <<NEXT
==> Try next
      source $VENV/bin/activate
      xdg-open $out/benchmark/report.html   # the page, in a browser
      ship-gym review show $out/rollout.rrd   # watch the voyage
      ship-gym train --help               # another ship, sea, algorithm, longer
      ship-gym simulate --help            # other manoeuvres
NEXT
