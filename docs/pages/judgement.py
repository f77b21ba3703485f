"""What policies claim, tested on seeds that nobody has used: see scripts/policy_claims.toml."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from ship_gym_agents import make_controller
from ship_gym_agents.controllers import PRETRAINED

from ship_gym.config import ConfigError, build, check_known
from ship_gym.evaluation import metrics_of, rollout
from ship_gym.evaluation.comparison import per_episode
from ship_gym.evaluation.score import normalised
from ship_gym.evaluation.splits import SPLITS
from ship_gym.evaluation.statistics import Paired, estimate, holm, interquartile_mean, paired, rate
from ship_gym.keys import Keys
from ship_gym.provenance import provenance, sha256
from ship_gym.reading import read_as, read_text, read_toml
from ship_gym.scenarios.scenario import load_scenario
from ship_gym.text import signed_interval, table
from ship_gym.writing import atomic_path

CHOICE = (1_500_000, 64)  # first seed and number of those that choose the opponent: tuning seeds
NOTHING = "constant"
FAILURES = 1  # of all episodes: by how many a policy may fail more often than its opponent
ARRIVED = "arrived"  # how outcomes of voyages that arrived begin


@dataclasses.dataclass(frozen=True)
class Claim:
    """One policy, where it is judged, and by what.

    Attributes
    ----------
    name, policy, scenario, ship, measure : str
    against : tuple of str
        Classical controllers.
    every : bool
        The policy is compared with each of them, not with the best one only.
    lower, not_higher : tuple of str
        Measures.
    within : float
        Share of the opponent's mean by which `measure` may be higher; 0: not tested.
    points : float
        How many points of the normalised score it may be below the best of `against`; 0: no limit.
    arrive : bool
        Every voyage must arrive, in the corridor or not.
    control : str, optional
        That of the scenario if omitted.
    shown : tuple of str
        Scenarios reported without a verdict.
    skip : int
        First seeds that are left out, because an earlier policy of this name was judged on them.
    seen : str
        What the time histories show, in words.
    """

    name: str
    policy: str
    scenario: str
    ship: str
    measure: str
    against: tuple[str, ...]
    every: bool = False
    lower: tuple[str, ...] = ()
    not_higher: tuple[str, ...] = ()
    within: float = 0.0
    points: float = 0.0
    arrive: bool = False
    control: str | None = None
    shown: tuple[str, ...] = ()
    skip: int = 0
    seen: str = ""

    def __post_init__(self):
        known = metrics_of(load_scenario(self.scenario).task)
        for name in (self.measure, *self.lower, *self.not_higher):
            check_known(f"claim {self.name}: measure", name, known)


def read_claims(path: str | Path, only: Sequence[str] | None = None) -> list[Claim]:
    """Claims of a file, all of them or those named."""
    claims = Keys(read_toml(path), str(path)).items("claim")
    found = [build(Claim, one, f"{path}: claim") for one in claims]
    names = [one.name for one in found]
    for name in only or ():
        check_known("claim", name, names)
    return [one for one in found if not only or one.name in only]


class Sailor:
    """Sails episodes once and keeps their metrics in a folder.

    Parameters
    ----------
    split : str
        Of the seeds.
    n : int
    folder : path
    """

    def __init__(self, split: str, n: int, folder: Path):
        first = SPLITS[check_known("split", split, SPLITS)].first
        self.seeds, self.folder = range(first, first + n), Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)

    def judged(self, skip: int) -> range:
        """The judged seeds, without the first `skip` of the split."""
        return range(self.seeds.start + skip, self.seeds.stop + skip)

    def sail(
        self,
        controller: str,
        scenario: str,
        ship: str,
        control: str | None,
        skip: int = 0,
        seeds: range | None = None,
    ) -> dict[str, np.ndarray]:
        """Metrics of every episode, nan where one has none; on `seeds` or the judged ones."""
        seeds = self.judged(skip) if seeds is None else seeds
        made = make_controller(controller)
        key = "-".join((Path(controller).name, _sha(controller), scenario, ship, control or ""))
        file = self.folder / f"{key}-{seeds.start}-{len(seeds)}.json".replace("/", "_")
        if not file.is_file():
            sailed = rollout(made, scenario, seeds=seeds, ship=ship, control=control)
            outcomes = [one.meta["outcome"] for one in sailed.episodes]
            values = {"metrics": per_episode(sailed), "outcomes": outcomes, **provenance()}
            with atomic_path(file) as temporary:
                temporary.write_text(json.dumps(values), encoding="utf-8")
        with read_as(file, "metrics of episodes"):  # which may be nan, so it is not quite JSON
            found = json.loads(read_text(file))
            arrived = [outcome.startswith(ARRIVED) for outcome in found["outcomes"]]
            columns = found["metrics"] | {ARRIVED: arrived}
            return {name: np.array(column, dtype=np.float64) for name, column in columns.items()}


def _sha(controller: str) -> str:
    """Beginning of the SHA-256 of a controller's file; empty for one of the package's code."""
    for path in (PRETRAINED / f"{controller}.safetensors", Path(controller)):
        if path.is_file():
            return sha256(path)[:10]
    return ""


def seeds_of_run(claim: Claim, runs: Path | None) -> list[str]:
    """Policies of all training seeds of the claim's recipe, where the folder of runs is there."""
    if runs is None:
        return []
    found = sorted((runs / claim.policy).glob("seed_*/policy.safetensors"))
    return [str(path) for path in found]


