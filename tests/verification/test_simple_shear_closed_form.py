# SPDX-License-Identifier: Apache-2.0
"""Elastic and elastic-plastic simple shear against the closed forms of three objective rates.

The update turns the stress by the rotation of each increment's own polar decomposition. In simple shear that rotation
tends to W dt, half the shear increment: so the answer tends to the Jaumann closed form, not to the Green-Naghdi one,
which needs the rotation of the whole deformation. One increment of any size from the unstressed state gives 2 mu ln V,
which is the closed form of the logarithmic rate. In metals the elastic strains are so small that the three agree:
quantified below.
Table: tests/data/simple_shear_rates.csv.
"""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.post.strain_measures import measure_strains
from tests.problems.plane_solids import (
    DATA,
    ELEMENTS,
    block_mesh,
    drive_boundary,
    elastic,
    fit_rate,
    fixed_increments,
    run,
)

TABLE = np.loadtxt(DATA / "simple_shear_rates.csv", delimiter=",", skiprows=2)
YOUNG, POISSON = 200e3, 0.3
MU = YOUNG / (2 * (1 + POISSON))


def shear_element(element, shear, increments):
    """Return xy and xx stress over the shear modulus after simple shear of a block of cells."""
    mesh = block_mesh(element, (2, 2), origin=(0.0, 0.0), size=(10.0, 10.0))
    model = drive_boundary(
        mesh,
        [np.array([[1.0, shear], [0.0, 1.0]])],
        elastic(YOUNG, POISSON),
        analysis="plane_strain",
        solver=fixed_increments(increments),
    )
    procedure, reports = run(model)
    assert len(reports) == increments
    stress = procedure.state.cells.stress[0].reshape(-1, 4) / MU
    np.testing.assert_allclose(stress, np.broadcast_to(stress[0], stress.shape), atol=1e-7)
    return stress[0, 3], stress[0, 0]


def jaumann(shear):
    return np.sin(shear), 1 - np.cos(shear)


def green_naghdi(shear):
    b = np.arctan(shear / 2)
    xy = 2 * np.cos(2 * b) * (2 * b - 2 * np.tan(2 * b) * np.log(np.cos(b)) - np.tan(b))
    return xy, 4 * (np.cos(2 * b) * np.log(np.cos(b)) + b * np.sin(2 * b) - np.sin(b) ** 2)


def test_closed_forms_are_those_of_the_table():
    for row in TABLE:
        np.testing.assert_allclose(row[1:3], jaumann(row[0]), atol=1e-9)
        np.testing.assert_allclose(row[3:5], green_naghdi(row[0]), rtol=1e-8)


@pytest.mark.parametrize("element", ELEMENTS)
def test_simple_shear_converges_to_the_jaumann_closed_form_with_second_order(element):
    counts = [10, 20, 40]
    errors = [np.hypot(*np.subtract(shear_element(element, 2.0, n), jaumann(2.0))) for n in counts]
    assert fit_rate([1 / n for n in counts], errors).rate == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 1e-3 < 1e-2 * np.hypot(*np.subtract(green_naghdi(2.0), jaumann(2.0)))


@pytest.mark.parametrize("shear", [0.1, 0.25, 0.5, 1.0])
def test_simple_shear_meets_the_jaumann_table(shear):
    row = TABLE[np.isclose(TABLE[:, 0], shear)][0]
    np.testing.assert_allclose(shear_element("quad4_fbar", shear, 200), row[1:3], atol=1e-5)


@pytest.mark.parametrize("shear", [0.1, 0.25, 0.5, 1.0])
def test_one_increment_of_simple_shear_gives_the_logarithmic_rate(shear):
    row = TABLE[np.isclose(TABLE[:, 0], shear)][0]
    np.testing.assert_allclose(shear_element("quad4_fbar", shear, 1), row[5:7], atol=1e-9)


def shear_point(law, shear, increments, rate):
    """Stress (2, 2) of one material point in simple shear: the program's update, or the same with the total rotation.

    rate "incremental": turn by the R of each increment. "green_naghdi": keep the stress in the frame of the total R,
    and bring each increment's ln U, taken at its middle, into it.
    """
    stress, eqps = np.zeros((1, 4)), np.zeros(1)
    step = shear / increments
    F_step = np.array([[1.0, step, 0.0, 1.0, 1.0]])
    strain, turn, _ = _core.measure_increments(F_step, _core.StrainMeasure.log)
    c, s = turn[0]
    R_step = np.array([[c, -s], [s, c]])
    e = np.array([[strain[0, 0], 0.5 * strain[0, 3]], [0.5 * strain[0, 3], strain[0, 1]]])
    half = measure_strains(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])).rotation[:2, :2]
    angle = 0.5 * np.arctan2(half[1, 0], half[0, 0])
    R_half = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def rotation(g):
        return measure_strains(np.array([[1.0, g, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])).rotation[:2, :2]

    def as_row(t, engineering):
        return np.array([[t[0, 0], t[1, 1], 0.0, (2 if engineering else 1) * t[0, 1]]])

    for k in range(increments):
        e_frame = e
        if rate == "green_naghdi":
            R_middle = rotation((k + 0.5) * step)
            e_frame = R_middle.T @ (R_half @ e @ R_half.T) @ R_middle
        stress, eqps, _ = law.update(as_row(e_frame, True), stress, eqps)
        if rate == "incremental":
            plane = np.array([[stress[0, 0], stress[0, 3]], [stress[0, 3], stress[0, 1]]])
            zz = stress[0, 2]
            stress = as_row(R_step @ plane @ R_step.T, False)
            stress[0, 2] = zz
    plane = np.array([[stress[0, 0], stress[0, 3]], [stress[0, 3], stress[0, 1]]])
    R = np.eye(2) if rate == "incremental" else rotation(shear)
    return R @ plane @ R.T


def make_law(yield_stress, modulus=0.0):
    return _core.VonMises(YOUNG, POISSON, _core.HardeningLaw.linear, [yield_stress, modulus])


def test_total_rotation_would_give_green_naghdi():
    """What separates the two rates is the rotation alone: the same law and strains in the total R's frame."""
    stress = shear_point(make_law(1e30), 2.0, 400, "green_naghdi") / MU
    np.testing.assert_allclose([stress[0, 1], stress[0, 0]], green_naghdi(2.0), atol=1e-4)
    stress = shear_point(make_law(1e30), 2.0, 400, "incremental") / MU
    np.testing.assert_allclose([stress[0, 1], stress[0, 0]], jaumann(2.0), atol=1e-4)


@pytest.mark.parametrize("shear", [0.5, 1.0, 2.0])
def test_rates_agree_for_metals(shear):
    """The thesis's steel, which yields at 0.35 %: with s the shear stress, s/mu bounds what the rates differ by."""
    law = make_law(700.0, 300.0)
    ours, total = (shear_point(law, shear, 1000, rate) for rate in ("incremental", "green_naghdi"))
    small = abs(total[0, 1]) / MU
    assert abs(ours[0, 1] / total[0, 1] - 1) < small
    assert abs(ours[0, 0] - total[0, 0]) < 2 * small * abs(total[0, 1])
