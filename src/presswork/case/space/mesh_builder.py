# SPDX-License-Identifier: Apache-2.0
"""Builds the Mesh of a solid in space from the keys of its case."""

from __future__ import annotations

import logging
import math
from pathlib import Path

import numpy as np

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.plane.workpiece import MeshFile
from presswork.case.space.mesh import Box, ClosedSurface, Cylinder, Extruded, MadeMesh, Revolved, Ring, Turned
from presswork.case.stamping.plan_line import LineFile, PolygonLine, draw_line
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.polygon import polygon_area
from presswork.memory import available_memory, estimate_box, explain_shortage
from presswork.mesh import MeshError, grade_line
from presswork.mesh.files.readers import read_mesh
from presswork.mesh.make.box import mesh_box, read_solid_mesh
from presswork.mesh.make.outlined_blank import mesh_outlined_blank
from presswork.mesh.space.closed_surface import mesh_closed_surface
from presswork.mesh.space.disc import count_kites
from presswork.mesh.space.drawn_up import mesh_extruded, mesh_turned
from presswork.mesh.space.revolved import mesh_revolved
from presswork.model import FloatArray, IntArray

logger = logging.getLogger(__name__)


def check_space_mesh(key: str, mesh: MadeMesh | MeshFile, element: model.SpaceElement) -> list[Problem]:
    """Return the problems that show before a body is meshed; key: of the mesh in the case."""
    problems = []
    if mesh_unit := getattr(mesh, "unit", None):
        try:
            unit_factor(mesh_unit, LENGTH)
        except ValueError as error:
            fault = f"expected a unit of length, but {error}"
            problems.append(Problem(f"{key}.unit", fault, "e.g. mm, m, inch", mesh_unit))
    if isinstance(mesh, Cylinder | Turned) and (isinstance(mesh, Cylinder) or mesh.hole == 0.0):
        problems += _check_disc(key, mesh)
    if isinstance(mesh, ClosedSurface) and not model.cell_of(element).is_simplex:
        fault = f"a surface is filled with tetrahedra, not with cells of {element}"
        problems.append(Problem(f"{key}.kind", fault, 'take element = "tet4_mini"', "surface"))
    if isinstance(mesh, Box | Cylinder | Ring | Turned):
        one, two, three = mesh.cells
        problems += _check_memory(f"{key}.cells", one * two * three, element, list(mesh.cells))
    return problems


def _check_disc(key: str, mesh: Cylinder | Turned) -> list[Problem]:
    radial, around, _ = mesh.cells
    kites = count_kites(mesh.angle)
    step, most = 2 * kites, 2 * kites * (radial - 1)
    if radial < 2:
        fault, remedy = "a body without a hole has at least two cells along the radius", "give two or more"
    elif around % step or not step <= around <= most:
        fault = f"{around} cells around {mesh.angle:g} degrees, with {radial} along the radius"
        remedy = f"take a multiple of {step}, at most {most}; about {_usual_around(mesh.angle, radial, step)}"
    else:
        return []
    return [Problem(f"{key}.cells", fault, remedy, list(mesh.cells))]


def _usual_around(angle: float, radial: int, step: int) -> int:
    """Return the number of cells around, a multiple of step, that makes those at the rim about square."""
    most = step * (radial - 1)
    return min(max(step, step * round(math.radians(angle) * radial / step)), most)


def _check_memory(key: str, cells: float, element: model.SpaceElement, value: object) -> list[Problem]:
    needed, there = estimate_box(int(cells), element), available_memory()
    if needed <= there:
        return []
    fault, _, remedy = explain_shortage(needed, there).partition("; ")
    return [Problem(key, fault, remedy, value)]


