# SPDX-License-Identifier: Apache-2.0
"""Set-up shared by the verification of shells: mapped patches, models in memory, runs without an output folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh import mesh_rectangle
from presswork.mesh.topology import find_boundary_edges
from presswork.model import (
    BodyForce,
    EdgeForce,
    ElementName,
    FloatArray,
    IntArray,
    Material,
    Mesh,
    Model,
    OutputSettings,
    PointForce,
    PrescribedDisplacement,
    Section,
    ShellPressure,
    SolverSettings,
    Stage,
    Support,
    find_cell,
)

X, Y, Z, RX, RY, RZ = range(6)
FLAT = {"3": "tri3", "6": "tri6_6pt", "4": "quad4", "8": "quad8", "9": "quad9"}


def fixing(*freedoms: int) -> tuple[bool, ...]:
    """Return which of the six freedoms a support fixes."""
    return tuple(i in freedoms for i in range(6))


def symmetry(normal: int) -> tuple[bool, ...]:
    """Return what a symmetry plane normal to x, y or z fixes: the displacement out of it, the rotations in it."""
    return fixing(normal, *(3 + i for i in range(3) if i != normal))


CLAMPED = fixing(X, Y, Z, RX, RY, RZ)


def patch(
    shape: Callable[[FloatArray, FloatArray], FloatArray],
    u_lines: FloatArray,
    v_lines: FloatArray,
    *,
    element: ElementName = "shell4_mitc_plus",
    thickness: float = 1.0,
    points: int = 2,
    normal: Callable[[FloatArray, FloatArray], FloatArray] | None = None,
    distortion: float | Literal["graded"] = 0.0,
    pattern: str | None = None,
    **section: Any,
) -> Mesh:
    """Mesh the image of a rectangle in (u, v); sets are named as in it: left, right, bottom, top and the corners.

    distortion: moves inner corners by that part of the cell size, at random but always the same; "graded": straight
    lines between sides cut in the ratio 1 : 2 : ... : n, running round the rectangle (the pattern of Bathe & Lee).
    """
    flat = FLAT[element[5]]
    plane = mesh_rectangle(u_lines, v_lines, element=flat, pattern=pattern)  # type: ignore[arg-type]
    u, v = plane.points.T
    if distortion:
        if distortion == "graded":
            moved = _grade(plane.points, len(u_lines) - 1, len(v_lines) - 1)
        else:
            moved = _shake(plane, distortion, np.array([np.diff(u_lines).min(), np.diff(v_lines).min()]))
        _straighten(moved, plane.blocks[0].connectivity, 3 if flat.startswith("tri") else 4)
        u, v = moved.T
    block = replace(plane.blocks[0], element=element, section=Section(thickness, points, **section))
    normals = normal(u, v) if normal else None
    return replace(plane, points=np.ascontiguousarray(shape(u, v)), blocks=(block,), normals=normals)


def _shake(plane: Mesh, distortion: float, cell: FloatArray) -> FloatArray:
    """Move the inner points at random."""
    rng = np.random.default_rng(7)
    inner = np.ones(len(plane.points), dtype=bool)
    for side in ("left", "right", "bottom", "top"):
        inner[plane.node_sets[side]] = False
    moved: FloatArray = plane.points + rng.uniform(-distortion, distortion, (len(inner), 2)) * cell * inner[:, None]
    return moved


def _grade(points: FloatArray, n: int, m: int) -> FloatArray:
    """Move the points of a rectangle of n x m equal cells onto the graded pattern."""
    low, high = points.min(axis=0), points.max(axis=0)
    r, s = ((points - low) / (high - low)).T

    def growing(x: FloatArray, n: int) -> FloatArray:
        result: FloatArray = x * (n * x + 1) / (n + 1)
        return result

    below, above = growing(r, n), 1 - growing(1 - r, n)
    left, right = 1 - growing(1 - s, m), growing(s, m)
    u = (below + (above - below) * left) / (1 - (above - below) * (right - left))
    v = left + (right - left) * u
    result: FloatArray = low + np.column_stack([u, v]) * (high - low)
    return result


def join(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh of several of the same element, without sets, points at the same place taken for one."""
    points = np.concatenate([m.points for m in meshes])
    _, first, number = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    starts = np.cumsum([0, *(len(m.points) for m in meshes[:-1])])
    cells = np.concatenate([m.blocks[0].connectivity + start for m, start in zip(meshes, starts, strict=True)])
    cells = np.ascontiguousarray(number.reshape(-1)[cells], dtype=np.int32)
    normals = [m.normals for m in meshes if m.normals is not None]
    boundary = find_boundary_edges([cells])
    return Mesh(
        np.ascontiguousarray(points[first]), (replace(meshes[0].blocks[0], connectivity=cells),), {},
        {"boundary": boundary}, boundary, np.concatenate(normals)[first] if normals else None,
    )  # fmt: skip


