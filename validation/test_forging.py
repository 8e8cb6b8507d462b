# SPDX-License-Identifier: Apache-2.0
"""The packaged forging fills its die and does not depend on the mesh; friction in heading does what it must."""

from __future__ import annotations

import numpy as np
import pytest

from validation.forging import FLOW, closing_pressure, fill_history, force_at, outline, run_example

pytestmark = pytest.mark.validation

FRACTIONS = (0.5, 0.75, 0.9, 0.95, 0.98, 1.0)


def test_cavity_fills_and_stays_filled():
    rows = fill_history(run_example("forging_flash"))
    filled = np.array([part for time, part, _ in rows if time > 0.75])
    assert filled[0] < 0.9
    assert np.all(np.diff(filled) >= 0)
    assert filled[-1] == 1.0


def test_force_rises_steeply_once_the_cavity_is_full():
    forces = force_at(run_example("forging_flash"), "die", FRACTIONS)
    assert forces[-1] / forces[2] > 2.5
    assert forces[2] / forces[0] < 2.5


def test_force_does_not_depend_on_the_mesh():
    """Packaged against 2.25 times the cells, within 3 %; 4CST of four times the cells within 8 %: it ends too stiff."""
    packaged = force_at(run_example("forging_flash"), "die", FRACTIONS)
    finer = force_at(run_example("forging_flash", "workpiece.mesh.cells=[30,21]"), "die", FRACTIONS)
    np.testing.assert_allclose(packaged, finer, rtol=0.03)
    crossed = run_example("forging_flash", "workpiece.mesh.cells=[40,28]", "workpiece.element=tri3")
    np.testing.assert_allclose(packaged, force_at(crossed, "die", FRACTIONS), rtol=0.08)


def test_last_pressure_is_of_the_size_of_the_closing_estimate():
    result = run_example("forging_flash")
    area = np.pi * result.points(-1)[:, 0].max() ** 2
    assert 1e3 * force_at(result, "die", 1.0) / area / FLOW == pytest.approx(closing_pressure(), rel=0.25)


@pytest.mark.parametrize("name", ["forging_flash", "heading_friction"])
def test_volume_and_energy_are_kept(name):
    summary = run_example(name).summary
    assert abs(summary["volume"]["change_percent"] - summary["volume"]["elastic_part_percent"]) < 0.02
    assert abs(summary["energy"]["error_percent"]) < 1.0


def test_a_head_that_slides_needs_less_force_and_spreads_along_the_punch():
    sticking, sliding = run_example("heading"), run_example("heading_friction")
    assert force_at(sliding, "punch", 1.0) < 0.85 * force_at(sticking, "punch", 1.0)
    assert force_at(sliding, "punch", 0.25) == pytest.approx(force_at(sticking, "punch", 0.25), rel=0.02)
    assert outline(sliding)["at the punch"] > outline(sticking)["at the punch"] + 1.0
    assert outline(sliding)["bulge"] == pytest.approx(outline(sticking)["bulge"], rel=0.01)


def test_friction_stays_within_its_law():
    """mu = 0.1 of the pressure, and m = 0.3 of a shear flow stress that is nowhere above that of the largest strain."""
    result = run_example("heading_friction")
    above = result.points(-1)[:, 1] > -14.5  # the ejector sticks
    pressure, shear = (result.field(f"contact_{kind}", -1)[above] for kind in ("pressure", "shear"))
    touching = pressure > 50
    assert np.all(np.abs(shear[touching]) <= 0.1 * pressure[touching] * 1.01 + 1.0)
    strongest = 700 + 300 * result.summary["extremes"]["equivalent_plastic_strain"][1]
    assert np.abs(shear).max() < 0.3 * strongest / np.sqrt(3)
