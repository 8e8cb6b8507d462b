# SPDX-License-Identifier: Apache-2.0
"""Forward extrusion between the slab method and Avitzur's upper bound; the parts of the pressure accounted for."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from presswork import Case, run
from presswork.examples import copy_example
from validation.extrusion import CASES, CURVED, PACKAGED, cone, extrude, run_case, theory, write_billet
from validation.extrusion_theory import avitzur, homogeneous_work_factor, slab_coulomb, slab_shear

pytestmark = pytest.mark.validation

IDEAL = 2 * np.log(10 / 8)


@pytest.mark.parametrize(("angle", "factor"), [(10, 1.000641), (45, 1.015904), (90, 1.166600)])
def test_homogeneous_work_factor_has_its_published_values(angle, factor):
    assert homogeneous_work_factor(np.radians(angle)) == pytest.approx(factor, abs=1e-6)


def test_theories_agree_where_they_must():
    """Frictionless slab: ln(A0/Af), by either law; in a cone slab and upper bound have the same friction."""
    angle = np.radians(12.0)
    length = 2 / np.tan(angle)

    def radius(y: float) -> float:
        return 10 + y * np.tan(angle)

    assert slab_shear(radius, 0.0, -length, 0.0) == pytest.approx(IDEAL)
    assert slab_coulomb(10, 8, angle, 1e-9) == pytest.approx(IDEAL)
    rough = slab_shear(radius, 0.0, -length, 0.2) - IDEAL
    assert avitzur(10, 8, angle, 0.2) - avitzur(10, 8, angle, 0.0) == pytest.approx(rough)


@pytest.mark.parametrize(("angle", "m"), CASES)
def test_pressure_lies_between_slab_method_and_upper_bound(angle, m):
    slab, upper = theory(angle, m)
    assert slab < run_case(angle, m).mean < upper


@pytest.mark.parametrize(("angle", "m"), CURVED)
def test_pressure_of_the_curved_die_lies_above_the_slab_method(angle, m):
    assert run_case(angle, m).mean > theory(angle, m)[0]


@pytest.mark.parametrize("angle", [10.0, 15.0, 20.0, 30.0, 0.0])
def test_frictionless_pressure_is_the_work_spent_on_the_product(angle):
    """First law: p/sigma0 is the mean plastic strain of the metal that leaves, sampled over 1.5 mm of it."""
    run = run_case(angle, 0.0)
    assert run.mean == pytest.approx(run.strain, rel=0.05)


@pytest.mark.parametrize("angle", [10.0, 15.0, 20.0, 30.0, 0.0])
def test_friction_adds_what_the_slab_method_says(angle):
    """The part of m = 0.2 in the pressure, within 15 %: friction is known, redundant work is not."""
    found = run_case(angle, 0.2).mean - run_case(angle, 0.0).mean
    assert found == pytest.approx(theory(angle, 0.2)[0] - theory(angle, 0.0)[0], rel=0.15)


def test_redundant_work_grows_with_the_angle():
    means = [run_case(angle, 0.0).mean for angle in (10.0, 15.0, 20.0, 30.0)]
    assert np.all(np.diff(means) > 0.03)


def test_elements_and_meshes_agree():
    """15 degrees, m = 0.1: one-point quadrilaterals and a finer mesh within 2 %."""
    base = run_case(15.0, 0.1).mean
    assert extrude(cone(15.0), 0.1, element="quad4_1pt").mean == pytest.approx(base, rel=0.02)
    assert extrude(cone(15.0), 0.1, across=24).mean == pytest.approx(base, rel=0.02)


@pytest.mark.parametrize(("angle", "m"), CASES)
def test_volume_and_energy_are_kept(angle, m):
    run = run_case(angle, m)
    assert abs(run.volume_error) < 0.01
    assert abs(run.energy_error) < 1.0


@pytest.mark.parametrize(("poisson", "m"), [(0.3, 0.1), (0.05, 0.0)])
def test_container_pressure_is_that_of_confined_metal(poisson, m, tmp_path: Path):
    """Metal that yields nowhere pushes with nu / (1 - nu) of the axial pressure, other metal with that less its flow
    stress. The axial pressure is the ram's less the container's friction above; half a diameter from the die.
    """
    settings = [f"materials.steel.poisson={poisson}", f"tools.container.m={m}", "tools.die.m=0.2"]
    case = Case.from_toml(copy_example("extrusion_cone", tmp_path), [*settings, "stages.0.tools.ram.stroke=3"])
    result = run(case, tmp_path / "out", threads=1).result
    points, first = result.points(-1), 700 * 0.015**0.2
    wall = (np.abs(points[:, 0] - 10) < 1e-2) & (points[:, 1] > 10) & (points[:, 1] < 18)
    above = points[:, 1].max() - points[wall, 1].mean()
    axial = result.history["ram.force"][-1] / (np.pi * 100) - 2 * m * first / np.sqrt(3) * above / 10
    is_elastic = axial < first * (1 - poisson) / (1 - 2 * poisson)
    assert is_elastic == (poisson == 0.3)
    found, pushes = result.field("contact_pressure", -1)[wall].mean(), poisson / (1 - poisson) * axial
    print(f"axial {axial:.1f}, on the container {found:.1f} MPa")
    assert found == pytest.approx(pushes if is_elastic else axial - first, abs=0.03 * axial)


@pytest.mark.parametrize("name", PACKAGED)
def test_packaged_billet_is_the_one_written_here(name, tmp_path: Path):
    write_billet(tmp_path / "billet.inp", PACKAGED[name], 12, 25.0)
    packaged = (files("presswork.examples") / f"{name}.inp").read_text("utf-8")
    assert packaged == (tmp_path / "billet.inp").read_text("utf-8")
