# SPDX-License-Identifier: Apache-2.0
"""Yld2004-18p with published coefficients of two aluminium sheets; AA2090-T3 against measured stresses and r-values.

Coefficients and measurements: Barlat, Aretz, Yoon, Karabin, Brem & Dick (2005), Int. J. Plasticity 21, 1009-1039,
exponent 8. The function is fitted to the measurements, so it meets them as closely as the paper's fit does. The paper
itself was not at hand: the coefficients of AA2090-T3 are as quoted in the documentation of TFEL (tfel-doc, material);
the measurements and the coefficients of AA6111-T4, which serve for the formula alone, are quoted without such a check.
"""

import numpy as np
import pytest

from presswork import _core
from presswork.case.material.yield_function import Yld2004
from presswork.case.material.yld2000_fit import r_value, tension

AA2090 = {
    "prime": (-0.069888, 0.936408, 0.079143, 1.003060, 0.524741, 1.363180, 1.023770, 1.069060, 0.954322),
    "double_prime": (0.981171, 0.476741, 0.575316, 0.866827, 1.145010, -0.079294, 1.051660, 1.147100, 1.404620),
}
AA6111 = {
    "prime": (1.241024, 1.078271, 1.216463, 1.223867, 1.093105, 0.889161, 0.501909, 0.557173, 1.349094),
    "double_prime": (0.775366, 0.922743, 0.765487, 0.793356, 0.918689, 1.027625, 1.115833, 1.112273, 0.589787),
}
ANGLES = np.radians(np.arange(0.0, 91.0, 15.0))
STRESS_2090 = [1.0, 0.9605, 0.9102, 0.8114, 0.8096, 0.8815, 0.9102]
R_2090 = [0.2115, 0.3269, 0.6923, 1.5769, 1.0385, 0.5384, 0.6923]
BIAXIAL_2090 = (1.035, 0.67)


def build(coefficients) -> _core.YieldFunction:
    return Yld2004(**coefficients, exponent=8).build()


def sum_of_differences(stress, coefficients, m=8):
    """Equivalent stress by the definition: principal values of C's and C''s, sought one by one; stress (6,)."""
    xx, yy, zz, xy, yz, zx = stress
    mean = (xx + yy + zz) / 3
    d = np.array([xx - mean, yy - mean, zz - mean])
    values = []
    for c in (coefficients["prime"], coefficients["double_prime"]):
        c12, c13, c21, c23, c31, c32, c44, c55, c66 = c
        normal = [-c12 * d[1] - c13 * d[2], -c21 * d[0] - c23 * d[2], -c31 * d[0] - c32 * d[1]]
        t = np.diag(normal)
        t[0, 1] = t[1, 0] = c66 * xy
        t[1, 2] = t[2, 1] = c44 * yz
        t[0, 2] = t[2, 0] = c55 * zx
        values.append(np.linalg.eigvalsh(t))
    return (np.sum((values[0][:, None] - values[1]) ** m) / 4) ** (1 / m)


@pytest.mark.parametrize("coefficients", [AA2090, AA6111], ids=["AA2090-T3", "AA6111-T4"])
@pytest.mark.parametrize("exponent", [6, 8])
def test_power_sums_of_invariants_are_the_sum_over_principal_values(coefficients, exponent):
    function = Yld2004(**coefficients, exponent=exponent).build()
    stress = 300 * np.random.default_rng(1).standard_normal((200, 6))
    expected = [sum_of_differences(s, coefficients, exponent) for s in stress]
    np.testing.assert_allclose(function.evaluate(stress)[0], expected, rtol=1e-12)
    plane = stress * [1, 1, 1, 1, 0, 0]
    expected = [sum_of_differences(s, coefficients, exponent) for s in plane]
    np.testing.assert_allclose(function.evaluate(np.ascontiguousarray(plane[:, :4]))[0], expected, rtol=1e-12)
    sheet = stress * [1, 1, 0, 1, 0, 0]
    expected = [sum_of_differences(s, coefficients, exponent) for s in sheet]
    np.testing.assert_allclose(function.evaluate(np.ascontiguousarray(sheet[:, [0, 1, 3]]))[0], expected, rtol=1e-12)


def test_aa2090_t3_has_the_measured_stresses_and_r_values():
    function = build(AA2090)
    stress = 1 / function.evaluate(tension(ANGLES))[0]
    np.testing.assert_allclose(stress, STRESS_2090, atol=0.0121)
    np.testing.assert_allclose(r_value(function, ANGLES), R_2090, atol=0.0571)
    value, gradient, _ = function.evaluate(np.array([[1.0, 1.0, 0.0]]))
    assert 1 / value[0] == pytest.approx(BIAXIAL_2090[0], abs=0.008)
    assert gradient[0, 1] / gradient[0, 0] == pytest.approx(BIAXIAL_2090[1], abs=0.005)


def test_aa6111_t4_is_scaled_by_its_balanced_biaxial_stress():
    """Its coefficients were fitted to stresses over the balanced biaxial one."""
    assert build(AA6111).evaluate(np.array([[1.0, 1.0, 0.0]]))[0][0] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("components", [3, 4, 6])
@pytest.mark.parametrize("coefficients", [AA2090, AA6111], ids=["AA2090-T3", "AA6111-T4"])
def test_gradient_and_hessian_are_derivatives(coefficients, components):
    function, step = build(coefficients), 1e-5
    stress = np.random.default_rng(2).standard_normal((50, components))
    stress[0] = np.eye(components)[0]  # principal values that coincide
    _, gradient, hessian = function.evaluate(stress)
    for j in range(components):
        move = step * np.eye(components)[j]
        ahead, behind = function.evaluate(stress + move), function.evaluate(stress - move)
        np.testing.assert_allclose(gradient[:, j], (ahead[0] - behind[0]) / (2 * step), atol=1e-8)
        np.testing.assert_allclose(hessian[:, :, j], (ahead[1] - behind[1]) / (2 * step), atol=1e-7)


def test_equal_coefficients_of_one_are_the_isotropic_function_of_the_exponent():
    """All c = 1: the function of Hershey (1954) and Hosford (1972); in shear t its sum is 2 (2t)^m + 4 t^m."""
    ones = {"prime": (1.0,) * 9, "double_prime": (1.0,) * 9}
    function = build(ones)
    np.testing.assert_allclose(function.evaluate(tension(ANGLES))[0], 1.0, rtol=1e-12)
    shear = function.evaluate(np.array([[0.0, 0.0, 1.0]]))[0][0]
    assert shear == pytest.approx(((2 * 2.0**8 + 4.0) / 4) ** (1 / 8), rel=1e-12)
