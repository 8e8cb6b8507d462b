# SPDX-License-Identifier: Apache-2.0
"""Loads that the workpiece hands over to the profile of a die's mesh: force and, in plane strain, moment are kept.

1. The force on each node of the workpiece in contact is spread along the profile by its hat function, which falls to
   zero at its neighbours in contact, and integrated with the shape functions of the die's edges (in axisymmetry over
   rings). Shares are divided by their sum, so the force is kept.
2. Plane strain: a traction that is linear between nodes has a little less moment about a point than the forces at the
   nodes. On each connected patch a couple puts it right: c w_i (x_i - x_m) turned by 90 degrees, w_i the sum of the
   shares of node i without their signs, x_m the mean of x_i with these weights. The couple's forces add to zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from presswork.fields.contact_stress import ContactSurface
from presswork.geometry.pose import to_tool_frame, turn_vectors
from presswork.mesh.edges import edge_shape_functions
from presswork.model import FloatArray, IndexArray, IntArray
from presswork.post.interface import order_along_boundary
from presswork.post.tool_profile import distance_to_profile, trace_profile
from presswork.results import Result

POINTS = np.polynomial.legendre.leggauss(4)
"""Places and weights by which a piece of an edge is integrated."""

NEAR = 0.01
"""Distance of a node from a tool that presses on it in an explicit run, over the size of the workpiece, at most."""


@dataclass(frozen=True)
class ToolLoad:
    """Forces of the workpiece on a tool at one saved step, in the frame in which the tool starts."""

    points: FloatArray
    """Places of the workpiece's nodes (n, 2) [mm]."""
    force: FloatArray
    """(n, 2) [N]: of a whole ring, or of the depth."""
    patch: IndexArray
    """Number of the connected part of the contact that a node belongs to (n,); nodes are in order along it."""


def find_tool_load(result: Result, tool: str, step: int) -> ToolLoad:
    """Return the forces on a tool at a saved step: the saved contact traction times the area of each node.

    Explicit runs save no traction: their contact forces are taken, each for the nearest tool. Raises ResultError for
    an unknown tool or step, or where the run holds neither.
    """
    points, edges = result.points(step), result.mesh_at(step).boundary_edges
    find = _find_forces if "contact_status" in result.field_names else _take_nearest
    force = find(result, tool, step, points, edges.astype(np.int32))
    pose = result.tool_pose(tool, step)
    parts = order_along_boundary(points, edges, np.asarray((force != 0.0).any(axis=1)))
    nodes = np.concatenate([np.zeros(0, dtype=np.int64), *parts])
    patch = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return ToolLoad(to_tool_frame(points[nodes], pose), turn_vectors(force[nodes], -pose.angle), patch)


def _find_forces(result: Result, tool: str, step: int, points: FloatArray, edges: IntArray) -> FloatArray:
    """Return the forces on a tool at the nodes (n_points, 2) [N], whose traction is saved."""
    single = len(result.tools) == 1
    traction = result.field("contact_traction" if single else f"contact_traction_{tool}", step)[:, :2]
    held, gap = result.field("contact_status", step) > 0, result.field("gap", step)
    depth = None if result.info["analysis"] == "axisymmetric" else float(result.info["depth"])
    area = ContactSurface(edges, points, held, gap, depth=depth).nodal_area
    return np.asarray(-area[:, None] * traction)


def _take_nearest(result: Result, tool: str, step: int, points: FloatArray, edges: IntArray) -> FloatArray:
    """Return the contact forces at the nodes (n_points, 2) [N] of the boundary that are nearest to a tool."""
    force = np.zeros(points.shape)
    boundary = np.unique(edges)
    names = list(result.tools)
    profiles = [trace_profile(result.placed_tool(name, step)) for name in names]
    away = np.array([distance_to_profile(points[boundary], profile) for profile in profiles])
    near = away.min(axis=0) < NEAR * float(np.ptp(points, axis=0).max())  # beyond it bodies press on each other
    own = boundary[near & (np.argmin(away, axis=0) == names.index(tool))]
    force[own] = -result.field("contact_force", step)[own, :2]
    return force


def hand_over(load: ToolLoad, points: FloatArray, profile: IntArray, *, is_ring: bool) -> tuple[FloatArray, float]:
    """Return the forces on the nodes of a die (n, 2) [N], and the largest distance of a loaded place from its profile.

    points (n, 2) [mm]; profile: its nodes in order, corners and middles in turn (2 k + 1,).
    """
    line = points[profile]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    place, away = _project(load.points, line, along)
    shares = _find_shares(place, load.patch, line, along, is_ring=is_ring)
    shares = (scipy.sparse.diags(1.0 / np.asarray(shares.sum(axis=1)).ravel()) @ shares).tocsr()
    forces = np.zeros(points.shape)
    for number in np.unique(load.patch):
        own = load.patch == number
        part = ToolLoad(load.points[own], load.force[own], load.patch[own])
        spread = shares[own].T @ part.force
        forces[profile] += spread if is_ring else spread + _put_moment_right(spread, shares[own], line, part)
    return forces, float(away.max(initial=0.0))


