"""Run: what every training run keeps, whatever learns in it.

A learner (stable-baselines3, Gauss-Newton) calls `Run.between` between two updates; all that is due
then happens there and is not charged to the budget: validations and checkpoints, each of which has
the best policy, too. What can be lost by a kill is what was learned since the last checkpoint.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from ship_gym.config import ConfigError
from ship_gym.evaluation.splits import VALIDATION_SEED
from ship_gym.provenance import provenance
from ship_gym_agents.controllers import make_controller
from ship_gym_agents.policies.policy_file import POLICY_FILE, load_policy, save_policy
from ship_gym_agents.sb3.config import CARD_FILE, RunConfig, check_free, is_config_of, plain
from ship_gym_agents.training.budget import Budget
from ship_gym_agents.training.recordings import Recordings
from ship_gym_agents.training.run_folder import TrainingFolder
from ship_gym_agents.training.score import Validation, score_of, validate

EPISODES = (64, 32, 16)  # of a validation: as many as the budget bears
_SHARE = 0.1  # of the time of training, for all validations together
_FEWEST = 4  # validations that the number of episodes leaves time for

Report = Callable[[float, float | None], Any]


class Run:
    """One run: config, budget, validations, best policy.

    Parameters
    ----------
    config : RunConfig
    folder : TrainingFolder
        Held by this process.
    minutes, steps : optional
        The budget, see `Budget`.
    resume : bool
        Continue what is in the folder; what was killed before its first checkpoint begins anew.
    told : mapping
        Further entries of the card, such as the command.
    report : callable, optional
        Called with the used share and the score after every validation; may raise to end the run.

    Attributes
    ----------
    samples : int
        So far.
    best, chosen : policy, dict
        The best policy so far and its validation; None before the first.
    checkpoint : Path or None
        Folder of the state to go on from.

    Raises
    ------
    ConfigError
        A folder that holds a run, another config than the run's, or a budget that is used up by a
        run that has ended; one that was killed after its last sample goes on to its end.
    """

    def __init__(
        self,
        config: RunConfig,
        folder: TrainingFolder,
        minutes: float | None,
        steps: int | None,
        resume: bool,
        told: dict[str, Any] | None = None,
        report: Report | None = None,
    ):
        Budget(minutes, steps)  # refused before anything is written
        self.config, self.folder, self._report = config, folder, report
        self._recordings = Recordings(folder.path, config.hyperparameters.training.record)
        state = self._earlier(resume)
        self.checkpoint = folder.checkpoint() if state else None
        self.samples = state["samples"] if state else 0
        self.validations: list[dict[str, Any]] = state["validations"] if state else []
        self.budget = Budget(minutes, steps, state["seconds"] if state else 0.0)
        if self.used >= 1.0 and self._ended:
            raise ConfigError(
                f"{folder.path}: its budget is used up ({self.samples} samples, "
                f"{self.budget.seconds / 60.0:.2f} min); give more minutes or steps in all"
            )
        self.score = score_of(config.scenario, config.hyperparameters.training.wear)
        if state:
            self.score = self.score._replace(limit=state["limit"])
        self.episodes = state["episodes"] if state else EPISODES[0]
        self._validated = state["validated"] if state else 0.0  # seconds of validations
        self._cost, self._due, self._kept = 0.0, 0.0, time.monotonic()
        self.best = load_policy(folder.path) if self.validations else None
        self.chosen: dict[str, Any] | None = self.best.card["best"] if self.best else None
        self._told = (told or {}) | self._of_before | provenance()
        self.final: dict[str, Any] | None = None
        self.write("running")

    def _earlier(self, resume: bool) -> dict[str, Any] | None:
        """State of the run to resume; None: it begins."""
        if not resume:
            check_free(self.folder.path)
        card = self.folder.card()
        if card is not None and not is_config_of(self.folder.path, self.config):
            raise ConfigError(
                f"{self.folder.path}: cannot resume with another config than in {CARD_FILE}"
            )
        self._before = card
        self._ended = card is not None and card["status"] == "complete"
        told = card or {}
        self._of_before = {key: told[key] for key in ("command", "init") if key in told}
        state = self.folder.state()
        if state is None:
            self.folder.clear()
        self._recordings.keep_first(len(state["validations"]) if state else 0)
        return state

    @property
    def name(self) -> str:
        """Name of the run and of its policy."""
        return f"{self.config.algorithm}-{self.folder.name}"

    @property
    def used(self) -> float:
        """Share of the budget that is used up."""
        return self.budget.used(self.samples)

    @property
    def last(self) -> dict[str, Any] | None:
        """The last validation."""
        return self.validations[-1] if self.validations else None

    def begin(self, policy: Callable[[], Any], save: Callable[[Path], None]) -> None:
        """Size the validations, judge what the run begins with, and let the clock run."""
        if not self.validations:
            self._size(policy())
            self._set_limit()
            self._validate(policy(), {})
            self._keep(save)
        self._next()
        self.budget.start()

    def _size(self, policy: Any) -> None:
        """As many episodes as leave time for some validations; with a budget of samples, most."""
        if self.budget.minutes is None:
            return
        few = EPISODES[-1]
        cost = self._sail(policy, _seeds(few)).seconds / few
        spare = _SHARE * 60.0 * self.budget.minutes / _FEWEST
        self.episodes = next((n for n in EPISODES if n * cost <= spare), few)

    def _set_limit(self) -> None:
        """The rudder travel that the price holds, on the validation seas if it is the base's."""
        limit: Any = self.config.hyperparameters.price.limit
        if limit == "base":
            base = make_controller(self.config.hyperparameters.form.base)
            limit = self._sail(base, self.seeds).means["rudder_travel"]
        self.score = self.score._replace(limit=float(limit) if limit else None)

    def _sail(self, controller: Any, seeds: list[int], worst: bool = False) -> Validation:
        """Validation episodes with all ships of the training."""
        ships = self.config.hyperparameters.training.ships
        return validate(controller, self.config.scenario, seeds, self.score, ships, worst)

    @property
    def seeds(self) -> list[int]:
        """Seeds of the validations."""
        return _seeds(self.episodes)

    def _next(self) -> None:
        """Set the share of the budget at which the next validation is due."""
        interval = 1.0 / self.config.hyperparameters.training.validations
        self._due = (int(self.used / interval + 1e-9) + 1.0) * interval

    def _is_due(self) -> bool:
        """Whether to validate now: in time, and not more often than the time of training bears."""
        if self.used < self._due or self.used >= 1.0:
            return False
        spent = self._validated + self._cost
        return self.budget.minutes is None or spent <= _SHARE * self.budget.seconds

    def between(
        self,
        samples: int,
        policy: Callable[[], Any],
        save: Callable[[Path], None],
        **learner: float,
    ) -> dict[str, Any] | None:
        """Do what is due between two updates.

        Parameters
        ----------
        samples : int
            So far.
        policy : callable
            Gives the present policy.
        save : callable
            Writes the learner's state into the folder it is given.
        **learner
            What the curve tells beside the validation, such as ``multiplier``.

        Returns
        -------
        dict or None
            The validation, if there was one.
        """
        self.samples = samples
        with self.budget.uncharged():
            found = None
            if self._is_due():
                found = self._validate(policy(), learner)
                self._next()
            elif time.monotonic() - self._kept < self._interval:
                return None
            self._keep(save)
        if found and self._report:
            self._report(self.used, found[self.score.name])
        return found

    @property
    def _interval(self) -> float:
        return self.config.hyperparameters.training.checkpoint

    def _keep(self, save: Callable[[Path], None], status: str = "running") -> None:
        """Write all that there is as a new generation of the folder."""
        state = {
            "samples": self.samples,
            "seconds": self.budget.seconds,
            "episodes": self.episodes,
            "limit": self.score.limit,
            "validated": self._validated,
            "validations": self.validations,
        }
        with self.folder.new_checkpoint(state, self._card(status)) as folder:
            save(folder)
            if self.best is not None:
                save_policy(self.best, folder / POLICY_FILE)
        self._kept = time.monotonic()

    def _validate(self, policy: Any, learner: dict[str, float]) -> dict[str, Any]:
        """Sail the validation episodes; keep the policy if it is the best so far."""
        number = len(self.validations) + 1
        recorded = self._recordings.due(number)
        sailed = self._sail(policy, self.seeds, recorded)
        if recorded:
            self._recordings.keep(number, sailed.worst)
        self._cost = sailed.seconds
        self._validated += sailed.seconds
        found = {**sailed.means, **learner, "samples": self.samples}
        found["seconds"] = round(self.budget.seconds, 2)
        self.validations.append(found)
        if self.chosen is None or self.score.key(found) < self.score.key(self.chosen):
            self.best, self.chosen = policy, found
            self._describe_best("running")
        return found

    def end(
        self,
        samples: int,
        policy: Callable[[], Any],
        save: Callable[[Path], None],
        judge: Callable[[Any], dict[str, Any]] | None = None,
        **learner: float,
    ) -> dict[str, Any]:
        """Validate the last policy, judge the best one, write everything; returns the card."""
        self.samples = samples
        with self.budget.uncharged():
            found = self.last
            if found is None or found["samples"] != samples:  # else it was killed in its end
                found = self._validate(policy(), learner)
            self._keep(save)
            if judge is not None:
                self.final = judge(self.best)
            self._describe_best("complete")
            self._keep(save, "complete")
        if self._report:
            self._report(1.0, found[self.score.name])
        card = self.folder.card()
        assert card is not None  # as it was written now
        return card

    @contextlib.contextmanager
    def broken_off(
        self, samples: Callable[[], int], save: Callable[[Path], None]
    ) -> Iterator[None]:
        """Keep what there is of a run that ends early, and let on what ended it.

        Parameters
        ----------
        samples : callable
            Gives those so far.
        save : callable
            As of `between`.
        """
        try:
            yield
        except BaseException as stop:
            self.samples = samples()
            with self.budget.uncharged():
                self._keep(save, status_of(stop))
            raise

    def _describe_best(self, status: str) -> None:
        """Let the best policy tell of the run as it is now."""
        assert self.best is not None
        self.best.card = {**self.best.card, **self._card(status)}

    def refuse(self) -> None:
        """Give a run that could not go on its card back; one that began here is stopped."""
        if self._before is not None and self.folder.checkpoint() == self.checkpoint:
            self.folder.write_card(self._before)
        else:
            self.write("stopped")

    def write(self, status: str) -> None:
        """Write the card."""
        self.folder.write_card(self._card(status))

    def _card(self, status: str) -> dict[str, Any]:
        budget = self.budget
        card = {
            "name": self.name,
            "status": status,
            "config": plain(self.config),
            "budget": {"minutes": budget.minutes, "steps": budget.steps},
            "samples": self.samples,
            "seconds": round(budget.seconds, 2),
            "used": round(self.used, 4),
            "validation_seeds": [VALIDATION_SEED, VALIDATION_SEED + self.episodes - 1],
            "score": self.score.text,
            "measure": {"name": self.score.name, "unit": self.score.unit},
            "validations": self.validations,
            **self._told,
        }
        told = {"best": self.chosen, "final": self.final}
        return card | {key: value for key, value in told.items() if value is not None}


def status_of(stop: BaseException) -> str:
    """Status of a run that this ended early."""
    return "interrupted" if isinstance(stop, KeyboardInterrupt) else "stopped"


def _seeds(count: int) -> list[int]:
    return list(range(VALIDATION_SEED, VALIDATION_SEED + count))
