# SPDX-License-Identifier: Apache-2.0
"""Linear shells against published values and closed forms; the problems and their sources are in shell_linear.py.

Convergence over meshes, thickness and distortion is printed and drawn by validation/shell_convergence.py.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.problems.plane_solids import elastic
from tests.problems.shell_linear import (
    CLOSED_HEMISPHERE,
    CYLINDER,
    HEMISPHERE,
    HOOK,
    HYPAR,
    PLATES,
    ROOF,
    TWISTED_BEAM,
    arch,
    closed_hemisphere,
    cook,
    curved_beam,
    hemisphere,
    hook,
    hypar,
    lines,
    pinched_cylinder,
    plate,
    scordelis_lo,
    straight_beam,
    twisted_beam,
)
from tests.problems.shells import CLAMPED, X, Y, Z, fixing, patch, shell_model, solve_linear, symmetry

PROBLEMS = {
    "roof": (scordelis_lo, ROOF), "cylinder": (pinched_cylinder, CYLINDER), "hemisphere": (hemisphere, HEMISPHERE),
}  # fmt: skip
CONVERGED = {"roof": 0.9975, "cylinder": 1.01, "hemisphere": 1.002}
"""Values over the classical references to which shear-flexible shells converge; under the cylinder's point load they
have no limit: the finer the mesh, the larger, by the logarithm of its size."""


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell4_mitc_plus", 32, 0.025), ("shell9_mitc", 16, 0.005), ("shell9_reduced", 16, 0.015),
    ("shell4_1pt", 32, 0.02),
    ("shell3_mitc_plus", 32, 0.035), ("shell6_mitc", 16, 0.02),
])  # fmt: skip
def test_obstacle_course(problem, element, n, tolerance) -> None:
    compute, reference = PROBLEMS[problem]
    pattern = "right" if element[5] in "36" else None
    assert compute(element, n, pattern=pattern) / reference == pytest.approx(CONVERGED[problem], abs=tolerance)


@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell4_mitc_plus", 8, 0.006), ("shell9_mitc", 4, 0.006), ("shell3_mitc_plus", 8, 0.006), ("shell6_mitc", 4, 0.03),
])  # fmt: skip
def test_closed_hemisphere_of_three_patches(element, n, tolerance) -> None:
    pattern = "right" if element[5] in "36" else None
    assert closed_hemisphere(element, n, pattern=pattern) / CLOSED_HEMISPHERE == pytest.approx(1.0, abs=tolerance)


@pytest.mark.parametrize(("problem", "published"), [
    ("roof", (0.94, 0.973, 0.989)), ("cylinder", (0.37, 0.740, 0.930)), ("hemisphere", (1.04, 1.005, 1.0)),
])  # fmt: skip
def test_mitc4_converges_as_published(problem, published) -> None:
    """On 4, 8 and 16 cells a side: figures of MITC4 as its literature prints them (e.g. Simo, Fox & Rifai 1989)."""
    compute, reference = PROBLEMS[problem]
    found = [compute("shell4_mitc", n) / reference for n in (4, 8, 16)]
    np.testing.assert_allclose(found, published, atol=0.012)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_graded_mesh_costs_little(problem) -> None:
    compute, _ = PROBLEMS[problem]
    regular, graded = (compute("shell4_mitc_plus", 16, distortion=d) for d in (0.0, "graded"))
    assert graded == pytest.approx(regular, rel=0.12 if problem == "cylinder" else 0.05)


@pytest.mark.parametrize("element", ["shell3", "shell4"])
def test_cells_without_mixed_interpolation_lock(element) -> None:
    assert hemisphere(element, 16) / HEMISPHERE < 0.05


@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell9_mitc", 8, 0.017), ("shell4_mitc_plus", 16, 0.03), ("shell3_mitc_plus", 16, 0.07),
    ("shell4_1pt", 16, 0.015),
])  # fmt: skip
def test_hyperbolic_paraboloid(element, n, tolerance) -> None:
    pattern = "right" if element[5] == "3" else None
    for thickness, wanted in HYPAR.items():
        assert hypar(element, n, thickness, pattern=pattern) == pytest.approx(wanted, rel=tolerance)


def test_in_plane_strains_tied_on_the_sides_are_what_keeps_distorted_thin_shells_from_locking() -> None:
    """Hyperbolic paraboloid of thickness 1/1000 on a graded mesh of 16 intervals a side, over the reference."""
    found = {e: hypar(e, 8, 1e-3, distortion="graded") / HYPAR[1e-3] for e in ("shell4_mitc", "shell4_mitc_plus")}
    assert found["shell4_mitc"] < 0.3
    assert found["shell4_mitc_plus"] > 0.7
    assert hypar("shell9_mitc", 8, 1e-3, distortion="graded") / HYPAR[1e-3] > 0.97


@pytest.mark.parametrize(("element", "n"), [("shell4_mitc_plus", 10), ("shell9_mitc", 5), ("shell3_mitc_plus", 10)])
def test_raaschs_hook(element, n) -> None:
    """Between the solid's 4.9352 less 0.5 % and the 5.02 of shells with transverse shear."""
    found = hook(element, n, pattern="right" if element[5] == "3" else None)
    assert 0.994 * HOOK < found < 5.03


