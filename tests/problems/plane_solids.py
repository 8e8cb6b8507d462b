# SPDX-License-Identifier: Apache-2.0
"""Set-up shared by the verification tests: meshes, models built in memory, runs without an output folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from presswork.implicit.progress import IncrementReport
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh import mesh_rectangle
from presswork.mesh.topology import find_boundary_edges
from presswork.model import (
    Analysis,
    ElementName,
    FloatArray,
    Hardening,
    Material,
    Mesh,
    Model,
    OutputSettings,
    PrescribedDisplacement,
    Pressure,
    SolverSettings,
    Stage,
    Support,
    find_cell,
)

DATA = Path(__file__).parents[1] / "data"

ELEMENTS: tuple[ElementName, ...] = (
    "tri3", "tri6_6pt", "tri6_7pt", "quad4", "quad4_fbar", "quad4_1pt", "quad8", "quad8_2x2", "quad9", "quad9_2x2",
)  # fmt: skip


def linear_hardening(yield_stress: float, modulus: float = 0.0) -> Hardening:
    """Return linear isotropic hardening; perfect plasticity without a modulus."""
    return Hardening("linear", np.array([yield_stress, modulus]))


def elastic(young: float, poisson: float) -> Material:
    """Return a material that never yields."""
    return Material("elastic", young, poisson, linear_hardening(1e30))


def fixed_increments(n: int, **settings: object) -> SolverSettings:
    """Return settings that cross a stage in n equal increments, with tight tolerances."""
    tight = {"force_tolerance": 1e-10, "displacement_tolerance": 1e-8, "symmetric": False}
    return SolverSettings(initial_increment=1.0 / n, max_increment=1.0 / n, **{**tight, **settings})  # type: ignore[arg-type]


def make_model(
    mesh: Mesh,
    material: Material,
    *,
    analysis: Analysis = "plane_strain",
    supports: Sequence[Support] = (),
    prescribed: Sequence[PrescribedDisplacement] = (),
    pressures: Sequence[Pressure] = (),
    solver: SolverSettings | None = None,
    stages: Sequence[Stage] | None = None,
) -> Model:
    """Build a one-material, one-stage Model without tools; `stages` replaces the stage."""
    return Model(
        title="verification",
        analysis=analysis,
        depth=1.0,
        mesh=mesh,
        materials=(material,),
        tools=(),
        supports=tuple(supports),
        stages=tuple(stages or (Stage("load", prescribed=tuple(prescribed), pressures=tuple(pressures)),)),
        solver=solver or SolverSettings(),
        output=OutputSettings(every=1),
    )


def run(model: Model, threads: int = 1) -> tuple[ImplicitProcedure, list[IncrementReport]]:
    """Run the whole process; return the procedure at its end and every report."""
    procedure = ImplicitProcedure(model, threads=threads)
    return procedure, list(procedure.advance())


def block_mesh(
    element: ElementName, cells: tuple[int, int], *, origin: tuple[float, float], size: tuple[float, float]
) -> Mesh:
    """Mesh a rectangle with equal cells; triangles by one diagonal."""
    lines = [np.linspace(o, o + s, n + 1) for o, s, n in zip(origin, size, cells, strict=True)]
    pattern = "right" if element.startswith("tri") else "quad"
    return mesh_rectangle(lines[0], lines[1], element=element, pattern=pattern)


def distort(mesh: Mesh, amplitude: float, seed: int = 7) -> Mesh:
    """Move inner corner nodes at random by up to `amplitude` [mm]; edges stay straight with nodes at their middles."""
    points = mesh.points.copy()
    inner = np.ones(len(points), dtype=bool)
    inner[np.unique(mesh.boundary_edges)] = False
    shift = np.random.default_rng(seed).uniform(-amplitude, amplitude, points.shape)
    points[inner] += shift[inner]
    for block in mesh.blocks:
        cells = block.connectivity
        cell = find_cell(2, cells)
        corners = points[cells[:, : cell.corners]]
        if cell.is_quadratic:
            points[cells[:, cell.edges[:, 2]]] = 0.5 * (corners + np.roll(corners, -1, axis=1))
        for inner in cell.inner:
            points[cells[:, inner]] = corners.mean(axis=1)
    return replace(mesh, points=points)


def map_points(mesh: Mesh, points: FloatArray) -> Mesh:
    """Return the mesh with its nodes moved to other points, connectivity and sets kept."""
    return replace(mesh, points=points, boundary_edges=find_boundary_edges([b.connectivity for b in mesh.blocks]))


def with_node_sets(mesh: Mesh, nodes: Sequence[int]) -> Mesh:
    """Return the mesh with a set "node <i>" for each node."""
    own = {f"node {i}": np.array([i], dtype=np.int32) for i in nodes}
    return replace(mesh, node_sets={**mesh.node_sets, **own})


def prescribe(displacement: Mapping[int, FloatArray]) -> list[PrescribedDisplacement]:
    """Prescribe both components of single nodes, in sets as of with_node_sets."""
    return [
        PrescribedDisplacement(f"node {i}", component, float(u[component]))  # type: ignore[arg-type]
        for i, u in displacement.items()
        for component in (0, 1)
    ]


def drive_boundary(
    mesh: Mesh, gradients: Sequence[FloatArray], material: Material, *, analysis: Analysis, solver: SolverSettings
) -> Model:
    """Drive every boundary node through u = (F - 1) X, one stage for each in-plane deformation gradient F (2, 2)."""
    boundary = [int(i) for i in np.unique(mesh.boundary_edges)]
    stages, before = [], np.eye(2)
    for number, F in enumerate(gradients):
        moves = {i: (np.asarray(F) - before) @ mesh.points[i] for i in boundary}
        stages.append(Stage(f"stage {number}", prescribed=tuple(prescribe(moves))))
        before = np.asarray(F)
    return make_model(with_node_sets(mesh, boundary), material, analysis=analysis, solver=solver, stages=stages)


@dataclass(frozen=True)
class Fit:
    """A fitted convergence rate."""

    rate: float
    errors: FloatArray


def fit_rate(sizes: Sequence[float], errors: Sequence[float]) -> Fit:
    """Fit the slope of log(error) against log(size)."""
    slope = np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0]
    return Fit(float(slope), np.abs(np.asarray(errors)))