def plan(claims: Sequence[Claim], runs: Path | None) -> list[tuple]:
    """Everything to sail: controller, scenario, ship, control, judged seeds left out."""
    work: dict[tuple, None] = {}
    for claim in claims:
        names = (NOTHING, claim.policy, *claim.against, *seeds_of_run(claim, runs))
        for name in names:
            work[name, claim.scenario, claim.ship, claim.control, claim.skip] = None
        for scenario in claim.shown:
            for name in (claim.policy, *claim.against):
                work[name, scenario, claim.ship, claim.control, claim.skip] = None
    return list(work)


def opponents(claim: Claim, sailor: Sailor) -> list[str]:
    """Whom a policy is compared with: each, or the best of the tuning seeds."""
    if claim.every:
        return list(claim.against)
    seeds = range(CHOICE[0], CHOICE[0] + CHOICE[1])
    means = {}
    for name in claim.against:
        found = sailor.sail(name, claim.scenario, claim.ship, claim.control, seeds=seeds)
        means[name] = _level(found[claim.measure])
    return [min(means, key=lambda name: means[name])]


def judge(claims: Sequence[Claim], sailor: Sailor, runs: Path | None = None) -> list[dict]:
    """Verdicts, plain values for JSON; p-values are Holm's over all tests of all claims."""
    judged, tests = [], []
    for claim in claims:
        where = claim.scenario, claim.ship, claim.control, claim.skip
        names = dict.fromkeys((NOTHING, claim.policy, *claim.against))
        sailed = {name: sailor.sail(name, *where) for name in names}
        own = sailed[claim.policy]
        result = {
            **dataclasses.asdict(claim),
            "sha256": _sha(claim.policy),
            "levels": {name: _levels(found) for name, found in sailed.items()},
            "tests": [],
            "failures": {name: int((one["success"] == 0.0).sum()) for name, one in sailed.items()},
            "not_arrived": int((own[ARRIVED] == 0.0).sum()) if claim.arrive else 0,
            "score": _scores(claim, sailed),
            "seed_spread": [
                {"file": file, **_levels(sailor.sail(file, *where))}
                for file in seeds_of_run(claim, runs)
            ],
            "shown_levels": {
                scenario: {
                    name: _levels(sailor.sail(name, scenario, *where[1:]))
                    for name in (claim.policy, *claim.against)
                }
                for scenario in claim.shown
            },
            "extremes": _extremes(claim, own, sailor.judged(claim.skip)),
        }
        for opponent in opponents(claim, sailor):
            for measure, kind in _asked(claim):
                test = _test(measure, kind, opponent, own, sailed[opponent])
                test["limit"] = claim.within * test["theirs"]
                result["tests"].append(test)
                tests.append(test)
        judged.append(result)
    for test, p in zip(tests, holm([test["p"] for test in tests]), strict=True):
        test["p_holm"] = float(p)
        test["holds"] = _holds(test)
    for result in judged:
        result["holds"] = all(test["holds"] for test in result["tests"]) and _beside(result)
    return judged