@pytest.mark.parametrize("shape", ["rectangle", "trapezoid", "parallelogram"])
def test_straight_beam_of_six_nine_node_shells(shape) -> None:
    for load, loss in (("extension", 0.003), ("out_of_plane", 0.01), ("in_plane", 0.04)):
        assert straight_beam("shell9_mitc", shape, load) == pytest.approx(1.0, abs=loss)
    assert straight_beam("shell9_mitc", shape, "twist", (24, 4)) == pytest.approx(1.0, abs=0.003)


@pytest.mark.parametrize("shape", ["rectangle", "trapezoid", "parallelogram"])
@pytest.mark.parametrize(("element", "loss"), [
    ("shell4_mitc_plus", 0.04), ("shell3_mitc_plus", 0.045), ("shell6_mitc", 0.025),
])  # fmt: skip
def test_straight_beam_of_six_cells_bends_out_of_its_plane(element, loss, shape) -> None:
    found = straight_beam(element, shape, "out_of_plane", pattern="right" if element[5] in "36" else None)
    assert found == pytest.approx(1.0, abs=loss)


def test_assumed_hourglass_stresses_bend_in_their_plane_without_parasitic_shear() -> None:
    """Six cells along: rectangles and the curved beam; no four-node cell is free of it on trapezoids (MacNeal 1987)."""
    assert straight_beam("shell4_1pt", "rectangle", "in_plane") == pytest.approx(1.0, abs=0.01)
    assert curved_beam("shell4_1pt", "in_plane", (24, 4)) == pytest.approx(1.0, abs=0.015)
    assert straight_beam("shell4_mitc_plus", "rectangle", "in_plane") < 0.1


def test_curved_beam() -> None:
    for load in ("in_plane", "out_of_plane"):
        assert curved_beam("shell9_mitc", load, (24, 4)) == pytest.approx(1.0, abs=0.015)
        assert curved_beam("shell6_mitc", load, (24, 4), pattern="right") == pytest.approx(1.0, abs=0.015)
    assert curved_beam("shell4_mitc_plus", "in_plane", (96, 16)) == pytest.approx(1.0, abs=0.035)


@pytest.mark.parametrize(("thickness", "load"), TWISTED_BEAM)
@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell4_mitc_plus", 8, 0.01), ("shell9_mitc", 2, 0.006), ("shell4_1pt", 8, 0.003),
])  # fmt: skip
def test_twisted_beam(element, n, tolerance, thickness, load) -> None:
    assert twisted_beam(element, n, thickness, load) == pytest.approx(1.0, abs=tolerance)


