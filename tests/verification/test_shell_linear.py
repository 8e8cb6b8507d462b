# SPDX-License-Identifier: Apache-2.0
"""Linear shells: the obstacle course and MacNeal & Harder's set, thickness from 1/10 to 1/10,000, distorted meshes.

References: MacNeal & Harder, Finite Elem. Anal. Des. 1 (1985) 3-20; Belytschko et al., Comput. Methods Appl. Mech. Eng.
51 (1985) 221-258; plates: Timoshenko & Woinowsky-Krieger, Theory of Plates and Shells (1959).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from problems import elastic
from shell_problems import CLAMPED, RX, RY, RZ, X, Y, Z, fixing, patch, shell_model, solve_linear, symmetry

from presswork.model import ElementName


def lines(end: float, n: int, start: float = 0.0) -> np.ndarray:
    return np.linspace(start, end, n + 1)


def arch(radius: float, length: float, angle: float, thickness: float, element: ElementName, n: int, **mesh: Any):
    """A part of a cylinder along y; u = 0 one end, v = 0 its crown."""
    return patch(
        lambda u, v: np.column_stack([radius * np.sin(v), u, radius * np.cos(v)]),
        lines(length, n), lines(angle, n), element=element, thickness=thickness,
        normal=lambda u, v: np.column_stack([np.sin(v), 0 * u, np.cos(v)]), **mesh,
    )  # fmt: skip


def scordelis_lo(element: ElementName, n: int, **mesh: Any) -> float:
    """Deflection of the free edge's middle over 0.3024; the shear-flexible shell converges to 0.3020 / 0.3024."""
    sheet = arch(25.0, 25.0, np.radians(40), 0.25, element, n, **mesh)
    held = [("left", fixing(X, Z)), ("right", symmetry(Y)), ("bottom", symmetry(X))]
    found = solve_linear(shell_model(sheet, elastic(4.32e8, 0.0), held, body=(0, 0, -360.0)))
    return float(-found[sheet.node_sets["top_right"], Z].mean() / 0.3024)


def pinched_cylinder(element: ElementName, n: int, **mesh: Any) -> float:
    """Deflection under the load over 1.82488e-5; rigid diaphragms."""
    sheet = arch(300.0, 300.0, np.pi / 2, 3.0, element, n, **mesh)
    held = [("left", fixing(X, Z)), ("right", symmetry(Y)), ("bottom", symmetry(X)), ("top", symmetry(Z))]
    found = solve_linear(shell_model(sheet, elastic(3e6, 0.3), held, forces=[("bottom_right", (0, 0, -0.25))]))
    return float(-found[sheet.node_sets["bottom_right"], Z].mean() / 1.82488e-5)


def hemisphere(element: ElementName, n: int, **mesh: Any) -> float:
    """Displacement of a loaded point over 0.093; hole of 18 degrees."""

    def sphere(u, v):
        return np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)])

    sheet = patch(lambda u, v: 10 * sphere(u, v), lines(np.pi / 2, n), lines(np.radians(72), n), element=element,
                  thickness=0.04, normal=sphere, **mesh)  # fmt: skip
    held = [("left", symmetry(Y)), ("right", symmetry(X)), ("top_left", fixing(Z))]
    pull = [("bottom_left", (1.0, 0, 0)), ("bottom_right", (0, -1.0, 0))]
    found = solve_linear(shell_model(sheet, elastic(6.825e7, 0.3), held, forces=pull))
    return float(found[sheet.node_sets["bottom_left"], X].mean() / 0.093)


PROBLEMS: dict[str, Callable[..., float]] = {
    "roof": scordelis_lo, "cylinder": pinched_cylinder, "hemisphere": hemisphere,
}  # fmt: skip
CONVERGED = {"roof": 0.9975, "cylinder": 1.01, "hemisphere": 1.002}
"""Values over the classical references to which shear-flexible shells converge; under the cylinder's point load they
have no limit: the finer the mesh, the larger, by the logarithm of its size."""


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell4_mitc", 32, 0.03), ("shell9_mitc", 16, 0.005), ("shell9_reduced", 16, 0.015), ("shell3_mitc", 48, 0.03),
])  # fmt: skip
def test_obstacle_course(problem, element, n, tolerance) -> None:
    assert PROBLEMS[problem](element, n) == pytest.approx(CONVERGED[problem], abs=tolerance)


@pytest.mark.parametrize(("problem", "published"), [
    ("roof", (0.94, 0.973, 0.989)), ("cylinder", (0.37, 0.740, 0.930)), ("hemisphere", (1.04, 1.005, 1.0)),
])  # fmt: skip
def test_mitc4_converges_as_published(problem, published) -> None:
    """On 4, 8 and 16 cells a side: figures of MITC4 as its literature prints them (e.g. Simo, Fox & Rifai 1989)."""
    found = [PROBLEMS[problem]("shell4_mitc", n) for n in (4, 8, 16)]
    np.testing.assert_allclose(found, published, atol=0.012)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_distorted_mesh_costs_little(problem) -> None:
    regular, distorted = (PROBLEMS[problem]("shell4_mitc", 16, distortion=d) for d in (0.0, 0.2))
    assert distorted == pytest.approx(regular, rel=0.1 if problem == "cylinder" else 0.06)


@pytest.mark.parametrize("element", ["shell3", "shell4"])
def test_cells_without_mixed_interpolation_lock(element) -> None:
    assert hemisphere(element, 16) < 0.05


