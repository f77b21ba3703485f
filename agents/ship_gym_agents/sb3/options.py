"""Options of each algorithm: what the section [algorithm] of a file of hyperparameters may hold."""

from __future__ import annotations

import dataclasses

from ship_gym.config import ConfigError, check_number


@dataclasses.dataclass(frozen=True)
class OnPolicyOptions:
    """Arguments of stable-baselines3's PPO, and how wide it explores.

    The logarithm of the standard deviation of the decisions goes linearly from `log_std_init` to
    `log_std_final` over the budget; it is not learned.
    """

    n_steps: int
    batch_size: int
    n_epochs: int
    gae_lambda: float
    clip_range: float
    ent_coef: float
    vf_coef: float
    max_grad_norm: float
    log_std_init: float
    log_std_final: float

    def __post_init__(self):
        for name in ("n_steps", "batch_size", "n_epochs"):
            check_number(f"algorithm.{name}", getattr(self, name), 1, 1e7)
        if self.batch_size < 2:
            raise ConfigError("algorithm.batch_size = 1: allowed is 2 and more")
        for name in ("gae_lambda", "clip_range"):
            check_number(f"algorithm.{name}", getattr(self, name), 0.0, 1.0)
        for name in ("ent_coef", "vf_coef", "max_grad_norm"):
            check_number(f"algorithm.{name}", getattr(self, name), 0.0, 1e3)
        for name in ("log_std_init", "log_std_final"):
            check_number(f"algorithm.{name}", getattr(self, name), -10.0, 2.0)


@dataclasses.dataclass(frozen=True)
class PPOOptions(OnPolicyOptions):
    """PPO, see `ship_gym_agents.sb3.overlapped`.

    Attributes
    ----------
    overlap : bool
        Sail the next rollout on a second core while learning from the last one. It is then sailed
        by the weights of one rollout earlier, also where there is one core only.
    """

    overlap: bool = True


@dataclasses.dataclass(frozen=True)
class RecurrentPPOOptions(OnPolicyOptions):
    """As PPO, with an LSTM before the hidden layers of actor and critic.

    Attributes
    ----------
    lstm : int
        Units of each LSTM.
    """

    lstm: int

    def __post_init__(self):
        super().__post_init__()
        check_number("algorithm.lstm", self.lstm, 1, 4096)


@dataclasses.dataclass(frozen=True)
class OffPolicyOptions:
    """Arguments that the algorithms with a replay buffer share."""

    buffer_size: int
    learning_starts: int
    batch_size: int
    tau: float
    train_freq: int
    gradient_steps: int

    def __post_init__(self):
        for name in ("buffer_size", "batch_size", "train_freq", "gradient_steps"):
            low = -1 if name == "gradient_steps" else 1  # -1: as many as samples
            check_number(f"algorithm.{name}", getattr(self, name), low, 1e8)
        check_number("algorithm.learning_starts", self.learning_starts, 0, self.buffer_size)
        check_number("algorithm.tau", self.tau, 0.0, 1.0)


@dataclasses.dataclass(frozen=True)
class SACOptions(OffPolicyOptions):
    """Arguments of stable-baselines3's SAC; the entropy coefficient is learned."""


@dataclasses.dataclass(frozen=True)
class TD3Options(OffPolicyOptions):
    """Arguments of stable-baselines3's TD3, and the standard deviation of its exploration."""

    policy_delay: int
    action_noise: float

    def __post_init__(self):
        super().__post_init__()
        check_number("algorithm.policy_delay", self.policy_delay, 1, 1000)
        check_number("algorithm.action_noise", self.action_noise, 0.0, 2.0)


