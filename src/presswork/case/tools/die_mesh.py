# SPDX-License-Identifier: Apache-2.0
"""The meshes of tools that conduct heat: a block made behind the profile, or a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.forming import DieBlock, ToolHeat
from presswork.case.plane import schema
from presswork.case.plane.workpiece import MeshFile
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.pose import start_profile
from presswork.geometry.segments import measure_distance
from presswork.mesh import MeshError, read_mesh
from presswork.mesh.make.block_behind import grow_from, outline_block
from presswork.mesh.topology import find_boundary_edges

ON_PROFILE = 0.05
"""How far the ends of an edge in a file may lie from the profile and still count as on it, over the edge's length."""


def build_dies(
    case: schema.Case, tools: tuple[model.Tool, ...], folder: Path
) -> tuple[dict[str, model.DieMesh], list[Problem]]:
    """Return the meshes of the tools that have one, by name, and the problems of others."""
    dies, problems = {}, []
    for tool in tools:
        heat = case.tools[tool.name].heat
        if case.heat is None or heat is None or heat.mesh is None:
            continue
        key = f"tools.{tool.name}.heat.mesh"
        try:
            die = _build_die(heat, tool, folder)
        except MeshError as error:
            problems.append(Problem(key, error.fault, error.remedy))
            continue
        lowest = float(die.mesh.points[:, 0].min())
        if case.analysis == "axisymmetric" and lowest < -1e-9 * float(np.ptp(die.mesh.points)):
            fault = f"the mesh reaches to x = {lowest:.6g} mm, beyond the axis"
            problems.append(Problem(key, fault, "give corners at x >= 0"))
        if not len(die.profile):
            problems.append(Problem(key, "no edge of the mesh lies on the profile", "draw it where the profile is"))
        if heat.back_temperature is not None and not len(die.back):
            fault = "the mesh has no back"
            problems.append(Problem(f"tools.{tool.name}.heat.back_temperature", fault, "give depth, or a set back"))
        dies[tool.name] = die
    return dies, problems


def _build_die(heat: ToolHeat, tool: model.Tool, folder: Path) -> model.DieMesh:
    assert heat.conductivity is not None
    assert heat.specific_heat is not None
    assert heat.density is not None
    thermal = model.Thermal(
        density=heat.density,
        conductivity=np.array([[0.0, heat.conductivity]]),
        specific_heat=np.array([[0.0, heat.specific_heat]]),
    )
    segments = start_profile(tool)
    if isinstance(heat.mesh, MeshFile):
        mesh, profile, back = _read(heat.mesh, segments, folder)
    else:
        assert heat.mesh is not None
        mesh, profile, back = mesh_block(heat.mesh, segments, np.array(tool.position[:2]))
    held = back if heat.back_temperature is not None else np.zeros(0, dtype=np.int32)
    return model.DieMesh(mesh, thermal, profile, held, heat.back_temperature or 0.0)


def mesh_block(
    block: DieBlock, segments: model.FloatArray, place: model.FloatArray
) -> tuple[model.Mesh, model.IntArray, model.IntArray]:
    """Return the mesh behind a profile (n, 7), its edges on the profile (n, 2) and the nodes of its back (n,).

    place: where the origin of the frame is in which the corners are drawn (2,) [mm]. Raises MeshError.
    """
    from presswork.remesh.fill import fill_with_quadrilaterals

    is_open = not np.allclose(segments[0, :2], segments[-1, 2:4])
    if is_open and block.depth is None and not block.corners:
        raise MeshError("the profile is open", "give depth, or corners")
    corners = np.array(block.corners, dtype=np.float64).reshape(-1, 2) + place
    outline = outline_block(segments, block.size, block.depth or 0.0, corners if block.corners else corners[:0])
    depth = block.depth or float(np.ptp(outline.line, axis=0).min())

    def size(points: model.FloatArray) -> model.FloatArray:
        return grow_from(np.abs(measure_distance(points, segments).distance), block.size, depth)

    points, cells = fill_with_quadrilaterals(outline.line, size)
    connectivity = cells.astype(np.int32)
    ring = np.arange(len(outline.line), dtype=np.int32)
    sides = np.column_stack([ring, np.roll(ring, -1)])
    profile = sides[: outline.n_profile - is_open]
    first, last = outline.back
    mesh = model.Mesh(points, (model.CellBlock("quad4", connectivity, 0),), {}, {}, find_boundary_edges([connectivity]))
    return mesh, profile, ring[first : last + 1] if last > first else ring[:0]


def _read(
    file: MeshFile, segments: model.FloatArray, folder: Path
) -> tuple[model.Mesh, model.IntArray, model.IntArray]:
    """Return the mesh of a file, its edges on the profile and the nodes of its set back."""
    try:
        scale = unit_factor(file.unit, LENGTH)
    except ValueError as error:
        raise MeshError(f"{file.unit} is not a unit of length", "e.g. mm, m, inch") from error
    try:
        mesh, _ = read_mesh(folder / file.path, element="quad4", scale=scale)
    except MeshError:
        mesh, _ = read_mesh(folder / file.path, element="tri3", scale=scale)
    edges = mesh.boundary_edges
    gaps = np.abs(measure_distance(mesh.points, segments).distance)[edges]
    length = np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1)
    on_profile = (gaps <= ON_PROFILE * length[:, None]).all(axis=1)
    return mesh, edges[on_profile], mesh.node_sets.get("back", np.zeros(0, dtype=np.int32))
