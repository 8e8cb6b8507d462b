# SPDX-License-Identifier: Apache-2.0
"""UMATs in explicit solids in space: the built-in law, closed forms, rotation, what they are told, devices."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import _core
from presswork.body.laws_of_solids import make_law
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.law.history import EQPS
from presswork.law.umat import open_umat
from presswork.model import Hardening, Material, SolverSettings, Umat
from tests.problems import space_solids

DENSITY = 7.85e-9
YOUNG, POISSON = 200e3, 0.3
SWIFT = (565.0, 0.007, 0.26)
ELEMENTS = ["hex8_1pt", "tet4_nodal", "hex8", "hex8_fbar"]
ONE_POINT = ELEMENTS[:2]
GRADIENT = np.array([[0.4, 0.5, -0.2], [-0.3, -0.3, 0.6], [0.1, -0.4, 0.2]])


def make_run(element: str, law: _core.Umat | None = None, **given) -> ExplicitSpaceSolids:
    """Return a distorted box of a UMAT, without one of the built-in law of Swift."""
    own = law or make_law(Material("steel", YOUNG, POISSON, Hardening("swift", np.array(SWIFT))), SolverSettings(), 6)
    mesh = space_solids.box(element, (3.0, 2.0, 2.0), (3, 2, 2), distort=0.2)
    return ExplicitSpaceSolids(mesh, [SpaceMaterial(own, DENSITY, (YOUNG, POISSON))], **given)


def user_law(library: Path, *props: float, n_state: int = 0, plastic_strain: int = 0) -> _core.Umat:
    return open_umat(Umat(str(library), props, n_state, plastic_strain=plastic_strain))


def kept_by(run: ExplicitSpaceSolids) -> np.ndarray:
    """Return what the routine keeps (n_cells, n), behind stress, rise of temperature and plastic strain."""
    return run.points[0][:, 0, run.kept[0][EQPS].stop :]


def move_to(run: ExplicitSpaceSolids, places: np.ndarray) -> None:
    """Take every node to a place in one cycle."""
    velocity = (places - run.position) / run.dt
    run.velocity = velocity
    for axis, letter in enumerate("uvw"):
        run.fix("all", letter, velocity[:, axis])
    run.advance(1)


def stretch(run: ExplicitSpaceSolids, gradient: np.ndarray, cycles: int) -> None:
    """Take the nodes along a gradient of displacement, in equal parts."""
    start = run.position.copy()
    for cycle in range(cycles):
        move_to(run, start + start @ gradient.T * (cycle + 1) / cycles)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_umat_of_von_mises_is_the_law_built_in(umat_laws: Path, element: str) -> None:
    """Stretched and turned to plastic strains of 4 %."""
    law = user_law(umat_laws, 1, YOUNG, POISSON, *SWIFT, n_state=1, plastic_strain=1)
    runs = [make_run(element), make_run(element, law)]
    for run in runs:
        stretch(run, 0.1 * GRADIENT, 60)
    own, user = runs
    assert own.equivalent_plastic_strain.min() > 0.04
    np.testing.assert_allclose(user.stress, own.stress, rtol=0, atol=1e-8 * np.abs(own.stress).max())
    np.testing.assert_allclose(user.equivalent_plastic_strain, own.equivalent_plastic_strain, rtol=1e-9)
    force = own.internal_force
    np.testing.assert_allclose(user.internal_force, force, rtol=0, atol=1e-8 * np.abs(force).max())
    assert user.energies().internal == pytest.approx(own.energies().internal, rel=1e-8)


@pytest.mark.parametrize("element", ONE_POINT)
def test_a_neo_hookean_umat_knows_the_whole_deformation(umat_laws: Path, element: str) -> None:
    """Stress in closed form at a gradient of 40 %, whatever the path."""
    mu, kappa = 8e4, 2e5
    run = make_run(element, user_law(umat_laws, 2, mu, kappa))
    stretch(run, GRADIENT, 200)
    F = np.eye(3) + GRADIENT
    J, B = np.linalg.det(F), F @ F.T
    exact = mu * J ** (-5 / 3) * (B - np.trace(B) / 3 * np.eye(3)) + kappa * (J - 1) * np.eye(3)
    exact = exact[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    np.testing.assert_allclose(run.stress, np.tile(exact, (len(run.stress), 1)), atol=1e-8 * kappa)


@pytest.mark.parametrize("element", ONE_POINT)
def test_stress_and_tensors_of_a_umat_turn_with_the_material(umat_laws: Path, element: str) -> None:
    """Prager's law stretched, then turned by a quarter about z: stress and back stress turn, and nothing else."""
    run = make_run(element, user_law(umat_laws, 3, YOUNG, POISSON, 200.0, 5e3, n_state=8, plastic_strain=7))
    stretch(run, 0.1 * GRADIENT, 60)
    stress, kept = run.stress, kept_by(run)[:, :8]
    place = run.position.copy()
    for angle in np.radians(np.arange(1, 91)):
        c, s = np.cos(angle), np.sin(angle)
        move_to(run, place @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T)
    assert np.abs(kept[:, :6]).min(axis=0).max() > 50.0
    xx, yy, zz, xy, yz, zx = stress.T
    turned = np.column_stack([yy, xx, zz, -xy, zx, -yz])
    np.testing.assert_allclose(run.stress, turned, rtol=0, atol=1e-7 * np.abs(stress).max())
    xx, yy, zz, xy, xz, yz = kept[:, :6].T  # in the order of Abaqus
    turned = np.column_stack([yy, xx, zz, -xy, -yz, xz])
    after = kept_by(run)[:, :8]
    np.testing.assert_allclose(after[:, :6], turned, rtol=0, atol=1e-7 * np.abs(kept).max())
    np.testing.assert_allclose(after[:, 6:], kept[:, 6:], rtol=1e-7)


@pytest.mark.parametrize("element", ELEMENTS)
def test_the_routine_is_told_where_and_when_it_is(umat_laws: Path, element: str) -> None:
    run = make_run(element, user_law(umat_laws, 5, YOUNG, POISSON, n_state=12))
    run.advance(3)
    told = kept_by(run)[:, :12]
    cells = run.mesh.blocks[0].connectivity
    np.testing.assert_allclose(told[:, 0], 2 * run.dt)
    np.testing.assert_allclose(told[:, 2], run.dt)
    assert told[:, 3].tolist() == list(range(1, len(cells) + 1))
    exact = run.position[cells].mean(axis=1)
    np.testing.assert_allclose(told[:, 7:9], exact[:, :2], atol=0.1 if "fbar" in element or element == "hex8" else 1e-9)
    assert (told[:, 11] == 6012).all()
    assert 12.0 * 0.9 < (told[:, 9] ** 3).sum() < 12.0 * 1.1


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_routine_that_stops_ends_the_run_with_its_reason(umat_laws: Path, element: str) -> None:
    run = make_run(element, user_law(umat_laws, 6, YOUNG, POISSON, -1.0, 1.0))
    with pytest.raises(ExplicitError, match=r"stops the analysis \(XIT\) in cell \d+ .*cycle 1"):
        run.advance(1)


def test_a_device_refuses_a_umat_by_name(umat_laws: Path) -> None:
    with pytest.raises(ExplicitError, match=r"'host' does not compute laws of shared libraries \(UMAT\)"):
        make_run("hex8_1pt", user_law(umat_laws, 5, YOUNG, POISSON, n_state=12), device="host")