def straighten(mesh: Mesh) -> Mesh:
    """Return the mesh with mid-sides and centres in the middle of their corners."""
    points = mesh.points.copy()
    connectivity = mesh.blocks[0].connectivity
    _straighten(points, connectivity, find_cell(2, connectivity).corners)
    return replace(mesh, points=points)


def _straighten(points: FloatArray, cells: IntArray, corners: int) -> None:
    """Put mid-sides and centres in the middle of their corners, in place."""
    if cells.shape[1] > corners:
        ends = points[cells[:, :corners]]
        points[cells[:, corners : 2 * corners]] = 0.5 * (ends + np.roll(ends, -1, axis=1))
    if cells.shape[1] == 9:
        points[cells[:, 8]] = points[cells[:, :4]].mean(axis=1)


def shell_model(
    mesh: Mesh,
    material: Material,
    supports: Sequence[tuple[str, tuple[bool, ...]]],
    *,
    forces: Sequence[tuple[str, Sequence[float]]] = (),
    prescribed: Sequence[tuple[str, int, float]] = (),
    pressures: Sequence[tuple[str, float]] = (),
    edges: Sequence[tuple[str, Sequence[float]]] = (),
    body: Sequence[float] | None = None,
    stages: Sequence[Stage] | None = None,
    **solver: Any,
) -> Model:
    """Build a one-material Model of one stage; `stages` replaces it."""
    stage = Stage(
        "load",
        prescribed=tuple(PrescribedDisplacement(*p) for p in prescribed),  # type: ignore[arg-type]
        forces=tuple(PointForce(name, tuple(f)) for name, f in forces),
        shell_pressures=tuple(ShellPressure(name, p) for name, p in pressures),
        edge_forces=tuple(EdgeForce(name, tuple(f)) for name, f in edges),
        body_forces=() if body is None else (BodyForce(tuple(body)),),  # type: ignore[arg-type]
    )
    return Model(
        title="shell",
        analysis="shell",
        depth=1.0,
        mesh=mesh,
        materials=(material,),
        tools=(),
        supports=tuple(Support(name, fix) for name, fix in supports),
        stages=tuple(stages or (stage,)),
        solver=SolverSettings(**{"line_search": False, **solver}),
        output=OutputSettings(every=1),
    )


def run(model: Model) -> ImplicitProcedure:
    """Run a model to its end."""
    procedure = ImplicitProcedure(model, threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def solve_linear(model: Model, scale: float = 1e-6) -> FloatArray:
    """Return the displacement (n_points, 6) by the tangent of the undeformed shell under the load of the first stage.

    The load is scaled down, and the answer scaled back, so that it is the linear one.
    """
    procedure = ImplicitProcedure(model, threads=1)
    mechanics, state = procedure.mechanics, procedure.state
    zero = np.zeros_like(state.nodes.displacement)
    mechanics.evaluate(state, state.duplicate(), zero, with_stiffness=True)
    loads = procedure.interactions.loads.at(state, zero, 0, scale)
    constraints = procedure.interactions.supports.prescribe(state, 0, scale, zero)
    data = np.zeros(len(mechanics.assembler.indices))
    mechanics.assemble_stiffness(constraints.turned, constraints.frames, data)
    rhs = loads.force.copy()
    rhs[:, 3:] = np.einsum("nij,nj->ni", constraints.frames, rhs[:, 3:])
    flat = rhs.reshape(-1)
    mechanics.assembler.constrain(
        constraints.mask.reshape(-1), constraints.value.reshape(-1), float(data.max()), data, flat
    )
    solver = procedure.equilibrium.solver
    solver.factorise(data)
    solution = solver.solve(flat).reshape(-1, 6)
    solution[:, 3:] = np.einsum("nji,nj->ni", constraints.frames, solution[:, 3:])
    result: FloatArray = solution / scale
    return result
