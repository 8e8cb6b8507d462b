# SPDX-License-Identifier: Apache-2.0
"""Linear problems of shells: functions of the element and the mesh, and the values that others give for them.

MH: MacNeal & Harder, Finite Elem. Anal. Des. 1 (1985) 3-20. B: Belytschko et al., Comput. Methods Appl. Mech. Eng. 51
(1985) 221-258. T: Timoshenko & Woinowsky-Krieger, Theory of Plates and Shells (1959). K: Knight, AIAA J. 35 (1997)
305-313. BIC: Bathe, Iosilevich & Chapelle, Comput. Struct. 75 (2000) 1-30.

`mesh` are the options of `patch`: distortion, pattern, points.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from presswork.model import ElementName, FloatArray, Mesh
from tests.problems.plane_solids import elastic
from tests.problems.shells import (
    CLAMPED,
    RX,
    RY,
    RZ,
    X,
    Y,
    Z,
    fixing,
    join,
    patch,
    shell_model,
    solve_linear,
    straighten,
    symmetry,
)  # fmt: skip

ROOF = 0.3024
"""Free edge's middle (B); theory without transverse shear: 0.3086 (MH)."""
CYLINDER = 1.82488e-5
"""Under the load (B)."""
HEMISPHERE = 0.093
"""With a hole of 18 degrees; 0.094 in MH."""
CLOSED_HEMISPHERE = 0.0924
"""(B)"""
STRAIGHT_BEAM = {"extension": 3.0e-5, "in_plane": 0.1081, "out_of_plane": 0.4321, "twist": 0.03411}
"""(MH); twist by Saint-Venant's torsion of the rectangle, M L/(0.2287 G a b^3): MH print 0.03208."""
CURVED_BEAM = {"in_plane": 0.08734, "out_of_plane": 0.5022}
TWISTED_BEAM = {
    (0.32, "in_plane"): 5.424e-3, (0.32, "out_of_plane"): 1.754e-3,
    (0.0032, "in_plane"): 5.256e-3, (0.0032, "out_of_plane"): 1.294e-3,
}  # fmt: skip
"""(MH); under 1 at a thickness of 0.32, under 1e-6 at 0.0032."""
PLATES = {
    (1, "supported", "uniform"): 4.062, (1, "supported", "point"): 11.60,
    (1, "clamped", "uniform"): 1.26532, (1, "clamped", "point"): 5.612,
    (5, "supported", "uniform"): 12.97, (5, "supported", "point"): 16.96,
    (5, "clamped", "uniform"): 2.604, (5, "clamped", "point"): 7.23,
}  # fmt: skip
"""Centre deflection over q b^4/D or P b^2/D, times 1e3, by aspect ratio (T, MH). Clamped, 5,
uniform: a strip's 1/384, which T's table has from aspect 2.5 on; MH print 2.56."""
COOK = 23.96
"""(B); refined meshes of many elements."""
HOOK = 4.9352
"""Solid elements (K); shells with transverse shear go to about 5.02."""
HYPAR = {1e-2: 9.3355e-5, 1e-3: 6.3941e-3, 1e-4: 5.2988e-1}
"""Deflection of the free side's middle by thickness (BIC, table 2: MITC16 on one fine mesh)."""

Load = Literal["extension", "in_plane", "out_of_plane", "twist"]


def lines(end: float, n: int, start: float = 0.0) -> FloatArray:
    return np.linspace(start, end, n + 1)


def flat(u: FloatArray, v: FloatArray) -> FloatArray:
    return np.column_stack([u, v, 0 * u])


def arch(radius: float, length: float, angle: float, thickness: float, element: ElementName, n: int, **mesh: Any):
    """A part of a cylinder along y; u = 0 one end, v = 0 its crown."""
    return patch(
        lambda u, v: np.column_stack([radius * np.sin(v), u, radius * np.cos(v)]),
        lines(length, n), lines(angle, n), element=element, thickness=thickness,
        normal=lambda u, v: np.column_stack([np.sin(v), 0 * u, np.cos(v)]), **mesh,
    )  # fmt: skip


def scordelis_lo(element: ElementName, n: int, thickness: float = 0.25, **mesh: Any) -> float:
    """Deflection of the free edge's middle."""
    sheet = arch(25.0, 25.0, np.radians(40), thickness, element, n, **mesh)
    held = [("left", fixing(X, Z)), ("right", symmetry(Y)), ("bottom", symmetry(X))]
    found = solve_linear(shell_model(sheet, elastic(4.32e8, 0.0), held, body=(0, 0, -90.0 / thickness)))
    return float(-found[sheet.node_sets["top_right"], Z].mean())


def pinched_cylinder(element: ElementName, n: int, thickness: float = 3.0, **mesh: Any) -> float:
    """Deflection under the load; rigid diaphragms."""
    sheet = arch(300.0, 300.0, np.pi / 2, thickness, element, n, **mesh)
    held = [("left", fixing(X, Z)), ("right", symmetry(Y)), ("bottom", symmetry(X)), ("top", symmetry(Z))]
    found = solve_linear(shell_model(sheet, elastic(3e6, 0.3), held, forces=[("bottom_right", (0, 0, -0.25))]))
    return float(-found[sheet.node_sets["bottom_right"], Z].mean())


