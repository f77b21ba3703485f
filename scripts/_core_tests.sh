# shellcheck shell=bash
# Sourced by test_lowest.sh and test_matrix.sh, after _setup.sh: the tests that say most in little
# time, and how they run in an environment of their own.
# Gives: SCALAR, USUAL (files of tests), run_pytest, use_command.
# Reads: PY (the environment's python).

# With any gymnasium from the floor on: what these use of it are the scalar environments.
SCALAR=(tests/envs/test_old_gymnasium.py)

# Physics, sea, ships, tracks, tasks, environments, evaluation.
USUAL=(
    tests/envs/{test_old_gymnasium,test_env,test_vector_env,test_start_options,test_streams}.py
    tests/physics/{test_actuators,test_angles,test_dynamics,test_elementary,test_kernel}.py
    tests/sea/{test_components,test_gusts,test_records,test_spectra,test_wave_response}.py
    tests/ships/{test_loader,test_estimators,test_form,test_records,test_scaling}.py
    tests/tracks tests/tasks tests/scenarios
    tests/evaluation/{test_metrics,test_rollout,test_splits,test_statistics,test_suite}.py
    tests/evaluation/{test_episodes_table,test_trajectory_table}.py tests/plotting/test_benchmark.py
    tests/test_{config,conventions,csv_file,import,simulation,tables}.py
)

run_pytest() { # FILES...
    MPLBACKEND=Agg PATH="$(dirname "$PY"):$PATH" "$PY" -m pytest -q -p no:cacheprovider \
        -n "${SHIP_GYM_TEST_WORKERS:-2}" -m "not slow" "$@"
}

use_command() { # FOLDER for what it writes
    local command
    command="$(dirname "$PY")/ship-gym"
    "$command" list ships >/dev/null
    "$command" evaluate --controllers pid --episodes 2 --set duration=100 --out "$1/evaluation.json" >/dev/null
    "$command" simulate turning --out "$1/turn.png" --csv "$1/turn.csv" >/dev/null
}
