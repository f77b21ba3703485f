"""The environment ids, one line each."""

from __future__ import annotations

from gymnasium.envs.registration import register, registry

# id -> scenario
ENVIRONMENTS = {
    "ShipGym/HeadingKeeping-v0": "heading_keeping",
}


def register_all() -> None:
    """Register every id with Gymnasium; safe to call twice.

    No ``max_episode_steps``: truncation happens inside, since ``make_vec`` adds no TimeLimit.
    """
    for env_id, scenario in ENVIRONMENTS.items():
        if env_id not in registry:
            register(
                id=env_id,
                entry_point="ship_gym.envs.env:ShipEnv",
                vector_entry_point="ship_gym.envs.vector_env:ShipVectorEnv",
                kwargs={"scenario": scenario},
            )
