"""The environments of a training run: ships, helm, price, normaliser."""

from __future__ import annotations

import numpy as np
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from ship_gym_agents.sb3.config import RunConfig
from ship_gym_agents.sb3.form_vec_env import FormVecEnv
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
        ``training`` says how many, which ships and overrides; ``form`` and ``price`` the rest.

    Returns
    -------
    VecNormalize
        Over a `FormVecEnv`.

    Raises
    ------
    ConfigError
        A form that does not fit the scenario.
    """
    hyper = config.hyperparameters
    training = hyper.training
    venv = ShipVecEnv(
        training.envs,
        stagger=True,
        ship=list(training.ships) or None,
        scenario=config.scenario,
        privileged=training.critic == "privileged",
        overrides={"duration": training.episode or config.scenario.duration, **training.overrides},
    )
    levels = getattr(hyper.algorithm, "levels", 0)
    seen = FormVecEnv(venv, hyper.form, hyper.price, levels)
    env = VecNormalize(seen, gamma=training.gamma, epsilon=_EPSILON)
    if hyper.form.symmetric:
        n_privileged = env.observation_space.shape[0] - seen.n_features
        env.obs_rms = MirrorMeanStd(np.append(seen.helm.signs, np.ones(n_privileged)))
    return env


def form_env(env: VecEnv) -> FormVecEnv:
    """The helm's environment in one of `make_env`."""
    while not isinstance(env, FormVecEnv):
        env = env.venv
    return env
