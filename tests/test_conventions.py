import math

import numpy as np

from ship_gym import conventions as c


def test_wrap_angle():
    assert c.wrap_angle(math.pi) == -math.pi
    assert c.wrap_angle(-math.pi) == -math.pi
    np.testing.assert_allclose(
        c.wrap_angle(np.array([7.0, -7.0])), [7 - 2 * math.pi, 2 * math.pi - 7]
    )


def test_names_and_indices_agree():
    assert [c.STATE_NAMES[i] for i in (c.U, c.V, c.R, c.X, c.Y, c.PSI, c.DELTA, c.N)] == list(
        c.STATE_NAMES
    )
    assert len(c.STATE_NAMES) == len(c.STATE_UNITS) == c.N_STATES
    assert len(c.FORCE_COMPONENTS) == c.N_FORCES and len(c.FLOW_NAMES) == c.N_FLOW
    assert c.FLOW_NAMES[c.FLOW_F_N] == "rudder_normal_force"
    assert c.FLOW_NAMES[c.FLOW_EXTRAPOLATION] == "extrapolation"
    assert c.FLOW_OF_UNITS[: c.N_FLOW] == c.FLOW_NAMES
    assert c.FLOW_OF_UNITS[c.N_FLOW :: len(c.UNIT_NAMES)] == ("J_starboard", "J_port")
    assert c.FLOW_OF_UNITS[-1] == "rudder_normal_force_port" and len(c.FLOW_OF_UNITS) == 19
