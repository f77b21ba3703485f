"""Steering gear and engine, exact functions of time: every stage of a step has its true angle."""

from __future__ import annotations

import math

from ship_gym.physics._kernel import kernel
from ship_gym.physics.angles import exp_negative

REVERSAL = 0.1  # of n_max: below it an engine that reverses is stopping and starting (our choice)


@kernel
def rudder_after(delta, command, time, gear):
    """Rudder angle [rad] after `time` [s]: rate-limited towards the limited command."""
    target = min(max(command, -gear.delta_max), gear.delta_max)
    change = min(max(target - delta, -gear.rate * time), gear.rate * time)
    return delta + change


@kernel
def engine_after(n, command, torque, time, engine):
    """Propeller speed [rev/s] after `time` [s]: what governor, engine and shaft make of an order.

    Parameters
    ----------
    n, command : float
        Present and ordered propeller speed [rev/s], negative astern.
    torque : float
        Propeller torque [N m] at the start of the step, positive against turning ahead.
    """
    target = min(max(command, -engine.n_astern), engine.n_max)
    if target >= 0.0 and n >= 0.0:
        wanted = governed(n, target, time, engine)
    else:
        wanted = reversing(n, target, time, engine)
    if engine.torque_max < math.inf:
        return turned_by_torque(n, wanted, torque, time, engine)
    return wanted


@kernel
def governed(n, target, time, engine):
    """Propeller speed [rev/s] by the governor: first-order lag whose rate is limited.

    While the error exceeds rate * time_constant the speed changes at the limit, then the error
    decays exponentially. Exact in time.
    """
    error = target - n
    gap = abs(error)
    knee = engine.rate * engine.time_constant
    ramp = min(time, max(0.0, (gap - knee) / engine.rate))
    gap -= engine.rate * ramp
    if time > ramp and engine.time_constant > 0.0:
        gap *= exp_negative(-(time - ramp) / engine.time_constant)
    return n + error - math.copysign(gap, error)


@kernel
def reversing(n, target, time, engine):
    """As `governed`, but a reversal takes ``engine.reversal_time`` [s] in its last part.

    To reverse, the shaft must stop and start again: from `REVERSAL` n_max down to zero it slows
    evenly over the reversal time. Exact in time.
    """
    if n * target >= 0.0 or engine.reversal_time <= 0.0:
        return governed(n, target, time, engine)
    side, speed, low = math.copysign(1.0, n), abs(n), REVERSAL * engine.n_max
    if speed > low:  # the governor far from its target: at its rate
        ramp = min(time, (speed - low) / engine.rate)
        speed, time = speed - engine.rate * ramp, time - ramp
    ramp = min(time, speed * engine.reversal_time / low)
    speed, time = speed - low / engine.reversal_time * ramp, time - ramp
    if time <= 0.0:
        return side * speed
    return governed(0.0, target, time, engine)


@kernel
def turned_by_torque(n, wanted, torque, time, engine):
    """Propeller speed [rev/s], limited by what the engine's torque can do to the shaft in `time`.

    2 pi I n' = Q_engine - Q. The engine gives up to `torque_max` in its direction of turning and
    holds up to `torque_brake` against it; one that stands and is ordered to stand only holds. The
    propeller's torque is taken as linear in n about its present value, with the slope
    2 torque_max / n_max that it has at the limit, so that a shaft far lighter than the step is long
    finds its speed without ringing.
    """
    turning = n if n != 0.0 else wanted
    most = engine.torque_max if turning > 0.0 else engine.torque_brake
    least = -engine.torque_max if turning < 0.0 else -engine.torque_brake
    if wanted == n and least <= torque <= most:
        return n
    slope = 2.0 * engine.torque_max / engine.n_max
    reach = 1.0 / slope
    if engine.shaft_inertia > 0.0:
        reach *= 1.0 - exp_negative(-slope * time / (2.0 * math.pi * engine.shaft_inertia))
    low, high = (least - torque) * reach, (most - torque) * reach
    new = n + min(max(wanted - n, low), high)
    # a shaft that comes to rest stays for this step: beyond zero the engine works the other way
    return 0.0 if new * n < 0.0 else new
