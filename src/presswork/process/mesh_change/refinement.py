# SPDX-License-Identifier: Apache-2.0
"""Adaptive refinement of a blank in explicit stamping: which shells are split, and where their new nodes lie.

A shell is split where the sheet turns by more than an angle from it to a neighbour, or where a tool that is nearly
touched turns by as much along it. docs/theory/explicit_shells.md has the reasons.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.mesh.split import SplitMesh, SplitStep
from presswork.mesh.topology import edge_keys
from presswork.model import BoolArray, FloatArray, IntArray, Mesh, Refinement

Planes = Sequence[tuple[int, IntArray]]
"""The axis that each symmetry plane is normal to, and its nodes."""
LOOK_AHEAD = 1.0
"""How near a tool must be to be checked, over the side of the shell."""


@dataclass(frozen=True)
class PlacedTool:
    """A tool where it stands."""

    surface: _core.ToolSurface
    position: FloatArray
    """[mm] (3,)."""

    def nearest(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return gap (n,), infinite beyond reach, and normal (n, 3) out of the tool of points (n, 3)."""
        gap, normal, *_ = self.surface.nearest(np.ascontiguousarray(points - self.position), reach)
        return np.asarray(gap), np.asarray(normal)


def find_planes(mesh: Mesh) -> Planes:
    """Return the axes that symmetry planes of a blank are normal to, and their nodes."""
    sets = mesh.node_sets
    return [(axis, sets[name]) for axis, name in enumerate(("symmetry_x", "symmetry_y")) if name in sets]


def choose_shells(
    mesh: SplitMesh,
    points: FloatArray,
    thickness: FloatArray,
    tools: Iterable[PlacedTool],
    refinement: Refinement,
    planes: Planes = (),
) -> BoolArray:
    """Return the shells to split (n,): those that turn by more than the angle, and may be split once more.

    points (n_nodes, 3) and thickness (n,) [mm] are those of the present sheet. planes: as place_nodes has them.
    """
    turn = bend_angles(mesh, points, planes)
    for tool in tools:
        turn = np.maximum(turn, tool_angles(mesh, points, thickness, tool))
    return np.asarray((turn > refinement.angle) & (mesh.level < refinement.levels))


def bend_angles(mesh: SplitMesh, points: FloatArray, planes: Planes = ()) -> FloatArray:
    """Return the largest angle between each shell's normal and a neighbour's, over the distance of both middles, times
    the shell's own side (n,) [rad].

    A neighbour may be the mirror image beyond one of the symmetry planes (place_nodes).
    """
    normal, side = measure_shells(mesh.cells, points)
    one, other = neighbours(mesh)
    unit = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    turn = np.arccos(np.clip((unit[one] * unit[other]).sum(axis=1), -1.0, 1.0)) * 2.0 / (side[one] + side[other])
    most = np.zeros(len(mesh.cells))
    np.maximum.at(most, one, turn * side[one])
    np.maximum.at(most, other, turn * side[other])
    for axis, nodes in planes:
        ends = np.isin(np.stack([mesh.cells, np.roll(mesh.cells, -1, axis=1)]), nodes).all(axis=0)
        beside = (ends & (mesh.cells != np.roll(mesh.cells, -1, axis=1))).any(axis=1)
        own = 2.0 * np.arcsin(np.clip(np.abs(unit[:, axis]), 0.0, 1.0))
        most = np.where(beside, np.maximum(most, own), most)
    return most


def tool_angles(mesh: SplitMesh, points: FloatArray, thickness: FloatArray, tool: PlacedTool) -> FloatArray:
    """Return the largest angle between the tool's normals at the ends of each shell's sides (n,) [rad].

    Sides count whose ends are both nearer to the tool than the side's own length, half the thickness taken off.
    """
    _, size = measure_shells(mesh.cells, points)
    gap, normal = tool.nearest(points, float(LOOK_AHEAD * size.max() + thickness.max()))
    ends = mesh.cells, np.roll(mesh.cells, -1, axis=1)
    length = np.linalg.norm(points[ends[0]] - points[ends[1]], axis=2)
    near = np.maximum(gap[ends[0]], gap[ends[1]]) < LOOK_AHEAD * length + 0.5 * thickness[:, None]
    cosine = np.einsum("cki,cki->ck", normal[ends[0]], normal[ends[1]])
    return np.asarray(np.where(near, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0).max(axis=1))


