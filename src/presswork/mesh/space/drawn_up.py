# SPDX-License-Identifier: Apache-2.0
"""Hexahedra of bodies that are drawn up along z: turned ones, whole or a sector, and any outline of one height."""

from __future__ import annotations

import numpy as np

from presswork.mesh.make.box import finish_mesh
from presswork.mesh.space.disc import mesh_annulus, mesh_disc, point_at
from presswork.mesh.topology import find_boundary_edges
from presswork.model import FloatArray, IntArray, Mesh, SpaceElement, cell_of, find_cell


def mesh_turned(
    outer: FloatArray,
    inner: FloatArray | None,
    z_lines: FloatArray,
    *,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    angle: float,
    cells: tuple[int, int],
    element: SpaceElement,
    material: int = 0,
) -> Mesh:
    """Mesh a body of revolution about z through origin, or the sector of it that begins at the x axis.

    outer, inner: radius at each line of z [mm]; inner None: the body is solid. z_lines: increasing, from origin
    [mm]. angle [degrees], at most 360. cells: along the radius and around. Sets beside those of a box: rim, hole;
    of a sector first_plane, last_plane. Raises ValueError for cells that do not fit.
    """
    if inner is None:
        plan, quads = mesh_disc(angle, *cells)
        layers = [radius * plan for radius in outer]
        along = np.linalg.norm(plan, axis=1)
        degrees = np.degrees(np.arctan2(plan[:, 1], plan[:, 0])) % 360.0
        on_hole = np.zeros(len(plan), dtype=bool)
        on_first, on_last = (plan[:, 1] == 0.0) & (plan[:, 0] >= 0.0), np.abs(degrees - angle) < 1e-9
        on_last |= along == 0.0
    else:
        parameters, quads = mesh_annulus(angle, *cells)
        along, degrees = parameters.T
        layers = [point_at(a + (b - a) * along, degrees) for a, b in zip(inner, outer, strict=True)]
        on_hole = along == 0.0
        on_first, on_last = degrees == 0.0, degrees == angle
    named = {"rim": np.abs(along - 1.0) < 1e-9}
    if inner is not None:
        named["hole"] = on_hole
    if angle < 360.0:
        named |= {"first_plane": on_first, "last_plane": on_last}
    layers = [layer + origin[:2] for layer in layers]
    mesh = _draw_up(layers, quads, z_lines + origin[2], named, element, material)
    if cell_of(element).is_quadratic:
        _round_faces(mesh, np.array(origin))
    return mesh


def _round_faces(mesh: Mesh, origin: FloatArray) -> None:
    """Put the middles of the edges on rim and hole where the arcs are."""
    for faces in (mesh.face_sets[name] for name in ("rim", "hole") if name in mesh.face_sets):
        for *ends, side in find_cell(2, faces).edges.tolist():
            middle = faces[:, side]
            radii = np.linalg.norm((mesh.points[faces[:, ends]] - origin)[:, :, :2], axis=2).mean(axis=1)
            away = mesh.points[middle, :2] - origin[:2]
            mesh.points[middle, :2] = origin[:2] + away * (radii / np.linalg.norm(away, axis=1))[:, None]


def mesh_extruded(
    plan: FloatArray, quads: IntArray, z_lines: FloatArray, *, element: SpaceElement, material: int = 0
) -> Mesh:
    """Mesh the prism over points (n, 2) [mm] and quadrilaterals (m, 4), counter-clockwise, of a plane mesh.

    z_lines: increasing [mm]. Sets beside those of a box: rim, all round.
    """
    on_rim = np.zeros(len(plan), dtype=bool)
    on_rim[find_boundary_edges([quads])] = True
    return _draw_up([plan] * len(z_lines), quads, z_lines, {"rim": on_rim}, element, material)


def _draw_up(
    layers: list[FloatArray],
    quads: IntArray,
    z_lines: FloatArray,
    named: dict[str, np.ndarray],
    element: SpaceElement,
    material: int,
) -> Mesh:
    """Return the hexahedra between layers (n, 2) of the same quadrilaterals; named marks nodes of a layer (n,)."""
    n, count = len(layers[0]), len(z_lines)
    if count < n:  # numbers run fastest along the direction with fewer cells
        step, up = count, 1
    else:
        step, up = 1, n
    number = np.arange(n)[:, None] * step + np.arange(count) * up  # (n, count)
    points = np.empty((n * count, 3))
    for level, (layer, z) in enumerate(zip(layers, z_lines, strict=True)):
        points[number[:, level], :2], points[number[:, level], 2] = layer, z
    lower = number[quads, :-1]  # (m, 4, count - 1)
    upper = number[quads, 1:]
    cells = np.concatenate([lower, upper], axis=1).transpose(0, 2, 1).reshape(-1, 8)
    sets = {name: np.sort(number[mask].ravel()).astype(np.int32) for name, mask in named.items()}
    return finish_mesh(points, cells.astype(np.int32), sets, element, material)
