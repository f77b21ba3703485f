"""Learned policies as controllers, run with NumPy alone, in files that run no code when loaded.

`networks` computes decisions from features, `policy` makes an action of them by a helm, see
``ship_gym_agents.forms``. `policy_file` reads and writes ``.safetensors`` files; `onnx_export`
writes a network for other programs.
"""