def measure_shells(cells: IntArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return twice the area as a normal (n, 3) and the side, the root of the area (n,)."""
    x = points[cells]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    return normal, np.sqrt(0.5 * np.linalg.norm(normal, axis=1))


def neighbours(mesh: SplitMesh) -> tuple[IntArray, IntArray]:
    """Return the pairs of shells that share a side or half of one."""
    ends = np.stack([mesh.cells, np.roll(mesh.cells, -1, axis=1)], axis=-1)
    middle = mesh.middles(mesh.cells)
    owner = np.broadcast_to(np.arange(len(mesh.cells))[:, None], middle.shape)
    hangs, real = middle >= 0, ends[..., 0] != ends[..., 1]
    halves = [np.stack([ends[hangs][:, i], middle[hangs]], axis=1) for i in (0, 1)]
    sides = np.concatenate([ends[real & ~hangs], *halves])
    of = np.concatenate([owner[real & ~hangs], owner[hangs], owner[hangs]])
    keys = edge_keys(sides)
    order = np.argsort(keys, kind="stable")
    same = keys[order][:-1] == keys[order][1:]
    return of[order[:-1][same]].astype(np.int32), of[order[1:][same]].astype(np.int32)


def place_nodes(
    before: SplitMesh,
    step: SplitStep,
    points: FloatArray,
    thickness: FloatArray,
    planes: Planes,
    tools: Iterable[PlacedTool],
) -> FloatArray:
    """Return the positions of all nodes (n_nodes, 3) after shells were split.

    New nodes lie in the middle, off it by what a side sags whose slope runs linearly between the sheet's normals at its
    ends; so a shell round a tool does not leave the middles of its sides inside the tool. What is left is undone: no
    new node is deeper in a tool than its parents on the mean, nor less deep where all of them touch. planes: axis that
    symmetry planes are normal to, and their nodes. thickness of the shells before (n,).
    """
    normals, half = node_means(before, points, thickness, planes)
    made_of = step.made_of
    corners = points[made_of]
    sides = (made_of[:, :2] == made_of[:, 2:]).all(axis=1)
    new = corners.mean(axis=1)
    new[sides] += sag_of_sides(points, normals, made_of[sides, 0], made_of[sides, 1])
    # the middle of a quadrilateral lies off by the means of both pairs of its sides
    middle = step.mesh.middles(made_of[~sides])
    chord = 0.5 * (corners[~sides] + np.roll(corners[~sides], -1, axis=1))
    all_points = np.concatenate([points, new])
    new[~sides] += 0.5 * (all_points[middle] - chord).sum(axis=1)
    reach = 2.0 * float(np.sqrt(0.5 * np.abs(measure_shells(before.cells, points)[0])).max())
    for tool in tools:
        parents_gap, _ = tool.nearest(points, reach)
        depth = np.where(np.isfinite(parents_gap), half - parents_gap, -np.inf)[made_of]
        wanted = np.maximum(depth, 0.0).mean(axis=1)
        gap, normal = tool.nearest(new, reach)
        off = half[made_of].mean(axis=1) - gap - wanted  # how much too deep
        move = np.isfinite(gap) & ((off > 0) | (depth > 0).all(axis=1))
        new[move] += off[move, None] * normal[move]
    return np.concatenate([points, new])


def node_means(
    mesh: SplitMesh, points: FloatArray, thickness: FloatArray, planes: Planes
) -> tuple[FloatArray, FloatArray]:
    """Return unit normals (n_nodes, 3) and half the thickness (n_nodes,) of the shells round each node."""
    of_shell, _ = measure_shells(mesh.cells, points)
    normal, sums = np.zeros_like(points), np.zeros((len(points), 2))
    for corner in range(4):
        own = np.ones(len(mesh.cells)) if corner < 3 else (mesh.cells[:, 2] != mesh.cells[:, 3]).astype(float)
        np.add.at(normal, mesh.cells[:, corner], of_shell * own[:, None])
        np.add.at(sums, mesh.cells[:, corner], np.stack([0.5 * thickness * own, own], axis=1))
    for axis, nodes in planes:
        normal[nodes, axis] = 0.0
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return normal / np.where(size > 0, size, 1.0), sums[:, 0] / np.maximum(sums[:, 1], 1.0)


def sag_of_sides(points: FloatArray, normals: FloatArray, first: IntArray, last: IntArray) -> FloatArray:
    """Return how far the middles of sides lie off the chord (n, 3) [mm]; see hanging.hpp."""
    along, mean = points[last] - points[first], normals[first] + normals[last]
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-300)
    rise = 0.125 * ((normals[last] - normals[first]) * along).sum(axis=1)
    return np.asarray(rise[:, None] * mean)
