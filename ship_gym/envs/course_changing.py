"""CourseChanging: the environment id and its page."""

from __future__ import annotations

from ship_gym.envs.env import ShipEnv


class CourseChanging(ShipEnv):
    """Follow steps of the ordered heading in a seaway.

    ## Description
    As `HeadingKeeping`, but the ordered heading changes: four steps of 5 to 60 deg to either side,
    every 3 to 4 minutes. The autopilot turns the ship without much overshoot and then holds the
    new heading. The order is not announced.

    ## Action Space
    `Box(-1, 1, (1,), float32)` for `control="rudder"`, `(2,)` for `control="rudder+rpm"`.

    | Num | Action | Control | Meaning |
    | --- | --- | --- | --- |
    | 0 | rudder command | -1 to 1 | times delta_max (35 deg); positive turns to starboard |
    | 1 | propeller speed command | -1 to 1 | from 0 to n_max; without it: self-propulsion |

    Values outside are limited; NaN or a wrong shape is an error. `ship_gym.DiscreteRudder` makes
    the action a choice of rudder angles. The command passes a rate-limited steering gear and an
    engine with lag; the agent sees what they did.

    ## Observation Space
    `Box(float32)` of shape `(9,)`. The heading error psi_e is the heading minus the one ordered
    now, positive to starboard; it jumps when the order changes. U0 is the ship's nominal speed, L
    its length.

    | Num | Symbol | Unit | Min | Max | Meaning |
    | --- | --- | --- | --- | --- | --- |
    | 0 | sin(psi_e) | - | -1 | 1 | sine of the heading error |
    | 1 | cos(psi_e) | - | -1 | 1 | cosine of the heading error |
    | 2 | r L / U0 | - | -5 | 5 | yaw rate, positive to starboard |
    | 3 | u / U0 | - | -3 | 3 | surge velocity through the water |
    | 4 | v / U0 | - | -3 | 3 | sway velocity through the water, positive to starboard |
    | 5 | delta / delta_max | - | -1 | 1 | rudder angle achieved |
    | 6 | n / n_max | - | 0 | 1 | propeller speed achieved |
    | 7 | delta_c / delta_max | - | -1 | 1 | last rudder command |
    | 8 | n_c / n_max | - | 0 | 1 | last propeller speed command |

    Heading, yaw rate, and sway velocity are measured with the wave-frequency motion
    on top of the slow motion that rewards and episode ends look at, and with the sensors' noise:
    white, standard deviation 0.1 deg, 0.02 deg/s, 0.05 m/s (estimates). `info` is exact.

    ## Rewards
    Per control interval, each term times the interval in full-scale seconds; weights are keys of
    the scenario's `reward` section, values are returned in `info["reward_terms"]`. An interval is
    judged by the order that held during it:

    - `heading`: -1.0 psi_e^2 [rad^2]
    - `rudder`: -0.1 delta^2 [rad^2]
    - `rudder_rate`: -0.002 (rudder change / largest change in one interval)^2
    - `speed_loss`: -0.05 (1 - u / U0)^2 where u < U0
    - `termination`: -200 once, where a limit ends the episode

    ## Starting State
    Straight course at U0 and self-propulsion, rudder amidships, on the ordered heading.
    Drawn at reset: ordered heading (any); size, side and time of the steps;
    the sea (one of the sea states 3 to 6, with its height, peak period and wind; long-crested
    waves and gusting wind from one direction, any) and the current (0 to 1 m/s at full scale, any
    direction).

    ## Episode End
    - Termination: the heading error exceeds 150 deg: the ship has turned the wrong way.
    - Truncation: 900 s (full scale), inside the environment. `info["is_success"]` is then true.

    ## Arguments
    ```python
    gym.make(
        "ShipGym/CourseChanging-v0",
        ship="kcs",
        control="rudder",
        surrogate=None,
        privileged=False,
        overrides={"sea.states": ["ss5"], "duration": 1200.0},
    )
    ```

    - `ship`: one of `ship_gym.available_ships()`, the path of a ship file, or a `Ship`. Times, sea,
      noise and current of a model are Froude-scaled.
    - `control`: `"rudder"` or `"rudder+rpm"`.
    - `surrogate`: `"regression"`, `"gp"`, `"nn"` or another one of
      `ship_gym.available_surrogates(ship)`; the ship's default if None.
    - `privileged`: append 26 entries about sea and forces, `ship_gym.tasks.privileged`.
    - `scenario`: a name of `ship_gym.available_scenarios()`, a TOML file or a mapping.
    - `overrides`: keys of the scenario (`docs/environments/scenarios.md`), nested or dotted;
      unknown keys are refused. `{"sensors.noise": False}` for exact measurements,
      `{"randomisation.hull_std": 0.1}` for another ship in each episode, `{"failure.time": 100.0,
      "failure.rudder_rate": 0.5}` for a drill.
    - `render_mode`: `"rgb_array"` (plan view with instruments) or `"human"` (live in rerun).

    ## Version History
    - v0: first version.
    """

    scenario_name = "course_changing"
