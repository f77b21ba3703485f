"""The environment ids, one line each."""

from __future__ import annotations

from gymnasium.envs.registration import register, registry

# id -> scenario, class
ENVIRONMENTS = {
    "ShipGym/HeadingKeeping-v0": "heading_keeping",
    "ShipGym/CourseChanging-v0": "course_changing",
    "ShipGym/TrackFollowing-v0": "track_following",
}


def register_all() -> None:
    """Register every id with Gymnasium; safe to call twice.

    No ``max_episode_steps``: truncation happens inside, since ``make_vec`` adds no TimeLimit. The
    class of an id is named as the id, in the module named as its scenario.
    """
    for env_id, scenario in ENVIRONMENTS.items():
        if env_id not in registry:
            name = env_id.removeprefix("ShipGym/").partition("-")[0]
            register(
                id=env_id,
                entry_point=f"ship_gym.envs.{scenario}:{name}",
                vector_entry_point="ship_gym.envs.vector_env:ShipVectorEnv",
                kwargs={"scenario": scenario},
            )