def moment_of(points: FloatArray, forces: FloatArray) -> float:
    """Return the moment of forces (n, 2) at places (n, 2) about the origin [N mm]."""
    return float((points[:, 0] * forces[:, 1] - points[:, 1] * forces[:, 0]).sum())


def _project(points: FloatArray, line: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return where points (n, 2) are along a line (k, 2) (n,), and how far off it [mm]."""
    start, side = line[:-1], np.diff(line, axis=0)
    square = (side**2).sum(axis=1)
    place, away = np.zeros(len(points)), np.zeros(len(points))
    for n, point in enumerate(points):
        part = np.clip(((point - start) * side).sum(axis=1) / square, 0.0, 1.0)
        distance = np.linalg.norm(start + part[:, None] * side - point, axis=1)
        nearest = int(np.argmin(distance))
        place[n] = along[nearest] + part[nearest] * np.sqrt(square[nearest])
        away[n] = distance[nearest]
    return place, away


def _find_shares(
    place: FloatArray, patch: IndexArray, line: FloatArray, along: FloatArray, *, is_ring: bool
) -> scipy.sparse.csr_matrix:
    """Return int N_i phi_j dA of each place j and node i of the profile (n, k), up to a factor."""
    n_edges = (len(line) - 1) // 2
    ends = along[::2]
    rows, columns, values = [], [], []
    for j, (low, high) in enumerate(_find_supports(place, patch, along)):
        first = max(int(np.searchsorted(ends, low, side="right")) - 1, 0)
        last = min(int(np.searchsorted(ends, high, side="left")), n_edges)
        for edge in range(first, max(last, first + 1)):
            a, b = max(low, ends[edge]), min(high, ends[edge + 1])
            stops = [a, place[j], b] if a < place[j] < b else [a, b]
            share = sum((_integrate(p, q, place[j], (low, high), edge, line, ends, is_ring=is_ring)
                         for p, q in pairwise(stops)), np.zeros(3))  # fmt: skip
            rows += [j] * 3
            columns += [2 * edge, 2 * edge + 2, 2 * edge + 1]
            values += share.tolist()
    return scipy.sparse.csr_matrix((values, (rows, columns)), shape=(len(place), len(line)))


def _find_supports(place: FloatArray, patch: IndexArray, along: FloatArray) -> list[tuple[float, float]]:
    """Return from where to where each hat reaches, within its patch; that of a place alone over its nearest edge."""
    supports = []
    for j, own in enumerate(place):
        beside = [float(place[k]) for k in (j - 1, j + 1) if 0 <= k < len(place) and patch[k] == patch[j]]
        low, high = min([*beside, own]), max([*beside, own])
        if high - low <= 1e-9 * along[-1]:
            corner = min(max(2 * int(np.searchsorted(along[::2], own)) - 2, 0), len(along) - 3)
            low, high = along[corner], along[corner + 2]
        supports.append((float(low), float(high)))
    return supports


def _integrate(
    start: float, end: float, peak: float, support: tuple[float, float], edge: int, line: FloatArray, ends: FloatArray,
    *, is_ring: bool,
) -> FloatArray:  # fmt: skip
    """Return the integrals of the hat times the shape functions of an edge between two places (3,)."""
    s, weight = POINTS
    at = start + 0.5 * (s + 1.0) * (end - start)
    low, high = support
    rising, falling = (at - low) / max(peak - low, 1e-300), (high - at) / max(high - peak, 1e-300)
    hat = np.where(at <= peak, rising if peak > low else 1.0, falling if high > peak else 1.0)
    xi = 2.0 * (at - ends[edge]) / (ends[edge + 1] - ends[edge]) - 1.0
    shapes = np.array([edge_shape_functions(3, x)[0] for x in xi])
    corners = line[[2 * edge, 2 * edge + 2, 2 * edge + 1]]
    radius = np.maximum(shapes @ corners[:, 0], 0.0) if is_ring else np.ones(len(at))
    return np.asarray((0.5 * (end - start) * weight * hat * radius) @ shapes)


def _put_moment_right(
    forces: FloatArray, shares: scipy.sparse.csr_matrix, line: FloatArray, load: ToolLoad
) -> FloatArray:
    """Return the couples (k, 2) [N] that give the forces on the profile (k, 2) of one patch the moment of its load."""
    weight = np.asarray(abs(shares).sum(axis=0)).ravel()
    middle = weight @ line / weight.sum()
    arm = line - middle
    missing = moment_of(load.points - middle, load.force) - moment_of(arm, forces)
    couple = missing / float(weight @ (arm**2).sum(axis=1)) * weight
    return np.asarray(couple[:, None] * np.column_stack([-arm[:, 1], arm[:, 0]]))
