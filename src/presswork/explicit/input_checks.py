# SPDX-License-Identifier: Apache-2.0
"""What an explicit run refuses to start from."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.mesh.topology import is_triangle
from presswork.model import Mesh, list_names

Array = npt.NDArray[np.float64]
HEAVIEST = 1e-6
"""Density [t/mm3] beyond which a unit must be wrong: 50 times that of osmium."""

STRONGEST_DAMPING = 0.1
"""Part of its momentum that mass damping may take from the sheet in a step."""
SOLIDS = list_names(_core.Family.plane, in_explicit=True)
"""Elements with one point; tri3 in the crossed pattern is 4CST."""


class ExplicitError(ValueError):
    """Input that no run can start from, or a run that cannot go on."""


def check_nodal(value: npt.ArrayLike, name: str, shape: tuple[int, ...]) -> Array:
    """Return what was given for every node's freedoms. Raises ExplicitError for another shape, or what is no number."""
    given = np.ascontiguousarray(value, dtype=float)
    if given.shape != shape:
        raise ExplicitError(f"{name} has shape {given.shape}: it must be (n_nodes, {shape[1]}) = {shape}")
    if not np.isfinite(given).all():
        raise ExplicitError(f"{name} of node {np.argwhere(~np.isfinite(given))[0, 0]} is not a finite number")
    return given


def check_points(points: Array, dimension: int) -> None:
    """Raise ExplicitError unless points have shape (n_nodes, dimension) and are finite."""
    if points.ndim != 2 or points.shape[1] != dimension:
        where = "" if dimension == 3 else "solids in the plane have "
        raise ExplicitError(f"points has shape {points.shape}: {where or 'it must be '}(n_nodes, {dimension})")
    if not np.isfinite(points).all():
        raise ExplicitError(f"node {np.argwhere(~np.isfinite(points))[0, 0]} has a coordinate that is not a number")


def check_density(density: float) -> None:
    """Raise ExplicitError for a density [t/mm3] that nothing has."""
    if not density > 0:
        raise ExplicitError(f"density = {density:g}: it must be above zero; steel has 7.85e-9 t/mm3")
    if density > HEAVIEST:
        raise ExplicitError(f"density = {density:g} t/mm3 is beyond any metal: steel has 7.85e-9 t/mm3, not 7850")


def check_numbers(cells: npt.NDArray[np.int32], n_nodes: int, corners: int, name: str) -> None:
    """Raise ExplicitError unless cells have shape (n > 0, corners) and name nodes that are there."""
    if cells.ndim != 2 or cells.shape[1] != corners or len(cells) == 0:
        either = "(n, 4) or (n, 3)" if corners == 4 else f"(n, {corners})"
        raise ExplicitError(f"connectivity has shape {cells.shape}: it must be {either}, n > 0")
    outside = (cells < 0) | (cells >= n_nodes)
    if outside.any():
        cell, corner = np.argwhere(outside)[0]
        raise ExplicitError(
            f"{name} {cell} names node {cells[cell, corner]}: nodes are numbered from 0 to {n_nodes - 1}"
        )


def check_space_solids(points: Array, cells: npt.NDArray[np.int32], nodes: int) -> None:
    """Raise ExplicitError for cells of so many nodes that no run can start from; the kernel refuses inverted ones."""
    check_numbers(cells, len(points), nodes, "cell")


def check_shells(points: Array, cells: npt.NDArray[np.int32], thickness: Array, density: float, axes: Array) -> None:
    """Raise ExplicitError, with the first culprit and the remedy, for input that no run can start from.

    axes: direction of the law's x in each shell (n, 3).
    """
    check_points(points, 3)
    check_numbers(cells, len(points), 4, "shell")
    if not (thickness > 0).all():
        worst = int(np.argmin(thickness > 0))
        raise ExplicitError(f"thickness of shell {worst} is {thickness[worst]:g} mm: it must be above zero")
    check_density(density)
    corners = points[cells]
    before, after = np.roll(corners, 1, axis=1) - corners, np.roll(corners, -1, axis=1) - corners
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    turn = (np.cross(after, before) * normal[:, None, :]).sum(axis=2)
    concave = turn <= 1e-6 * (normal**2).sum(axis=1)[:, None]
    concave[is_triangle(cells), 1:] = False  # all corners of a triangle are alike
    if concave.any():
        shell, corner = np.argwhere(concave)[0]
        raise ExplicitError(
            f"shell {shell} (nodes {cells[shell].tolist()}) is folded or without area at node {cells[shell, corner]}: "
            "give its nodes in turn round it, all corners below 180 degrees"
        )
    along = (normal * axes).sum(axis=1)
    stands = ~(along**2 < (1 - 1e-9) * (normal**2).sum(axis=1) * (axes**2).sum(axis=1))
    if stands.any():
        shell = int(np.argmax(stands))
        raise ExplicitError(
            f"axis = {axes[shell].tolist()} is not a direction in shell {shell} (nodes {cells[shell].tolist()}), but "
            "normal to it or zero: turn it into the sheet"
        )


def check_solids(mesh: Mesh, n_materials: int, axisymmetric: bool, depth: float, hourglass_fraction: float) -> None:
    """Raise ExplicitError, with the first culprit and the remedy, for input that no run can start from."""
    check_points(mesh.points, 2)
    if not depth > 0:
        raise ExplicitError(f"depth = {depth}: it must be above zero")
    if not 0 <= hourglass_fraction <= 1:
        raise ExplicitError(f"hourglass_fraction = {hourglass_fraction}: it must lie between 0 and 1")
    if axisymmetric and (left := mesh.points[:, 0]).min() < -1e-9 * np.ptp(mesh.points):
        raise ExplicitError(f"node {np.argmin(left)} has radius {left.min():g} mm: x is the radius, from the axis at 0")
    if not mesh.blocks:
        raise ExplicitError("the mesh has no cells")
    for block in mesh.blocks:
        if block.element not in SOLIDS:
            raise ExplicitError(f"element {block.element}: explicit solids are {' or '.join(SOLIDS)}")
        if not 0 <= block.material < n_materials:
            raise ExplicitError(f"a block asks for material {block.material}: there are {n_materials}, from 0")
        cells = block.connectivity
        if cells.min() < 0 or cells.max() >= len(mesh.points):
            raise ExplicitError(f"a cell names node {cells.max()}: nodes are 0 to {len(mesh.points) - 1}")
        corners = mesh.points[cells]
        before, after = np.roll(corners, 1, axis=1) - corners, np.roll(corners, -1, axis=1) - corners
        turn = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
        if (turn <= 0).any():
            cell = int(np.argwhere(turn <= 0)[0, 0])
            raise ExplicitError(
                f"cell {cell} of {block.element} (nodes {cells[cell].tolist()}) has no area or a corner of 180 degrees "
                "or more: give its nodes counter-clockwise"
            )


def check_damping(damping: float, step: float) -> None:
    """Raise ExplicitError if mass damping [1/s] would stop a part within a few steps [s], as in tar."""
    if damping * step > STRONGEST_DAMPING:
        raise ExplicitError(
            f"explicit.damping = {damping:g} 1/s: it would stop the part within {1 / damping:.2g} s, and a step is "
            f"{step:.2g} s; take a few times 1/duration of the stage, or leave it out"
        )
