import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.seakeeping.form_curves import Curve, CurveEnd, fitted_curve


def test_moments_of_a_curve_beside_quadrature():
    curve = Curve(CurveEnd(0.1, 1.4), CurveEnd(0.05, 0.6), 2.3, 1.7, 0.08)
    x = -0.5 + (np.arange(200000) + 0.5) / 200000
    area, first = curve.moments()
    assert area == pytest.approx(curve(x).mean(), rel=1e-8)
    assert first == pytest.approx((x * curve(x)).mean(), rel=1e-6)


def test_fitted_curve_has_its_area_and_centre():
    ends = CurveEnd(0.57, 1.0), CurveEnd(0.0, 1.5)
    curve = fitted_curve(0.82, -0.045, *ends, 0.08, ("C_wp", "x_F / L"))
    area, first = curve.moments()
    assert area == pytest.approx(0.82, abs=1e-10)
    assert first / area == pytest.approx(-0.045, abs=1e-10)


def test_a_centre_that_no_curve_has_says_the_range():
    with pytest.raises(ConfigError, match=r"x_B / L = 0\.2000: allowed is -0\.\d+ to 0\.1"):
        ends = CurveEnd(0.01, 1.4), CurveEnd(0.0, 1.4)
        fitted_curve(0.66, 0.2, *ends, 0.08, ("C_b / C_m", "x_B / L"))