@pytest.mark.parametrize("slenderness", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize(("aspect", "edge", "load"), PLATES)
@pytest.mark.parametrize(("element", "n"), [("shell4_mitc_plus", 16), ("shell9_mitc", 8)])
def test_plates_of_any_thinness(element, n, slenderness, aspect, edge, load) -> None:
    """Kirchhoff's plate; thick plates give way more."""
    found = plate(element, n, slenderness, edge=edge, load=load, aspect=aspect)
    assert found == pytest.approx(PLATES[aspect, edge, load], rel=0.012 if (aspect, load) != (5, "point") else 0.02)


@pytest.mark.parametrize("distortion", [0.2, "graded"])
@pytest.mark.parametrize(("element", "n", "loss"), [
    ("shell4_mitc_plus", 8, 0.008), ("shell9_reduced", 8, 0.005), ("shell9_mitc", 8, 0.003),
    ("shell3_mitc_plus", 16, 0.004), ("shell6_mitc", 16, 0.006), ("shell4_1pt", 8, 0.006),
])  # fmt: skip
def test_a_distorted_plate_does_not_lock_as_it_gets_thinner(element, n, loss, distortion) -> None:
    pattern = "right" if element[5] in "36" else None
    found = [plate(element, n, s, distortion=distortion, pattern=pattern) for s in (1e-2, 1e-3, 1e-4)]
    np.testing.assert_allclose(found, PLATES[1, "clamped", "uniform"], rtol=loss)


def test_a_thick_plate_is_that_of_reissner_and_mindlin() -> None:
    """Clamped, thickness 1/10, uniform load: 1.505e-3 q L^4/D (Zienkiewicz & Taylor, The Finite Element Method)."""
    assert plate("shell9_mitc", 8, 0.1) == pytest.approx(1.505, rel=0.005)


@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell4_mitc_plus", 32, 0.01), ("shell9_mitc", 8, 0.005), ("shell6_mitc", 8, 0.01), ("shell4_1pt", 8, 0.012),
])  # fmt: skip
def test_cooks_membrane(element, n, tolerance) -> None:
    assert cook(element, n) == pytest.approx(1.0, rel=tolerance)


def test_a_folded_strip_carries_bending_over_its_edge() -> None:
    """An L of two strips, clamped, loaded along its first strip: closed form of two beams, with free drilling there."""
    length, thickness, young = 10.0, 0.2, 1e5

    def bracket(u, v):
        return np.column_stack([np.minimum(u, length), v, np.maximum(u - length, 0.0)])

    mesh = patch(bracket, lines(2 * length, 20), lines(1.0, 2), thickness=thickness)
    model = shell_model(mesh, elastic(young, 0.0), [("left", CLAMPED)], edges=[("right", (1e-3, 0, 0))])
    tip = solve_linear(model)[mesh.node_sets["right"]]
    # the tip force bends the upright by P L^3/3EI and turns the fold by P L L/EI, on which the upright's height rides
    stiffness = young * thickness**3 / 12
    force = 1e-3
    wanted = force * length**3 / (3 * stiffness) + (force * length) * length / stiffness * length
    np.testing.assert_allclose(tip[:, X], wanted, rtol=3e-3)


def test_cells_wound_either_way_give_the_same_answer() -> None:
    sheet = arch(25.0, 25.0, np.radians(40), 0.25, "shell4_mitc_plus", 8, distortion="graded")
    cells = sheet.blocks[0].connectivity.copy()
    cells[::3] = cells[::3][:, [0, 3, 2, 1]]
    other = replace(sheet, blocks=(replace(sheet.blocks[0], connectivity=np.ascontiguousarray(cells)),))
    held = [("left", fixing(X, Z)), ("right", symmetry(Y)), ("bottom", symmetry(X))]
    one, two = (solve_linear(shell_model(m, elastic(4.32e8, 0.0), held, body=(0, 0, -360.0))) for m in (sheet, other))
    np.testing.assert_allclose(two, one, rtol=1e-8, atol=1e-9)
