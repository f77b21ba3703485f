"""The environments of a training run: ships, helm, price, normaliser."""

from __future__ import annotations

import numpy as np
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from ship_gym.config import ConfigError
from ship_gym_agents.sb3.config import RunConfig
from ship_gym_agents.sb3.form_vec_env import FleetVecEnv, FormVecEnv
from ship_gym_agents.sb3.vec_adapter import ShipVecEnv

# Floor of the variance of a feature: one that hardly varies is not blown up to noise.
_EPSILON = 1e-4


class MirrorMeanStd(RunningMeanStd):
    """Running mean and variance; an odd feature has mean zero and its mean square.

    Otherwise a mirrored situation would not be scaled as the mirror of the scaled one.

    Parameters
    ----------
    signs : numpy.ndarray
        +1 or -1 of each feature.
    """

    def __init__(self, signs: np.ndarray):
        super().__init__(shape=signs.shape)
        self._odd = signs < 0.0

    def update_from_moments(
        self, batch_mean: np.ndarray, batch_var: np.ndarray, batch_count: float
    ) -> None:
        """Take in the moments of a batch."""
        square = batch_var + batch_mean**2
        super().update_from_moments(
            np.where(self._odd, 0.0, batch_mean),
            np.where(self._odd, square, batch_var),
            batch_count,
        )


def make_env(config: RunConfig) -> VecNormalize:
    """Environments of a run as its learner sees them.

    Parameters
    ----------
    config : RunConfig
        ``training`` says how many, ships and overrides; ``form`` and ``price`` the rest.

    Returns
    -------
    VecNormalize
        Over a `FormVecEnv`, or over a `FleetVecEnv` of one for each of ``training.ships``.

    Raises
    ------
    ConfigError
        A form that does not fit the scenario, or ships whose features differ.
    """
    training = config.hyperparameters.training
    ships = training.ships or (None,)
    counts = [len(range(k, training.envs, len(ships))) for k in range(len(ships))]
    parts = [_form_env(config, ship, n) for ship, n in zip(ships, counts, strict=True)]
    first = parts[0]
    for part, ship in zip(parts, ships, strict=True):
        if part.helm.names != first.helm.names:
            raise ConfigError(f"training.ships: {ship} has other features than {ships[0]}")
    env = VecNormalize(
        first if len(parts) == 1 else FleetVecEnv(parts), gamma=training.gamma, epsilon=_EPSILON
    )
    if config.hyperparameters.form.symmetric:
        width = env.observation_space.shape[0]
        signs = np.append(first.helm.signs, np.ones(width - first.n_features))
        env.obs_rms = MirrorMeanStd(signs)
    return env


def _form_env(config: RunConfig, ship: str | None, count: int) -> FormVecEnv:
    hyper = config.hyperparameters
    training = hyper.training
    duration = training.episode or config.scenario.duration
    venv = ShipVecEnv(
        count,
        stagger=True,
        ship=ship,
        scenario=config.scenario,
        privileged=training.critic == "privileged",
        overrides={"duration": duration, **training.overrides},
    )
    levels = getattr(hyper.algorithm, "levels", 0)
    return FormVecEnv(venv, hyper.form, hyper.price, levels)


def form_envs(env: VecEnv) -> list[FormVecEnv]:
    """The parts of an environment of `make_env`, one for each ship."""
    while not isinstance(env, FormVecEnv | FleetVecEnv):
        env = env.venv
    return [env] if isinstance(env, FormVecEnv) else env.parts
