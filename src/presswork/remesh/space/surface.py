# SPDX-License-Identifier: Apache-2.0
"""The skin of a new mesh put in its place: nodes in contact on the tools, sharp edges of tools as edges of the mesh,
planes flat to the bit, and the volume given back.

A new node lies in a face of the old skin. It is in contact with a tool where half of that face's shares or more belong
to nodes in contact: contact reaches half an edge beyond its last node, on the old mesh and on the new one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.tetrahedra import area_vectors, enclosed_volume, list_edges, nodal_areas
from presswork.remesh.space.tools import PlacedTool, put_on_tools

LARGEST_OFFSET = 0.25
"""Largest offset that gives the volume back, over the mean edge of the skin."""
STEEPEST, NEAR = 0.5, 0.02
"""How far a node may lie off a tool and still be put on it: over its distance from the end of a contact, and over its
mean edge."""
SNAP = 0.45
"""Distance over its mean edge within which a node is put on a tool's sharp edge."""
APART = 0.3
"""Distance over its mean edge within which such a node then has no neighbour."""
TURNED = 0.5
"""Cosine between the normals of a face before and after, below which its nodes have gone too far."""
_NEAREST, _OTHER_SIDE = 24, 1e6
_ROUNDS = 12


@dataclass(frozen=True)
class FacePlaces:
    """Where points lie on the old skin."""

    face: IndexArray
    """(n,)."""
    share: FloatArray
    """Share of the face's corners, in it or on its rim (n, 3)."""


def locate_on_skin(
    points: FloatArray, faces: IndexArray, wanted: FloatArray, normals: FloatArray | None = None
) -> FacePlaces:
    """Find the nearest place of faces (k, 3) over points to each wanted point (n, 3).

    normals: outwards at the wanted points, of any length (n, 3). Where the skin has folded onto itself the face on the
    other side of the fold, which has the opposite direction, may be nearer.
    """
    corners = points[faces]
    outwards = area_vectors(points, faces)
    n_near = min(_NEAREST, len(faces))
    middle = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    distance, near = cKDTree(middle).query(wanted, k=n_near)
    distance, near = distance.reshape(len(wanted), n_near), near.reshape(len(wanted), n_near)
    best = np.full(len(wanted), np.inf)
    face, share = near[:, 0].copy(), np.full((len(wanted), 3), 1.0 / 3.0)
    for number, all_candidates in enumerate(near.T):
        asked = np.flatnonzero(distance[:, number] - radius[all_candidates] < best)  # others lie farther off
        candidate = all_candidates[asked]
        found = _nearest_shares(corners[candidate], wanted[asked])
        away = np.linalg.norm(np.einsum("nk,nki->ni", found, corners[candidate]) - wanted[asked], axis=1)
        if normals is not None:
            looks = np.einsum("ni,ni->n", outwards[candidate], normals[asked])
            away = np.where(looks < 0.0, away + _OTHER_SIDE, away)
        better = away < best[asked] * (1.0 - 1e-12)
        row = asked[better]
        best[row], face[row], share[row] = away[better], candidate[better], found[better]
    return FacePlaces(face, share)


