"""Gymnasium environments: one engine (`episodes`), a scalar and a native vector class.

Import `ShipEnv` and `ShipVectorEnv` from ``ship_gym``; this package stays light because
``import ship_gym`` loads its registration.
"""
