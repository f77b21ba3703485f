"""Ships on a graphics card: the kernels of ``physics`` and ``tasks``, one thread for each ship.

Import `ShipTorchEnv` from ``ship_gym``; torch and numba.cuda load when it is made.
"""