@dataclasses.dataclass(frozen=True)
class TQCOptions(OffPolicyOptions):
    """Arguments of sb3-contrib's TQC: SAC with quantiles of the return, the highest cut off."""

    top_quantiles_to_drop_per_net: int
    n_quantiles: int
    n_critics: int

    def __post_init__(self):
        super().__post_init__()
        check_number("algorithm.n_quantiles", self.n_quantiles, 1, 1000)
        check_number("algorithm.n_critics", self.n_critics, 1, 100)
        low, high = 0, self.n_quantiles - 1
        name = "algorithm.top_quantiles_to_drop_per_net"
        check_number(name, self.top_quantiles_to_drop_per_net, low, high)


@dataclasses.dataclass(frozen=True)
class DQNOptions(OffPolicyOptions):
    """Arguments of stable-baselines3's DQN, which chooses one of several decisions.

    Attributes
    ----------
    levels : int
        Decisions, evenly from -1 to 1; odd, so that 0 is one of them.
    target_update_interval : int
        Samples.
    exploration_init, exploration_final : float
        Share of decisions by chance; falls linearly over `exploration_share` of the budget.
    exploration_share : float
    """

    levels: int
    target_update_interval: int
    exploration_init: float
    exploration_final: float
    exploration_share: float

    def __post_init__(self):
        super().__post_init__()
        check_number("algorithm.levels", self.levels, 3, 101)
        if self.levels % 2 == 0:
            raise ConfigError(f"algorithm.levels = {self.levels}: allowed is an odd number")
        check_number("algorithm.target_update_interval", self.target_update_interval, 1, 1e8)
        for name in ("exploration_init", "exploration_final"):
            check_number(f"algorithm.{name}", getattr(self, name), 0.0, 1.0)
        check_number("algorithm.exploration_share", self.exploration_share, 1e-6, 1.0)


@dataclasses.dataclass(frozen=True)
class GaussNewtonOptions:
    """Least squares over the weights of a small network, by finite differences in one batch.

    Attributes
    ----------
    episodes : int
        Seeds of an iteration, the same for all candidates (common random numbers).
    iterations : int
        At most.
    step : float
        Of the finite differences of a weight.
    ridge : float
        Penalty of the squared weights, that keeps the step of the unneeded ones small.
    price : float
        Of the rudder's movement: cost of a degree, in the unit of the task (deg2 or L2), see
        ``ship_gym_agents.training.residuals``.
    candidates : int
        Sets of weights sailed in one batch.
    horizon : float
        Length of an episode [full-scale s]; 0: that of training.
    relative : bool
        Whether an episode weighs the less, the more it costs at the beginning.
    relative_power : float
        How much less: exponent of the weight, which is 1 over that cost and the median one. 1: by
        its share of the cost. Nearer to 0, dear episodes have more to say.
    turn : float
        Headings: weight of the intervals of turns, beside 1 of the steady part.
    band : float
        Courses: the heading error counts up to about this [deg].
    overshoot : float
        Courses: weight of the squared heading beyond a new order.
    """

    episodes: int
    iterations: int
    step: float
    ridge: float
    price: float
    candidates: int
    horizon: float
    relative: bool
    relative_power: float
    turn: float
    band: float
    overshoot: float

    def __post_init__(self):
        for name in ("episodes", "iterations", "candidates"):
            check_number(f"algorithm.{name}", getattr(self, name), 1, 1e6)
        check_number("algorithm.step", self.step, 1e-8, 1.0)
        check_number("algorithm.band", self.band, 1e-2, 180.0, "deg")
        check_number("algorithm.relative_power", self.relative_power, 0.0, 2.0)
        for name in ("ridge", "price", "horizon", "turn", "overshoot"):
            check_number(f"algorithm.{name}", getattr(self, name), 0.0, 1e6)


OPTIONS: dict[str, type] = {
    "ppo": PPOOptions,
    "recurrent_ppo": RecurrentPPOOptions,
    "sac": SACOptions,
    "td3": TD3Options,
    "tqc": TQCOptions,
    "dqn": DQNOptions,
    "gauss_newton": GaussNewtonOptions,
}
