"""What readers of the pages have beforehand, and where a test sails less than they do."""

from tests.docs import given
from tests.docs.blocks import ROOT
from tests.docs.running import Reader

DOCS = ROOT / "docs"
FEW = "--steps 4096 --set training.validations=1 duration=60"  # a training of seconds

READERS = {
    "docs/autopilot_loop.md": Reader(
        libraries=("pynmea2", "pyproj", "gpxpy", "rerun"),
        given={"route.rtz": DOCS / "examples/kiel.rtz"},
        shorter={
            "ship-gym serve           ": "ship-gym serve --duration 5 --speed-up 1000 --port 0",
            "--speed-up 10 --duration 3600": "--speed-up 1000 --duration 60 --port 0",
            "--rate HDT=5": "--duration 60 --speed-up 1000 --port 0 --rate HDT=5",
            "ship-gym serve --lockstep --duration 300 &": "",  # both ends: tests/agents/serve
        },
    ),
    "docs/benchmark.md": Reader(
        libraries=("pyarrow", "matplotlib", "torch"),
        given={
            "mine.py": given.controller("Mine"),
            "my_ship.toml": given.ship,
            "my_task.py": given.file_in("docs/tutorials/own_task.md", "turn_steadily.py"),
            "my_scenario.toml": 'base = "track_economy"\nduration = 300.0\n',
        },
        shorter={
            # tests/evaluation/test_benchmark.py has Ray
            "ship-gym benchmark --suite all --engine ray": "# ",
            "ship-gym benchmark --": "ship-gym benchmark --jobs 1 --",
            "--suite heading   ": "--suite heading --seeds 1 --ships kcs --controllers pid  ",
            "--ships kcs dtc --controllers ilos mine.py:Mine --seeds 32": "--ships kcs "
            "--controllers ilos --seeds 1 --no-report",
            "seeds=32": 'seeds=2, ships=["kcs"]',
            "my_suite.toml --out": "my_suite.toml --seeds 2 --no-report --out",
        },
    ),
    "docs/cosimulation.md": Reader(libraries=("pythonfmu",), given={"mine/ship.toml": given.ship}),
    "docs/datasets.md": Reader(
        libraries=("minari", "h5py"),
        given={"runs/heading": given.policy, "mine.py": given.controller("LQR")},
        before=("ship-gym dataset --episodes 2",),
        shorter={
            "ship-gym dataset      ": "# ",
            "--noise 0 0.1 --episodes 50": "--noise 0 0.1 --episodes 2",
            "--noise 0.05 --noise-time 30": "--noise 0.05 --noise-time 30 --episodes 2",
            "--out ~/.minari/datasets": "--out home/.minari/datasets --episodes 2",
            "episodes=200": "episodes=2",
            "episodes=30": "episodes=2",
        },
    ),
    "docs/own.md": Reader(
        libraries=("sklearn", "rerun"),
        given={
            "points.csv": ROOT / "ship_gym/surrogates/data/kcs_propeller_rudder_cfd.csv",
        },
        shorter={'DATA / "kvlcc2_model"': 'DATA / "kcs_model"'},  # the ship that was computed
    ),
    "docs/fit_hull.md": Reader(
        libraries=("matplotlib",),
        given={
            "docs/examples/kvlcc2_hmri/ship.toml": DOCS / "examples/kvlcc2_hmri/ship.toml",
            "mine/ship.toml": given.ship,
            **dict.fromkeys(("drift.csv", "yaw.csv", "yaw_drift.csv"), given.captive),
            **dict.fromkeys(("turn.csv", "zigzag.csv", "other.csv"), given.record),
        },
    ),
    "docs/policy_files.md": Reader(
        libraries=("onnx", "onnxruntime"), given={"runs/heading": given.policy}
    ),
    "docs/recordings.md": Reader(
        libraries=("rerun", "gpxpy", "pyproj"),
        given={
            "kiel.rtz": DOCS / "examples/kiel.rtz",
            "runs/a": given.policy,
        },
        # for the block that reads it; the page records it at its end
        before=(
            "ship-gym record --controller ilos --scenario track_following --seed 5"
            " --out runs/kiel.rrd --set track.kind=points --set track.file=kiel.rtz",
        ),
        shorter={"--seeds 100": "--seeds 3"},
    ),
    "docs/routes.md": Reader(
        libraries=("pyproj", "gpxpy", "matplotlib"),
        given={"docs/examples/kiel_gedser.rtz": DOCS / "examples/kiel_gedser.rtz"},
    ),
    "docs/speed.md": Reader(
        shorter={
            # tests/scripts/test_speed.py has the same, shorter; --against needs a second checkout
            "ship-gym speed --full": "# ",
            "ship-gym speed --against ../before ": "# ",
            # takes minutes: tests/reports/test_warm_up.py
            "ship-gym warm-up": "# ",
        },
    ),
    "docs/training.md": Reader(
        libraries=("stable_baselines3", "optuna", "matplotlib"),
        given={"my_ranges.toml": given.file_in("docs/training.md", "my_ranges.toml")},
        shorter={
            "--minutes 2 --out": f"{FEW} algorithm.episodes=8 --out",
            "--episodes 64": "--episodes 4",
            "--minutes 10 --set": FEW,
            "duration=300 ": "",
            "--recipe mine.toml --set": f"--recipe mine.toml {FEW}",
            "--minutes 2 --trials 30 --jobs 2": "--steps 2048 --set duration=200 --episodes 2 "
            "--trials 1 --confirm 1 --ranges my_ranges.toml",
            "--algo ppo --hyper": f"--algo ppo {FEW} --hyper",
        },
    ),
    "docs/seaway.md": Reader(
        libraries=("matplotlib",),
        given={
            "docs/spectra/hindcast.csv": DOCS / "spectra/hindcast.csv",
            "spectra/hindcast.csv": DOCS / "spectra/hindcast.csv",
        },
    ),
    "docs/clients.md": Reader(libraries=("stable_baselines3", "moviepy")),
    "docs/gpu.md": Reader(libraries=("torch",)),
    "docs/making.md": Reader(libraries=("PIL",)),
}