@pytest.mark.parametrize(("thickness", "force", "wanted"), [
    (0.32, 1.0, {Z: 5.424e-3, Y: 1.754e-3}), (0.0032, 1e-6, {Z: 5.256e-3, Y: 1.294e-3}),
])  # fmt: skip
@pytest.mark.parametrize(("element", "n", "tolerance"), [("shell4_mitc", 8, 0.01), ("shell9_mitc", 2, 0.006)])
def test_twisted_beam(element, n, tolerance, thickness, force, wanted) -> None:
    def twisted(u, v):
        angle = u / 12 * np.pi / 2
        return np.column_stack([u, v * np.cos(angle), v * np.sin(angle)])

    mesh = patch(twisted, lines(12, 6 * n), lines(0.55, n, -0.55), element=element, thickness=thickness)
    for along, value in wanted.items():
        pull = np.zeros(3)
        pull[along] = force / 1.1
        found = solve_linear(shell_model(mesh, elastic(29e6, 0.22), [("left", CLAMPED)], edges=[("right", pull)]))
        assert found[mesh.node_sets["right"], along].mean() == pytest.approx(value, rel=tolerance)


def plate(element: ElementName, n: int, slenderness: float, *, clamped: bool, point: bool, **mesh: Any) -> float:
    """Centre deflection of a square plate of side 1 over D / (q L^4) or D / (P L^2), times 1e3."""
    sheet = patch(lambda u, v: np.column_stack([u, v, 0 * u]), lines(0.5, n), lines(0.5, n), element=element,
                  thickness=slenderness, **mesh)  # fmt: skip
    young = 1e7
    rigidity = young * slenderness**3 / (12 * (1 - 0.3**2))
    edge = [("right", CLAMPED), ("top", CLAMPED)] if clamped else [("right", fixing(Z, RX)), ("top", fixing(Z, RY))]
    held = [("left", symmetry(X)), ("bottom", symmetry(Y)), *edge]
    load: dict[str, Any] = {"forces": [("bottom_left", (0, 0, 0.25))]} if point else {"body": (0, 0, 1 / slenderness)}
    if not clamped:
        held.append(("bottom_left", fixing(X, Y, RZ)))
    found = solve_linear(shell_model(sheet, elastic(young, 0.3), held, **load))
    return float(1e3 * rigidity * found[sheet.node_sets["bottom_left"], Z].mean())


@pytest.mark.parametrize("slenderness", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize(("clamped", "point", "wanted"), [
    (False, False, 4.062), (True, False, 1.265), (False, True, 11.60), (True, True, 5.61),
])  # fmt: skip
def test_square_plates_of_any_thinness(slenderness, clamped, point, wanted) -> None:
    """Kirchhoff's plate: 4.062e-3, 1.265e-3 q L^4/D, 11.60e-3, 5.612e-3 P L^2/D; thick plates give way more."""
    found = plate("shell4_mitc", 16, slenderness, clamped=clamped, point=point)
    assert found == pytest.approx(wanted, rel=0.012 if slenderness < 1e-2 else 0.02)


@pytest.mark.parametrize(
    ("element", "loss"), [("shell4_mitc", 0.002), ("shell9_reduced", 0.003), ("shell9_mitc", 0.03)]
)
def test_a_distorted_plate_does_not_lock_as_it_gets_thinner(element, loss) -> None:
    found = [plate(element, 8, s, clamped=True, point=False, distortion=0.2) for s in (1e-2, 1e-3, 1e-4)]
    np.testing.assert_allclose(found, 1.265, rtol=loss + 0.003)


def test_a_thick_plate_is_that_of_reissner_and_mindlin() -> None:
    """Clamped, thickness 1/10, uniform load: 1.505e-3 q L^4/D (Zienkiewicz & Taylor, The Finite Element Method)."""
    assert plate("shell9_mitc", 8, 0.1, clamped=True, point=False) == pytest.approx(1.505, rel=0.005)


@pytest.mark.parametrize(("element", "n", "tolerance"), [("shell4_mitc", 32, 0.01), ("shell9_mitc", 8, 0.005)])
def test_cooks_membrane(element, n, tolerance) -> None:
    mesh = patch(lambda u, v: np.column_stack([48 * u, 44 * u + v * (44 - 28 * u), 0 * u]), lines(1, n), lines(1, n),
                 element=element, thickness=1.0)  # fmt: skip
    held = [("left", CLAMPED), ("all", fixing(Z, RX, RY))]
    found = solve_linear(shell_model(mesh, elastic(1.0, 1 / 3), held, edges=[("right", (0, 1 / 16, 0))]))
    middle = np.argmin(np.linalg.norm(mesh.points - (48, 52, 0), axis=1))
    assert found[middle, Y] == pytest.approx(23.97, rel=tolerance)


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
    from dataclasses import replace

    sheet = arch(25.0, 25.0, np.radians(40), 0.25, "shell4_mitc", 8)
    cells = sheet.blocks[0].connectivity.copy()
    cells[::3] = cells[::3][:, [0, 3, 2, 1]]
    other = replace(sheet, blocks=(replace(sheet.blocks[0], connectivity=np.ascontiguousarray(cells)),))
    held = [("left", fixing(X, Z)), ("right", symmetry(Y)), ("bottom", symmetry(X))]
    one, two = (solve_linear(shell_model(m, elastic(4.32e8, 0.0), held, body=(0, 0, -360.0))) for m in (sheet, other))
    np.testing.assert_allclose(two, one, rtol=1e-8, atol=1e-9)