def sphere(u: FloatArray, v: FloatArray) -> FloatArray:
    return np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)])


def hemisphere(element: ElementName, n: int, thickness: float = 0.04, **mesh: Any) -> float:
    """Displacement of a loaded point; hole of 18 degrees."""
    sheet = patch(lambda u, v: 10 * sphere(u, v), lines(np.pi / 2, n), lines(np.radians(72), n), element=element,
                  thickness=thickness, normal=sphere, **mesh)  # fmt: skip
    held = [("left", symmetry(Y)), ("right", symmetry(X)), ("top_left", fixing(Z))]
    pull = [("bottom_left", (1.0, 0, 0)), ("bottom_right", (0, -1.0, 0))]
    found = solve_linear(shell_model(sheet, elastic(6.825e7, 0.3), held, forces=pull))
    return float(found[sheet.node_sets["bottom_left"], X].mean())


def octant(element: ElementName, n: int, thickness: float, **mesh: Any) -> Mesh:
    """An eighth of a sphere of radius 10 in three patches that meet in its middle."""
    corners, centre = np.eye(3), np.ones(3) / 3
    patches = []
    for i in range(3):
        a, b, c = np.roll(corners, -i, axis=0)
        quad = np.array([a, (a + b) / 2, centre, (a + c) / 2])

        def unit(u, v, quad=quad):
            weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
            flat = weights @ quad
            return flat / np.linalg.norm(flat, axis=1, keepdims=True)

        patches.append(patch(lambda u, v, unit=unit: 10 * unit(u, v), lines(1, n), lines(1, n), element=element,
                             thickness=thickness, normal=unit, **mesh))  # fmt: skip
    joined = join(patches)
    x, y, z = joined.points.T
    near = 1e-9
    sets = {"y=0": np.abs(y) < near, "x=0": np.abs(x) < near, "pole": z > 10 - near, "one": x > 10 - near,
            "two": y > 10 - near}  # fmt: skip
    node_sets = {name: np.flatnonzero(mask).astype(np.int32) for name, mask in sets.items()}
    return replace(joined, node_sets={**node_sets, "all": np.arange(len(x), dtype=np.int32)})


def closed_hemisphere(element: ElementName, n: int, thickness: float = 0.04, **mesh: Any) -> float:
    """Displacement of a loaded point."""
    sheet = octant(element, n, thickness, **mesh)
    held = [("y=0", symmetry(Y)), ("x=0", symmetry(X)), ("pole", fixing(Z))]
    pull = [("one", (1.0, 0, 0)), ("two", (0, -1.0, 0))]
    found = solve_linear(shell_model(sheet, elastic(6.825e7, 0.3), held, forces=pull))
    return float(found[sheet.node_sets["one"], X].mean())


def straight_beam(element: ElementName, shape: str, load: Load, cells: tuple[int, int] = (6, 1), **mesh: Any) -> float:
    """Tip displacement, or rotation under a twisting moment, of a beam of 6 x 0.2 x 0.1 over its own."""
    slant = {"rectangle": 0.0, "trapezoid": -1.0, "parallelogram": 1.0}[shape]
    sign = slant ** np.arange(cells[0] + 1)
    sign[[0, -1]] = 0.0

    def plan(u, v):
        return np.column_stack([u + (v - 0.1) * np.interp(u, lines(6, cells[0]), sign), v, 0 * u])

    sheet = straighten(patch(plan, lines(6, cells[0]), lines(0.2, cells[1]), element=element, thickness=0.1, **mesh))
    direction = {"extension": X, "in_plane": Y, "out_of_plane": Z, "twist": RX}[load]
    pull = np.zeros(6)
    pull[direction] = 1 / 0.2
    found = solve_linear(shell_model(sheet, elastic(1e7, 0.3), [("left", CLAMPED)], edges=[("right", pull)]))
    return float(found[sheet.node_sets["right"], direction].mean() / STRAIGHT_BEAM[load])


def curved_beam(element: ElementName, load: Load, cells: tuple[int, int] = (6, 1), **mesh: Any) -> float:
    """Tip displacement of a quarter of a ring, 4.12 to 4.32, over MH's."""
    sheet = patch(lambda u, v: np.column_stack([-v * np.sin(u), v * np.cos(u), 0 * u]), lines(np.pi / 2, cells[0]),
                  lines(4.32, cells[1], 4.12), element=element, thickness=0.1, **mesh)  # fmt: skip
    direction = X if load == "in_plane" else Z
    pull = np.zeros(3)
    pull[direction] = 1 / 0.2
    found = solve_linear(shell_model(sheet, elastic(1e7, 0.25), [("left", CLAMPED)], edges=[("right", pull)]))
    return float(found[sheet.node_sets["right"], direction].mean() / CURVED_BEAM[load])