def _nearest_shares(corners: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the shares (n, 3) of the nearest place to each wanted point in its triangle (n, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    u, v, w = b - a, c - a, wanted - a
    uu, uv, vv, wu, wv = ((p * q).sum(axis=1) for p, q in ((u, u), (u, v), (v, v), (w, u), (w, v)))
    double = np.maximum(uu * vv - uv**2, 1e-300)
    s, t = (vv * wu - uv * wv) / double, (uu * wv - uv * wu) / double
    inside = np.stack([1.0 - s - t, s, t], axis=1)
    best, found = np.full(len(wanted), np.inf), inside.copy()
    outside = inside.min(axis=1) < 0.0
    for first, second in ((0, 1), (1, 2), (2, 0)):
        along = corners[:, second] - corners[:, first]
        part = ((wanted - corners[:, first]) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300)
        part = np.clip(part, 0.0, 1.0)
        away = np.linalg.norm(corners[:, first] + part[:, None] * along - wanted, axis=1)
        better = outside & (away < best)
        best[better], found[better] = away[better], 0.0
        found[better, first], found[better, second] = 1.0 - part[better], part[better]
    return found


@dataclass(frozen=True)
class NewSkin:
    """The skin in its place."""

    points: FloatArray
    """Points of all nodes; those inside have not moved (n, 3) [mm]."""
    on_tool: BoolArray
    """(n_tools, n)."""
    offset: float
    """Offset by which free nodes were moved to give the volume back [mm]."""


def place_skin(
    body: OldBody, points: FloatArray, faces: IndexArray, in_plane: BoolArray, places: FacePlaces
) -> NewSkin:
    """Return the skin of a new mesh in its place.

    points: of all nodes of the new mesh (n, 3) [mm]; faces: its skin (k, 3); in_plane: coordinates of nodes that planes
    hold (n, 3); places: of the nodes of the skin, in order, on the old one. Raises MeshError where the volume cannot be
    given back.
    """
    skin = np.unique(faces)
    edges = list_edges(faces)
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    count = np.maximum(np.bincount(edges.ravel(), minlength=len(points)), 1)
    around = np.bincount(edges.ravel(), np.repeat(length, 2), len(points)) / count
    on_tool = np.zeros((len(body.obstacles), len(points)), dtype=bool)
    inside = np.zeros(len(points), dtype=bool)
    longest = float(length.max())
    for t, tool in enumerate(body.obstacles):
        corners = body.faces[places.face]
        touches = body.on_tool[t][corners]
        share = (touches * places.share).sum(axis=1)
        away = np.linalg.norm(body.points[corners] - points[skin][:, None], axis=2)
        end = np.where(touches, away, np.inf).min(axis=1)  # how far the contact's end is
        gap, _ = tool.touch(points[skin], longest)
        close = gap < np.minimum(STEEPEST * end + NEAR * around[skin], longest)
        on_tool[t, skin] = (share > 0.5 - 1e-6) & close | (gap < 0.0)
        inside[skin] |= gap < 0.0
    points = _put_on_tools(body, points, faces, on_tool, in_plane, inside, longest)
    points = _keep_sharp_edges(body.obstacles, points, edges, around, on_tool, in_plane)
    points = put_on_tools(points, body.obstacles, on_tool, in_plane, longest)  # sharp edges may be rounded a little
    return restore_volume(body, points, faces, on_tool, in_plane)


def _put_on_tools(
    body: OldBody,
    points: FloatArray,
    faces: IndexArray,
    on_tool: BoolArray,
    in_plane: BoolArray,
    inside: BoolArray,
    reach: float,
) -> FloatArray:
    """Return points with nodes in contact on their tools.

    Where a face would turn over, as beside the end of a contact at an edge of the body, its nodes that are not inside
    a tool (n,) stay where they are, and contact does not reach them: on_tool (n_tools, n) changes in place.
    """
    before = area_vectors(points, faces)
    for _ in range(_ROUNDS):
        placed = put_on_tools(points, body.obstacles, on_tool, in_plane, reach)
        after = area_vectors(placed, faces)
        cosine = np.einsum("ki,ki->k", before, after)
        sizes = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
        turned = np.unique(faces[cosine <= TURNED * sizes])
        moved = np.linalg.norm(placed[turned] - points[turned], axis=1) > 0.0
        back = turned[on_tool[:, turned].any(axis=0) & ~inside[turned] & moved]
        if not len(back):
            break
        on_tool[:, back] = False
    return placed


def _keep_sharp_edges(
    tools: Sequence[PlacedTool],
    points: FloatArray,
    edges: IndexArray,
    around: FloatArray,
    on_tool: BoolArray,
    in_plane: BoolArray,
) -> FloatArray:
    """Return points with the nearest nodes in contact moved onto the sharp edges that tools point into the metal."""
    result = points.copy()
    for tool, own in zip(tools, on_tool, strict=True):
        segments = tool.sharp_edges
        crossing = np.flatnonzero(own[edges].all(axis=1))
        if not len(segments) or not len(crossing):
            continue
        nodes = np.unique(edges[crossing])
        foot, away = nearest_on_segments(segments, result[nodes], float(around[nodes].max()))
        near = away < SNAP * around[nodes]
        near &= ~(in_plane[nodes] & (np.abs(foot - result[nodes]) > 1e-9 * around[nodes, None])).any(axis=1)
        order = np.flatnonzero(near)[np.argsort(away[near], kind="stable")]
        neighbours = _list_neighbours(edges, len(points))
        for number in order.tolist():  # the nearest first: of two beside each other one alone fits on the edge
            node = nodes[number]
            apart = np.linalg.norm(result[neighbours[node]] - foot[number], axis=1)
            if apart.min() > APART * around[node]:
                result[node] = foot[number]
    return result


def _list_neighbours(edges: IndexArray, n_points: int) -> list[IndexArray]:
    """Return the nodes at the other ends of the edges (m, 2) of each node."""
    both = np.concatenate([edges, edges[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    return np.split(both[:, 1], np.searchsorted(both[:, 0], np.arange(1, n_points)))


def nearest_on_segments(segments: FloatArray, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
    """Return the nearest places on segments (m, 2, 3) to points (n, 3), and how far they are; far ones are infinite."""
    foot, away = points.copy(), np.full(len(points), np.inf)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    near = cKDTree(segments.mean(axis=1)).query_ball_point(points, reach + 0.5 * float(length.max()))
    count = np.array([len(own) for own in near], dtype=np.intp)
    if not count.any():
        return foot, away
    owner, which = np.repeat(np.arange(len(points)), count), np.concatenate(near).astype(np.intp)
    begin, along = segments[which, 0], segments[which, 1] - segments[which, 0]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    part = np.clip(((points[owner] - begin) * along).sum(axis=1) / square, 0.0, 1.0)
    found = begin + part[:, None] * along
    distance = np.linalg.norm(found - points[owner], axis=1)
    order = np.lexsort((distance, owner))  # the nearest of each point comes first
    best = order[np.cumsum(count)[count > 0] - count[count > 0]]
    foot[owner[best]], away[owner[best]] = found[best], distance[best]
    return foot, away


def restore_volume(
    body: OldBody, points: FloatArray, faces: IndexArray, on_tool: BoolArray, in_plane: BoolArray
) -> NewSkin:
    """Return the skin with its free nodes offset along their normals, so that it holds the volume of the old one.

    Raises MeshError where no offset does that.
    """
    points, on_tool, total = points.copy(), on_tool.copy(), 0.0
    target, edges = body.volume * (1.0 + body.lost), list_edges(faces)
    edge = float(np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1).mean())
    skin = np.unique(faces)
    for _ in range(_ROUNDS):
        entered = _enter_tools(body, points, on_tool, in_plane, skin, edge)
        direction = _free_directions(points, faces, on_tool, in_plane)
        if not direction.any():
            break
        offset = _find_offset(points, faces, direction, target)
        points, total = points + offset * direction, total + offset
        if not entered and abs(enclosed_volume(points, faces) / target - 1.0) < 1e-12:
            break
    if not abs(total) <= LARGEST_OFFSET * edge:  # nor where it is no number, since the search has run away
        raise MeshError(
            f"an offset of {total:.3g} mm of the free surface would be needed to keep the volume", "smaller cells"
        )
    return NewSkin(points, on_tool, total)


def _enter_tools(
    body: OldBody, points: FloatArray, on_tool: BoolArray, in_plane: BoolArray, skin: IndexArray, edge: float
) -> bool:
    """Put nodes that lie inside tools onto them, in place; return whether there were any."""
    entered = np.zeros_like(on_tool)
    for t, tool in enumerate(body.obstacles):
        gap, _ = tool.touch(points[skin], edge)
        entered[t, skin] = (gap < 0.0) & ~on_tool[:, skin].any(axis=0)
    if entered.any():
        points[:] = put_on_tools(points, body.obstacles, entered, in_plane, edge)
        on_tool |= entered
    return bool(entered.any())


def _free_directions(points: FloatArray, faces: IndexArray, on_tool: BoolArray, in_plane: BoolArray) -> FloatArray:
    """Return the unit vectors along which nodes move outwards: none on tools, those in planes along these (n, 3)."""
    flat = np.zeros(len(faces), dtype=bool)
    for axis in range(3):
        flat |= in_plane[faces, axis].all(axis=1)
    normal = nodal_areas(points, faces, np.flatnonzero(~flat))
    normal[in_plane] = 0.0
    normal[on_tool.any(axis=0)] = 0.0
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def _find_offset(points: FloatArray, faces: IndexArray, direction: FloatArray, target: float) -> float:
    """Return the offset along a direction with which faces hold a volume [mm], by Newton's method."""
    offset = 0.0
    for _ in range(20):
        moved = points + offset * direction
        lack = target - enclosed_volume(moved, faces)
        slope = float(np.einsum("kj,kj->", area_vectors(moved, faces), direction[faces].mean(axis=1)))
        if slope <= 0.0 or abs(lack) < 1e-14 * target:
            break
        offset += lack / slope
    return offset
