"""Steering gear and engine as exact functions of time within a step, so RK4 sees no kink late."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel


@kernel
def rudder_after(delta, command, time, gear):
    """Rudder angle [rad] after `time` [s]: rate-limited towards the limited command."""
    target = min(max(command, -gear.delta_max), gear.delta_max)
    change = min(max(target - delta, -gear.rate * time), gear.rate * time)
    return delta + change


@kernel
def engine_after(n, command, time, engine):
    """Propeller speed [rev/s] after `time` [s]: first-order lag whose rate is limited.

    While the error exceeds rate * time_constant the speed changes at the limit, then the error
    decays exponentially. Constant-rpm governor: the load does not slow the propeller.
    """
    error = min(max(command, 0.0), engine.n_max) - n
    gap = abs(error)
    knee = engine.rate * engine.time_constant
    ramp = min(time, max(0.0, (gap - knee) / engine.rate))
    gap -= engine.rate * ramp
    if time > ramp and engine.time_constant > 0.0:
        gap *= math.exp(-(time - ramp) / engine.time_constant)
    return n + error - math.copysign(gap, error)


@kernel
def governed_command(n, command, torque, engine):
    """Propeller speed command [rev/s], lowered where the present torque [N m] is over the limit.

    Torque goes about with n^2, so the speed that meets the limit is n sqrt(Q_max / Q).
    """
    if torque > engine.torque_max:
        return min(command, n * math.sqrt(engine.torque_max / torque))
    return command