def _asked(claim: Claim) -> list[tuple[str, str]]:
    """Measures that are tested, and for what."""
    asked = [(name, "lower") for name in claim.lower]
    asked += [(name, "not higher") for name in claim.not_higher]
    return asked + ([(claim.measure, "within")] if claim.within else [])


def _test(measure: str, kind: str, opponent: str, own: dict, other: dict) -> dict[str, Any]:
    known = np.isfinite(own[measure]) & np.isfinite(other[measure])
    pair = own[measure][known], other[measure][known]
    found: Paired = paired(*pair, interquartile_mean)
    mean = paired(*pair)
    return {
        "measure": measure,
        "opponent": opponent,
        "kind": kind,
        "episodes": int(known.sum()),
        "theirs": float(interquartile_mean(other[measure][known])),
        "mean": dataclasses.asdict(mean),
        **dataclasses.asdict(found),
    }


def _holds(test: Mapping[str, Any]) -> bool:
    if test["kind"] == "lower":
        return test["high"] < 0.0 and test["p_holm"] < 0.05
    if test["kind"] == "within":
        return test["high"] <= test["limit"]
    return test["value"] <= 0.0


def _beside(result: Mapping[str, Any]) -> bool:
    """What a claim says without a test: failures, arrivals, points of the score."""
    failures = result["failures"]
    met = [test["opponent"] for test in result["tests"]] or result["against"]
    fewest = min(failures[name] for name in met)
    if failures[result["policy"]] > fewest + FAILURES:
        return False
    if result["arrive"] and result["not_arrived"]:
        return False
    score = result["score"][result["policy"]] or 0.0  # that of the best classical one is 100
    return result["points"] == 0.0 or score >= 100.0 - result["points"]


def _scores(claim: Claim, sailed: Mapping[str, dict]) -> dict[str, float | None]:
    """Normalised scores on these seeds; 100 is the best of the classical controllers here."""
    means = {name: _level(found[claim.measure]) for name, found in sailed.items()}
    best = min(means[name] for name in claim.against)
    return {name: normalised(x, means[NOTHING], best) for name, x in means.items()}


def _level(column: np.ndarray) -> float:
    return float(interquartile_mean(column[np.isfinite(column)]))


def _levels(found: Mapping[str, np.ndarray]) -> dict[str, dict[str, float | None]]:
    """Interquartile means with intervals; rates of success and arrival."""
    levels = {}
    for name, column in found.items():
        known = column[np.isfinite(column)]
        if len(known):
            of = rate if name in ("success", ARRIVED) else estimate
            levels[name] = dataclasses.asdict(of(known))
    return levels


def _extremes(claim: Claim, own: Mapping[str, np.ndarray], seeds: range) -> dict[str, int]:
    """Seeds of the best, median and worst episode of the policy by the claim's measure."""
    column = np.where(np.isfinite(own[claim.measure]), own[claim.measure], np.inf)
    order = np.argsort(column, kind="stable")
    picks = {"best": 0, "median": len(order) // 2, "worst": len(order) - 1}
    return {name: int(seeds[order[k]]) for name, k in picks.items()}


def told(judged: Sequence[Mapping[str, Any]]) -> str:
    """Verdicts as a table."""
    rows = []
    for claim in judged:
        if not claim["tests"]:
            score = claim["score"][claim["policy"]]
            told = "-" if score is None else f"{score:.0f} points"
            verdict = "holds" if claim["holds"] else "does not hold"
            against = "/".join(claim["against"])
            rows.append([claim["name"], claim["measure"], against, "100 points", told, "", verdict])
        for test in claim["tests"]:
            rows.append(
                [
                    claim["name"],
                    test["measure"],
                    test["opponent"],
                    f"{test['theirs']:.4g}",
                    signed_interval(test["value"], test["low"], test["high"]),
                    f"{test['p_holm']:.3f}",
                    "holds" if test["holds"] else "does not hold",
                ]
            )
    header = ["claim", "measure", "against", "theirs", "difference", "p (Holm)", "verdict"]
    if not rows:
        raise ConfigError("no claim to judge")
    return table(header, rows, None)
