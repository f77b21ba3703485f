"""ShipEnv: the scalar Gymnasium environment, a batch of one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np

from ship_gym.config import ConfigError
from ship_gym.envs.episodes import N_ACTIONS, EpisodeBatch
from ship_gym.scenarios.scenario import Scenario, load_scenario
from ship_gym.ships.particulars import Ship
from ship_gym.tasks.heading import OBSERVATION_HIGH, OBSERVATION_LOW

_ALL = np.array([0])


def resolved_scenario(
    scenario: str | Mapping[str, Any] | Scenario,
    ship: str | Ship | None,
    control: str | None,
    surrogate: str | None,
    overrides: Mapping[str, Any] | None,
) -> tuple[Scenario, Ship | None]:
    """Scenario with the arguments of an environment applied, and the ship if it is an object."""
    changes = dict(overrides or {})
    if isinstance(ship, Ship):
        if surrogate is not None:
            raise ConfigError(
                f"surrogate = {surrogate!r}: the ship given as an object brings its own, "
                f"{ship.surrogate_name!r}"
            )
        given = {"ship": ship.name, "surrogate": ship.surrogate_name, "control": control}
    else:
        given = {"ship": ship, "surrogate": surrogate, "control": control}
    changes.update({key: value for key, value in given.items() if value is not None})
    if isinstance(scenario, Scenario):
        scenario = scenario.to_dict()
    return load_scenario(scenario, changes), ship if isinstance(ship, Ship) else None


def check_render_mode(render_mode: str | None) -> None:
    """Refuse a render mode; recordings are the way to look at a rollout."""
    if render_mode is not None:
        raise ConfigError(
            f"render_mode = {render_mode!r}: allowed is None; record a rollout with "
            "scripts/record.py and look at it with rerun"
        )


def action_space(scenario: Scenario) -> gym.spaces.Box:
    """Box [-1, 1] of shape (1,) or (2,), float32."""
    return gym.spaces.Box(-1.0, 1.0, (N_ACTIONS[scenario.control],), np.float32)


def observation_space() -> gym.spaces.Box:
    """Box of shape (9,), float32, with the documented bounds."""
    return gym.spaces.Box(OBSERVATION_LOW, OBSERVATION_HIGH, dtype=np.float32)


class ShipEnv(gym.Env):
    """Hold an ordered heading against current and a slowly varying disturbance.

    ## Description
    A ship (default: the KRISO container ship at 14.5 kn, 230 m) sails by a 3-DoF MMG model with a
    propeller and rudder trained on CFD. The episode starts on a straight course with a heading
    error to remove; then a uniform current and a random low-frequency sway force and yaw moment
    push the ship off, and the autopilot holds the ordered heading with as little rudder as it can.
    With `scenario="heading_seaway"` irregular waves and gusting wind do that instead.
    The command passes a rate-limited steering gear and, with rpm control, an engine with lag.

    ## Action Space
    `Box(-1, 1, (1,), float32)` for `control="rudder"`, `(2,)` for `control="rudder+rpm"`.

    | Num | Action | Control | Meaning |
    | --- | --- | --- | --- |
    | 0 | rudder command | -1 to 1 | times delta_max (35 deg); positive turns to starboard |
    | 1 | propeller speed command | -1 to 1 | from 0 to n_max; without it: self-propulsion |

    Values outside are limited; NaN or a wrong shape is an error.

    ## Observation Space
    `Box(float32)` of shape `(9,)`. U0 is the ship's nominal speed, L its length.

    | Num | Symbol | Unit | Min | Max | Meaning |
    | --- | --- | --- | --- | --- | --- |
    | 0 | sin(psi_e) | - | -1 | 1 | sine of the heading error psi - psi_ordered |
    | 1 | cos(psi_e) | - | -1 | 1 | cosine of the heading error |
    | 2 | r L / U0 | - | -5 | 5 | yaw rate, positive to starboard |
    | 3 | u / U0 | - | -3 | 3 | surge velocity through the water |
    | 4 | v / U0 | - | -3 | 3 | sway velocity through the water, positive to starboard |
    | 5 | delta / delta_max | - | -1 | 1 | rudder angle achieved |
    | 6 | n / n_max | - | 0 | 1 | propeller speed achieved |
    | 7 | delta_c / delta_max | - | -1 | 1 | last rudder command |
    | 8 | n_c / n_max | - | 0 | 1 | last propeller speed command |

    In waves, heading error, yaw rate and sway velocity are measured with the wave-frequency motion
    on top of the slow motion that rewards and episode ends look at.

    ## Rewards
    Per control interval, each term times the interval in full-scale seconds; weights are keys of
    the scenario's `reward` section, values are returned in `info["reward_terms"]`:

    - `heading`: -1.0 psi_e^2 [rad^2]
    - `rudder`: -0.1 delta^2 [rad^2], so lambda = 0.1 in J = mean(psi_e^2) + lambda mean(delta^2)
    - `rudder_rate`: -0.002 (rudder change / largest change in one interval)^2
    - `speed_loss`: -0.05 (1 - u / U0)^2 where u < U0
    - `termination`: -200 once

    ## Starting State
    Straight course at U0 and self-propulsion, rudder amidships. Drawn at reset: ordered heading
    (any), heading error (uniform +-30 deg), current (0 to 1 m/s at full scale, any direction) and
    the phases of the disturbance (spectrum in `ship_gym/sea/state.py`).

    ## Episode End
    - Termination: the heading error exceeds 60 deg.
    - Truncation: 600 s (full scale), inside the environment; no TimeLimit wrapper is needed.

    ## Arguments
    ```python
    gym.make("ShipGym/HeadingKeeping-v0", ship="kcs", control="rudder", surrogate=None,
             overrides={"reward.rudder": 1.0, "duration": 900.0})
    ```

    - `ship`: one of `ship_gym.available_ships()`, the path of a ship file, or a `Ship`. Times and
      current of a model are Froude-scaled.
    - `control`: `"rudder"` or `"rudder+rpm"`.
    - `surrogate`: `"regression"`, `"gp"`, `"nn"` or another one of
      `ship_gym.available_surrogates(ship)`; the ship's default if None.
    - `scenario`: a name of `ship_gym.available_scenarios()`, a TOML file or a mapping.
    - `overrides`: keys of the scenario, nested or dotted; unknown keys are refused. With
      `{"randomisation.surrogate_std": 1.0}` each episode sails another draw from the surrogate's
      standard deviation; what was drawn is `info["randomisation"]`.

    ## Version History
    - v0: first version; current and random disturbance, no seaway yet.
    """

    metadata = {"render_modes": []}  # noqa: RUF012  Gymnasium's own form

    def __init__(
        self,
        ship: str | Ship | None = None,
        control: str | None = None,
        surrogate: str | None = None,
        scenario: str | Mapping[str, Any] | Scenario = "heading_keeping",
        overrides: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
    ):
        check_render_mode(render_mode)
        self.render_mode = render_mode
        self.scenario, given = resolved_scenario(scenario, ship, control, surrogate, overrides)
        self.episodes = EpisodeBatch(1, self.scenario, given, parallel=False)
        self.observation_space = observation_space()
        self.action_space = action_space(self.scenario)

    @property
    def ship(self) -> Ship:
        """The ship that sails."""
        return self.episodes.ship

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        """Begin an episode; all its randomness comes from one draw of ``np_random``."""
        super().reset(seed=seed)
        self.episodes.start(_ALL, self.np_random.random((1, self.episodes.n_draws)))
        return self.episodes.observations[0].copy(), self.episodes.info_of(0)

    def step(self, action):
        """Sail one control interval under one action."""
        episodes = self.episodes
        episodes.step(np.asarray(action)[None])
        return (
            episodes.observations[0].copy(),
            float(episodes.rewards[0]),
            bool(episodes.terminated[0]),
            bool(episodes.truncated[0]),
            self.episodes.info_of(0),
        )
