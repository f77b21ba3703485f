"""TrackFollowing: the environment id and its page."""

from __future__ import annotations

from ship_gym.envs.env import ShipEnv


class TrackFollowing(ShipEnv):
    """Sail a track of way-points in a seaway.

    ## Description
    As `HeadingKeeping`, but the ship sails along straight legs between way-points: five legs of 3
    to 15 L with course changes up to 90 deg, drawn for each episode so that a ship with a turning
    radius of 3 L can follow. The next leg begins within 2 L of a way-point, or abeam of it.
    Waves, wind and current set the ship aside, so it must point up to stay on the leg.

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
    `Box(float32)` of shape `(15,)`. The heading error psi_e is the heading minus the bearing of
    the active leg, positive to starboard. U0 is the ship's nominal speed, L its length. The line of
    sight goes to the point of the leg 3 L ahead of the ship.

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
    | 9 | e / L | - | -10 | 10 | cross-track error, positive to starboard of the leg |
    | 10 | e_dot / U0 | - | -3 | 3 | its rate: speed over ground across the leg |
    | 11 | s / L | - | -5 | 50 | distance to go along the leg |
    | 12 | d_chi / pi | - | -1 | 1 | course change at its end, positive to starboard; last leg: 0 |
    | 13 | sin(psi_l) | - | -1 | 1 | sine of the look-ahead error, heading - line of sight |
    | 14 | cos(psi_l) | - | -1 | 1 | cosine of the look-ahead error |

    Heading, yaw rate, sway velocity and position are measured with the wave-frequency motion
    on top of the slow motion that rewards and episode ends look at, and with the sensors' noise:
    white, standard deviation 0.1 deg, 0.02 deg/s, 0.05 m/s, 1 m (estimates). `info` is exact.

    ## Rewards
    Per control interval, each term times the interval in full-scale seconds; weights are keys of
    the scenario's `reward` section, values are returned in `info["reward_terms"]`. An interval is
    judged by the leg that was active during it:

    - `cross_track`: -1.0 (e / L)^2
    - `rudder`: -0.1 delta^2 [rad^2]
    - `rudder_rate`: -0.002 (rudder change / largest change in one interval)^2
    - `speed_loss`: -0.05 (1 - u / U0)^2 where u < U0
    - `termination`: -200 once, where a limit ends the episode

    ## Starting State
    Abeam of the first way-point within +-0.5 L, at U0 and self-propulsion, rudder amidships,
    heading along the first leg within +-10 deg.
    Drawn at reset: the track;
    the sea (one of the sea states 3 to 6, with its height, peak period and wind; long-crested
    waves and gusting wind from one direction, any) and the current (0 to 1 m/s at full scale, any
    direction).

    ## Episode End
    - Termination: the last way-point is reached (within 2 L, or abeam of it); `info["is_success"]`
      is then true. Or the cross-track error exceeds 5 L, with the `termination` term.
      `info["outcome"]` tells them apart.
    - Truncation: 3600 s (full scale), inside the environment.

    ## Arguments
    ```python
    gym.make(
        "ShipGym/TrackFollowing-v0",
        ship="kcs",
        control="rudder",
        surrogate=None,
        privileged=False,
        overrides={"sea.states": ["ss5"], "duration": 4800.0},
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

    scenario_name = "track_following"