def mesh_space_body(
    key: str, mesh: MadeMesh | MeshFile, element: model.SpaceElement, material: int, source: Path | None
) -> model.Mesh:
    """Mesh a body in space, or read its mesh; arguments and errors as those of solid.bodies.mesh_body."""
    folder = source.parent if source is not None else Path()
    if isinstance(mesh, Box):
        x, y, z = (
            grade_line(mesh.origin[axis], [(mesh.size[axis], mesh.cells[axis], mesh.grading[axis])])
            for axis in range(3)
        )
        return mesh_box(x, y, z, element=element, material=material)
    if isinstance(mesh, Cylinder | Ring | Turned):
        return _mesh_turned(mesh, element, material)
    if isinstance(mesh, Extruded):
        plan, quads = _mesh_plan(key, mesh, element, folder, source)
        z_lines = grade_line(mesh.bottom, [(mesh.height, mesh.cells, mesh.grading)])
        return mesh_extruded(plan, quads, z_lines, element=element, material=material)
    scale = unit_factor(mesh.unit, LENGTH)
    try:
        if isinstance(mesh, Revolved):
            plane, notes = read_mesh(folder / mesh.path, element="quad4", scale=scale)
            found = mesh_revolved(plane, angle=mesh.angle, around=mesh.around, element=element, material=material)
        elif isinstance(mesh, ClosedSurface):
            path, size = folder / mesh.path, mesh.size
            found, notes = mesh_closed_surface(path, size, element=element, scale=scale, material=material)
        else:
            found, notes = read_solid_mesh(folder / mesh.path, element=element, scale=scale, material=material)
    except MeshError as error:
        raise CaseError([Problem(f"{key}.mesh.path", error.fault, error.remedy, mesh.path)], source) from error
    for note in notes:
        logger.warning("%s.mesh.path = %s: %s", key, mesh.path, note)
    return found


def _mesh_turned(mesh: Cylinder | Ring | Turned, element: model.SpaceElement, material: int) -> model.Mesh:
    radial, around, along = mesh.cells
    inner: FloatArray | None = None
    if isinstance(mesh, Turned):
        radius, height = np.array(mesh.profile).T
        z_lines = _divide_heights(height, along)
        outer = np.interp(z_lines, height, radius)
        hole = mesh.hole
    else:
        z_lines = grade_line(0.0, [(mesh.height, along, mesh.grading)])
        outer = np.full(len(z_lines), mesh.radius if isinstance(mesh, Cylinder) else mesh.outer_radius)
        hole = 0.0 if isinstance(mesh, Cylinder) else mesh.inner_radius
    if hole > 0.0:
        inner = np.full(len(z_lines), hole)
    return mesh_turned(
        outer,
        inner,
        z_lines,
        origin=mesh.origin,
        angle=mesh.angle,
        cells=(radial, around),
        element=element,
        material=material,
    )


def _divide_heights(heights: FloatArray, cells: int) -> FloatArray:
    """Return z of so many cells + 1 lines; every height is one, and cells are shared out by the distances between."""
    lengths = np.diff(heights)
    counts = np.ones(len(lengths), dtype=int)
    while counts.sum() < cells:
        counts[np.argmax(lengths / counts)] += 1
    return grade_line(
        float(heights[0]), [(float(length), int(n), 1.0) for length, n in zip(lengths, counts, strict=True)]
    )


def _mesh_plan(
    key: str, mesh: Extruded, element: model.SpaceElement, folder: Path, source: Path | None
) -> tuple[FloatArray, IntArray]:
    """Return points (n, 2) [mm] and quadrilaterals of the outline of a body. Raises CaseError."""
    place = f"{key}.mesh.{'outline' if mesh.path is None else 'path'}"
    value = mesh.path if mesh.path is not None else [list(point) for point in mesh.outline or ()]
    try:
        if mesh.is_mesh:
            assert mesh.path is not None
            scale = unit_factor(mesh.unit or "mm", LENGTH)
            found, notes = read_mesh(folder / mesh.path, element="quad4", scale=scale)
            for note in notes:
                logger.warning("%s = %s: %s", place, mesh.path, note)
            return found.points, found.blocks[0].connectivity
        line = draw_line(_line_of(mesh), f"{key}.mesh", folder)
        if isinstance(line, Problem):
            raise CaseError([Problem(place, line.expected, line.remedy, value)], source)
        assert mesh.element_size is not None
        area = abs(polygon_area(line)) / 2 ** len(set(mesh.symmetry))
        size_key = f"{key}.mesh.element_size"
        shortage = _check_memory(size_key, area / mesh.element_size**2 * mesh.cells, element, mesh.element_size)
        if shortage:
            raise CaseError(shortage, source)
        made = mesh_outlined_blank(line, mesh.element_size, ["x" in mesh.symmetry, "y" in mesh.symmetry])
    except MeshError as error:
        raise CaseError([Problem(place, error.fault, error.remedy, value)], source) from error
    return made.points[:, :2], made.blocks[0].connectivity


def _line_of(mesh: Extruded) -> LineFile | PolygonLine:
    if mesh.path is not None:
        return LineFile(shape="file", path=mesh.path, unit=mesh.unit, layer=mesh.layer)
    assert mesh.outline is not None
    return PolygonLine(shape="polygon", points=tuple(mesh.outline))
