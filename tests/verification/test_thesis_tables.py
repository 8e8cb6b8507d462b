# SPDX-License-Identifier: Apache-2.0
"""Tables 1 and 2 of Cheng (1995), chapter 2, section 4, to the four significant digits that the thesis prints.

The numbers are those of the thesis as scanned; where the scan breaks the symmetry of a symmetric tensor by a misread
sign, the sign that the other term and the displacement field agree on is used (marked). R and 1 + spin are transposed:
the thesis's F is the transpose of F_iJ = dx_i/dX_J.
"""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from presswork import _core
from presswork.post.strain_measures import measure_strains

EXAMPLE = Path(__file__).parents[2] / "examples" / "strain_measures.py"
stretch_and_turn = runpy.run_path(str(EXAMPLE))["stretch_and_turn"]


def symmetric(xx, yy, zz, xy, yz, zx):
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


SMALL = {
    2: symmetric(0.009385, -0.006212, -0.005606, 0.000251, -0.000011, 0.000615),
    5: symmetric(0.006157, -0.012560, -0.008786, 0.000486, -0.000165, 0.003836),  # 32 lacks its sign in the scan
    10: symmetric(-0.005344, -0.035000, -0.020120, -0.000030, -0.001312, 0.015230),  # 21 lacks its sign in the scan
}
LEFT = {
    2: symmetric(0.009982, -0.004982, -0.005000, 0.000523, 0.000001, 0.000018),  # 22 reads 4987: breaks tr(V) = tr(U)
    5: symmetric(0.009886, -0.004887, -0.004999, 0.001297, 0.000010, 0.000114),
    10: symmetric(0.009548, -0.004561, -0.004986, 0.002526, 0.000077, 0.000445),
}
ROTATION = {
    2: [[0.999400, 0.034880, 0.001218], [-0.034900, 0.998800, 0.034880], [0.0, -0.034900, 0.999400]],
    5: [[0.996200, 0.086820, 0.007596], [-0.087160, 0.992400, 0.086820], [0.0, -0.087160, 0.996200]],
    10: [[0.984800, 0.171000, 0.030150], [-0.173600, 0.969800, 0.171000], [0.0, -0.173600, 0.984800]],
}
SPIN = {  # above the diagonal of 1 + spin: 12, 23, 13
    2: (0.034980, 0.034710, 0.000615),
    5: (0.087210, 0.086550, 0.003836),
    10: (0.172800, 0.171500, 0.015230),
}


def assert_four_digits(actual, printed):
    """Equal to half a unit of the fourth significant digit, or of the sixth decimal where fewer digits are printed."""
    printed = np.asarray(printed, dtype=float)
    size = np.where(printed == 0, 1e-12, np.abs(printed))
    unit = np.maximum(10.0 ** (np.floor(np.log10(size)) - 3), 1e-6)
    assert (np.abs(actual - printed) <= 0.5 * unit * (1 + 1e-6)).all(), f"\n{actual}\nis not\n{printed}"


@pytest.fixture(params=[2, 5, 10])
def case(request):
    angle = np.radians(request.param)
    return request.param, measure_strains(stretch_and_turn(0.01, 0.5, angle, angle))


def test_displacement_field_is_the_thesis_one():
    """Section 4 gives u(x) in full; its second row misses a minus that the rotation requires (sin for cos in u2)."""
    a, b, e, v = np.radians(7.0), np.radians(4.0), 0.01, 0.5
    F = stretch_and_turn(e, v, a, b)
    np.testing.assert_allclose(F[0], [(1 + e) * np.cos(a), -(1 - v * e) * np.sin(a), 0.0], atol=1e-15)
    np.testing.assert_allclose(F[2, 0], (1 + e) * np.sin(a) * np.sin(b), atol=1e-15)
    np.testing.assert_allclose(F[2, 1:], [(1 - v * e) * np.cos(a) * np.sin(b), (1 - v * e) * np.cos(b)], atol=1e-15)


def test_table_1_small_strain(case):
    degrees, measures = case
    assert_four_digits(measures.small, SMALL[degrees])


def test_table_1_green_lagrange_is_free_of_the_rotation(case):
    assert_four_digits(case[1].green_lagrange, np.diag([0.010050, -0.004987, -0.004987]))


def test_table_1_stretch_is_exact(case):
    assert_four_digits(case[1].stretch, np.diag([0.010000, -0.005000, -0.005000]))
    np.testing.assert_allclose(case[1].stretch, np.diag([0.01, -0.005, -0.005]), atol=1e-14)


def test_table_1_left_stretch(case):
    degrees, measures = case
    assert_four_digits(measures.left_stretch, LEFT[degrees])


def test_table_2_rotation(case):
    degrees, measures = case
    assert_four_digits(measures.rotation.T, ROTATION[degrees])


def test_table_2_spin(case):
    degrees, measures = case
    spin = measures.spin.T
    assert_four_digits([spin[0, 1], spin[1, 2], spin[0, 2]], SPIN[degrees])
    np.testing.assert_allclose(spin, -spin.T, atol=0)


@pytest.mark.parametrize(
    ("kernel", "field"),
    [("small", "small"), ("green_lagrange", "green_lagrange"), ("stretch", "stretch"), ("log", "log")],
)
def test_kernel_measures_equal_the_three_dimensional_ones(kernel, field):
    """Random plane deformation gradients with a hoop stretch, of moderate and of very small strain."""
    rng = np.random.default_rng(3)
    for size in (0.4, 1e-4):
        F = np.eye(3) + np.zeros((50, 3, 3))
        F[:, :2, :2] += rng.uniform(-size, size, (50, 2, 2))
        F[:, 2, 2] += rng.uniform(-size, size, 50)
        strain, turn, _ = _core.measure_increments(
            np.ascontiguousarray(F[:, [0, 0, 1, 1, 2], [0, 1, 0, 1, 2]]), _core.StrainMeasure[kernel]
        )
        measures = measure_strains(F)
        expected = getattr(measures, field)
        np.testing.assert_allclose(strain[:, :3], expected[:, [0, 1, 2], [0, 1, 2]], rtol=0, atol=1e-13)
        np.testing.assert_allclose(strain[:, 3], 2 * expected[:, 0, 1], rtol=0, atol=1e-13)
        np.testing.assert_allclose(turn, measures.rotation[:, [0, 1], [0, 0]], rtol=0, atol=1e-13)


def test_measures_reject_a_body_turned_inside_out():
    with pytest.raises(ValueError, match="positive determinant"):
        measure_strains(np.diag([1.0, -1.0, 1.0]))