def twisted_beam(element: ElementName, n: int, thickness: float, load: Load, **mesh: Any) -> float:
    """Tip displacement of a beam of 12 x 1.1 twisted by 90 degrees, on 6 n x n cells, over MH's."""

    def twisted(u, v):
        angle = u / 12 * np.pi / 2
        return np.column_stack([u, v * np.cos(angle), v * np.sin(angle)])

    sheet = patch(twisted, lines(12, 6 * n), lines(0.55, n, -0.55), element=element, thickness=thickness, **mesh)
    direction = Z if load == "in_plane" else Y
    pull = np.zeros(3)
    pull[direction] = (1.0 if thickness > 0.1 else 1e-6) / 1.1
    found = solve_linear(shell_model(sheet, elastic(29e6, 0.22), [("left", CLAMPED)], edges=[("right", pull)]))
    return float(found[sheet.node_sets["right"], direction].mean() / TWISTED_BEAM[thickness, load])


def plate(
    element: ElementName, n: int, slenderness: float, *, edge: str = "clamped", load: str = "uniform", aspect: int = 1,
    **mesh: Any,
) -> float:  # fmt: skip
    """Centre deflection of a plate of 1 x aspect over D / (q b^4) or D / (P b^2), times 1e3."""
    sheet = patch(flat, lines(aspect / 2, n), lines(0.5, n), element=element, thickness=slenderness, **mesh)
    young = 1e7
    rigidity = young * slenderness**3 / (12 * (1 - 0.3**2))
    rim = [CLAMPED, CLAMPED] if edge == "clamped" else [fixing(Z, RX), fixing(Z, RY)]
    held = [("left", symmetry(X)), ("bottom", symmetry(Y)), ("right", rim[0]), ("top", rim[1])]
    if edge != "clamped":
        held.append(("bottom_left", fixing(X, Y, RZ)))
    loads: dict[str, Any] = (
        {"forces": [("bottom_left", (0, 0, 0.25))]} if load == "point" else {"body": (0, 0, 1 / slenderness)}
    )
    found = solve_linear(shell_model(sheet, elastic(young, 0.3), held, **loads))
    return float(1e3 * rigidity * found[sheet.node_sets["bottom_left"], Z].mean())


def cook(element: ElementName, n: int, **mesh: Any) -> float:
    """Tip displacement of Cook's membrane over 23.96."""
    sheet = patch(lambda u, v: np.column_stack([48 * u, 44 * u + v * (44 - 28 * u), 0 * u]), lines(1, n), lines(1, n),
                  element=element, thickness=1.0, **mesh)  # fmt: skip
    held = [("left", CLAMPED), ("all", fixing(Z, RX, RY))]
    found = solve_linear(shell_model(sheet, elastic(1.0, 1 / 3), held, edges=[("right", (0, 1 / 16, 0))]))
    middle = np.argmin(np.linalg.norm(sheet.points - (48, 52, 0), axis=1))
    return float(found[middle, Y] / COOK)


def hook(element: ElementName, n: int, **mesh: Any) -> float:
    """Displacement across the tip of Raasch's hook, on 9 n x n cells."""

    def left(turn):
        return np.column_stack([-np.cos(turn), np.sin(turn), 0 * turn])

    joint, end = np.radians(60), np.radians(150)
    second = np.array([[14.0, 0, 0]]) + 60.0 * left(np.array([joint]))

    def shape(u, v):
        turn = np.where(u < 1, joint * u, joint - end * (u - 1) / 2)
        middle = np.where(u[:, None] < 1, [[14.0, 0, 0]] + 14.0 * left(turn), second - 46.0 * left(turn))
        return middle + v[:, None] * [0, 0, 1.0]

    def normal(u, v):
        return left(np.where(u < 1, joint * u, joint - end * (u - 1) / 2))

    sheet = patch(shape, lines(3, 9 * n), lines(20, n), element=element, thickness=2.0, normal=normal, **mesh)
    found = solve_linear(
        shell_model(sheet, elastic(3300.0, 0.35), [("left", CLAMPED)], edges=[("right", (0, 0, 0.05))])
    )
    return float(found[sheet.node_sets["right"], Z].mean())


def hypar(element: ElementName, n: int, thickness: float, **mesh: Any) -> float:
    """Deflection of the free side's middle of z = x^2 - y^2 under its weight, half of it on 2 n x n cells."""

    def normal(u, v):
        return np.column_stack([-2 * u, 2 * v, 1 + 0 * u]) / np.sqrt(1 + 4 * u**2 + 4 * v**2)[:, None]

    sheet = patch(lambda u, v: np.column_stack([u, v, u**2 - v**2]), lines(0.5, 2 * n, -0.5), lines(0.5, n),
                  element=element, thickness=thickness, normal=normal, **mesh)  # fmt: skip
    held = [("left", CLAMPED), ("bottom", symmetry(Y))]
    found = solve_linear(shell_model(sheet, elastic(2e11, 0.3), held, body=(0, 0, -8000.0)))
    return float(-found[sheet.node_sets["bottom_right"], Z].mean())
