"""Learned policies: training with stable-baselines3, and running what was trained.

`policy` runs a trained policy with NumPy alone. `train` and `vec_adapter` import
stable-baselines3 and torch, which are optional: ``pip install "ship-gym[rl]"``.
"""
