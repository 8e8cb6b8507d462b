# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra that tests and validation share."""

import numpy as np
import scipy

from presswork.body.solids import Mechanics
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.make.box import add_middles, finish_mesh, mesh_box, node_volumes, split_hexahedra
from presswork.model import (
    CELLS,
    ELEMENTS,
    FacePressure,
    Hardening,
    Material,
    Model,
    PrescribedDisplacement,
    Stage,
    Support,
)
from presswork.timing import Timing
from tests.problems.space_solids import make_model

BORE, OUTSIDE, YIELD = 10.0, 20.0, 300.0


def hollow_ball(n: int, layers: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points and hexahedra of an eighth of a hollow ball: a cube less an inner cube, drawn onto spheres.

    n cells along the side of the cube, `layers` of them between the surfaces.
    """
    line = np.linspace(0.0, 1.0, n + 1)
    mesh = mesh_box(line, line, line, element="hex8")
    cells = mesh.blocks[0].connectivity
    cube = np.rint(mesh.points * n)
    outer = cells[cube[cells].max(axis=(1, 2)) > n - layers]
    used, cells = np.unique(outer, return_inverse=True)
    at = mesh.points[used]
    largest = at.max(axis=1)
    radius = BORE + (OUTSIDE - BORE) * (largest * n - (n - layers)) / layers
    direction = np.tan(0.25 * np.pi * at / largest[:, None])  # even angles along the sides of the cube
    return direction / np.linalg.norm(direction, axis=1)[:, None] * radius[:, None], cells.reshape(-1, 8)


def thick_ball(element: str, n: int, layers: int, front: float) -> Model:
    """Return a hollow ball under the pressure that has taken its plastic zone to `front` [mm] (Hill 1950, chapter 5).

    Ideally plastic, nearly incompressible, small displacements. With the front at the outside the pressure is the limit
    2 sigma_0 ln(b/a).
    """
    points, cells = hollow_ball(n, layers)
    if ELEMENTS[element].nodes == 10:  # its middles lie on the spheres
        points, cells, _ = add_middles(points, split_hexahedra(cells.astype(np.int32)), {})
        middles, of_ends = cells[:, 4:], np.linalg.norm(points[cells[:, CELLS["tet4"].edges]], axis=3).mean(axis=2)
        points[middles] *= (of_ends / np.linalg.norm(points[middles], axis=2))[:, :, None]
    radius = np.linalg.norm(points, axis=1)
    sides = {"bore": np.flatnonzero(radius < BORE + 1e-9), "outside": np.flatnonzero(radius > OUTSIDE - 1e-9)}
    sides |= {f"middle_{name}": np.flatnonzero(points[:, axis] < 1e-9) for axis, name in enumerate("xyz")}
    mesh = finish_mesh(points, cells, {name: nodes.astype(np.int32) for name, nodes in sides.items()}, element, 0)
    pressure = 2.0 * YIELD * np.log(front / BORE) + 2.0 / 3.0 * YIELD * (1.0 - (front / OUTSIDE) ** 3)
    supports = [Support(f"middle_{name}", tuple(name == own for own in "xyz")) for name in "xyz"]
    material = Material("ideal", 200e3, 0.4999, Hardening("linear", np.array([YIELD, 0.0])))
    load = Stage("press", face_pressures=(FacePressure("bore", pressure),))
    return make_model(
        mesh, supports, load, material=material, increments=20, displacements="small", force_tolerance=1e-6
    )


def prandtl_slice(element: str, n: int) -> Model:
    """Return a slice of an ideally plastic block under a smooth rigid punch of half width 1 mm, in plane strain.

    n cells under the punch. The limit load is (2 + pi) k on the width (Prandtl 1920).
    """
    line = np.concatenate([np.linspace(0.0, 1.0, n + 1), 1.0 + 3.0 * np.linspace(0.0, 1.0, n + 1)[1:] ** 1.5])
    mesh = mesh_box(line, line[::-1].max() - line[::-1], np.array([0.0, 1.0 / n]), element=element)
    top = mesh.node_sets["top"]
    sets = {**mesh.node_sets, "punch": top[mesh.points[top, 0] < 1.0 + 1e-9]}
    mesh = finish_mesh(mesh.points, mesh.blocks[0].connectivity, sets, element, 0)
    supports = [
        Support("left", (True, False, False)),
        Support("right", (True, False, False)),
        Support("bottom", (False, True, False)),
        Support("all", (False, False, True)),
    ]
    press = Stage("press", prescribed=(PrescribedDisplacement("punch", 1, -0.06),))
    material = Material("ideal", 200e3, 0.3, Hardening("linear", np.array([YIELD, 0.0])))
    return make_model(
        mesh, supports, press, material=material, increments=30, displacements="small", force_tolerance=1e-5
    )


def mean_pressure_of_punch(procedure: ImplicitProcedure, n: int) -> float:
    """Return the pressure over k of the punch, whose last nodes carry half a cell beside it, quadratic ones a sixth."""
    nodes = procedure.model.mesh.node_sets["punch"]
    force = -float(procedure.state.nodes.reaction[nodes, 1].sum())
    beside = 1.0 / 6.0 if ELEMENTS[procedure.model.mesh.blocks[0].element].nodes == 10 else 0.5
    return force * n / (1.0 + beside / n) / (YIELD / np.sqrt(3.0))


def inf_sup(element: str, n: int, *, with_bubble: bool = True) -> float:
    """Return the inf-sup value of n x n x n cells of a cube that is held all round (Chapelle & Bathe 1993).

    It is the root of the least eigenvalue but one (that of the even pressure) of B A^-1 B^T + C in the norm of the
    pressures, with the deviatoric stiffness A for 2 G = 1.
    """
    line = np.linspace(0.0, 1.0, n + 1)
    mesh = mesh_box(line, line, line, element=element)
    points = mesh.points.copy()
    inside = ((points > 1e-9) & (points < 1.0 - 1e-9)).all(axis=1)
    points[inside] += np.random.default_rng(2).uniform(-0.1, 0.1, (int(inside.sum()), 3)) / n
    mesh = finish_mesh(points, mesh.blocks[0].connectivity, {}, element, 0)
    young, poisson = 1.5, 0.5 - 1e-9
    material = Material("soft", young, poisson, Hardening("linear", np.array([1e9, 0.0])))
    model = make_model(mesh, [], Stage("none"), material=material, displacements="small", symmetric=False)
    mechanics = Mechanics(model, Timing("assembly"))
    state = mechanics.at_rest()
    nothing = np.zeros_like(state.nodes.displacement)
    mechanics.evaluate(state, state.duplicate(), nothing, with_stiffness=True)
    data = np.zeros(len(mechanics.assembler.indices))
    frames = np.zeros((len(points), 3, 3))
    mechanics.assemble_stiffness(np.zeros(len(points), dtype=np.uint8), frames, data)
    whole = scipy.sparse.csr_matrix((data, mechanics.assembler.indices, mechanics.assembler.indptr)).toarray()
    number = np.arange(4 * len(points)).reshape(-1, 4)
    moves, pressures = number[inside, :3].ravel(), number[:, 3]
    scale = mechanics.pressure_scale
    A, B = whole[np.ix_(moves, moves)], whole[np.ix_(pressures, moves)] / scale
    C = -whole[np.ix_(pressures, pressures)] / scale**2
    volumes = np.zeros(len(points))
    np.add.at(volumes, mesh.blocks[0].connectivity, node_volumes(points, mesh.blocks[0].connectivity))
    schur = B @ np.linalg.solve(A, B.T) + (C if with_bubble else 0.0)
    return float(np.sqrt(max(scipy.linalg.eigh(schur, np.diag(volumes), eigvals_only=True)[1], 0.0)))
