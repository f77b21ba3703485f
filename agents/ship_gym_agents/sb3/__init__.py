"""Learning with stable-baselines3 and torch, which are optional: ``pip install "ship-gym[rl]"``.

What was trained is run by ``ship_gym_agents.policies``, which needs neither.
"""
