"""Constants of the wave computation that no theory gives, in one place, each with its calibration.

"Prototype": a scan of 48 combinations on seven head and bow cases against the SNNM regression of
added resistance (`snnm`). "Scan": ours, of 108 combinations of the far-field constants on KCS at Fn
0.10 and 0.26, DTC at 0.14 and S-175 at 0.25 in head and 150 deg seas, against the same regression.
"Second scan": 19 combinations on the same cases, after the drawn hulls got bulbs and hollow bows;
with the constants of the first the surge of KCS and DTC came out 20 to 40 % above the regression,
as that of the published DTC geometry had all along.
So SNNM is no independent check of those cases; ONRT, KVLCC2 and all seas at 120 deg and below were
used by none.
"""

from __future__ import annotations

from ship_gym.sea import wave_table

# Damping beyond potential flow, as a fraction of critical damping of the uncoupled mode. Heave and
# pitch: flat optimum, 0.1 in the prototype, 0.08 in the second scan, both with the action that this
# damping takes left out of the surge force, as it still is (it would add up to 0.9 to -CX of KCS at
# Fn 0.20 in waves of its length); sway has it. Roll: usual for a hull with
# bilge keels at small angles.
ROLL_DAMPING = 0.05
HEAVE_PITCH_DAMPING_BY_FROUDE = 0.08

# Short waves in the far field at speed: beyond the wave number SHORTEST_BY_DRAUGHT / T (or the
# incident one, if larger) depth decay and transverse number stay, and longitudinal numbers end at
# CUT_OFF / T. Second scan: the one of its 19 combinations with every case within the limits that
# are asked for; rms error by SNNM's peak 0.05 to 0.20. First scan, other hulls: 1.5 and 3.
# Without any limit the force diverges.
SHORTEST_BY_DRAUGHT = 1.0
CUT_OFF_BY_DRAUGHT = 2.5

# In head and bow seas a second solution, with diffraction at the encounter frequency, takes over
# between these wave lengths by L: it has the right tail in long waves (prototype). Its weight is 1
# in head seas and falls linearly to 0 in beam seas (scan: half to full weight at 150 deg do equally
# well in rms, the smaller ones put the peak of KCS at Fn 0.10 in too short waves).
LONG_WAVE_START = 0.6
LONG_WAVE_END = 1.0
HEAD_SECTOR_DEG = 90.0

# Half width in tau = omega_e U / g of the band about 1/4 over which drift is interpolated: the far
# field has an integrable spike there, which no measurement shows. Chosen by eye, not calibrated.
TAU_BAND = 0.03

# Band of tau in which surge and sway are interpolated between slower and faster speeds, see
# ``database.across_critical``. Not calibrated on SNNM: its ends are where far and near field of
# KVLCC2 in head seas of 1.13 L part and meet again (1.8 and 1.6 at tau 0.16, 7.9 and 3.3 at 0.29,
# 7.2 and 5.0 at 0.45, 6.4 and 6.5 at 0.69).
CRITICAL_START, CRITICAL_END = 0.22, 0.45

# Share of the near field in the yaw moment at speed: 1 from the first heading on, 0 at the second
# and below. In seas from behind it is not resolved by 700 panels: C_N of KCS in waves of its length
# at 60 deg, Fn 0.20 is 0.016 with 712 panels and -0.014 with 2128 (far field -0.004); at 120 deg
# -0.053 with both.
NEAR_FIELD_FROM_DEG = 90.0
FAR_FIELD_TO_DEG = 60.0

# Its share by wave length over L, beside the short-wave asymptote: a matter of panels per wave. At
# 0.6 L and 120 deg, Fn 0.20, 712 panels of KCS give -0.116 and 2128 give -0.095; at 0.2 L the
# change with speed of 712 panels is two to four times the asymptote's (ONRT: 1.2 to 1.6 times).
SHORT_WAVES_TO = 0.4
NEAR_FIELD_FROM = 0.6

# Below this |omega_e| sqrt(L/g) surge, sway and yaw have no stiffness and grow to many wave
# amplitudes; they are faded by (omega_e / FADE_FREQUENCY)^4. That band is the manoeuvring model's.
# From the prototype, which saw 7 to 14 amplitudes there.
FADE_FREQUENCY = 0.3


def values() -> dict[str, float]:
    """All constants by name, for the card of a table."""
    names = ("SNNM_FULL_FROUDE", "SNNM_SHORT", "SNNM_SHORT_END", "SNNM_FOLLOWING_DEG")
    blend = {name: getattr(wave_table, name) for name in names}
    return blend | {name: value for name, value in globals().items() if name.isupper()}
