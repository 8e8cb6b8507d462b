# SPDX-License-Identifier: Apache-2.0
"""Contact stress where it acts on a tool in space: on the tool's surface, cut as finely as the workpiece's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.geometry.tool_surface import make_surface
from presswork.mesh.faces import split_faces
from presswork.model import FloatArray, IntArray, Triangulation
from presswork.post.skin import find_skin
from presswork.results import Result, ResultError

FINE = 0.5
"""Side of the tool's triangles, over the mean edge of the workpiece's skin."""
TOUCHING = 0.25
"""Distance from the skin, over that edge, up to which places of the tool have its contact stress; chords of rounds need
it."""
BESIDE = 2.0
"""Edges that are shown of the tool round the workpiece."""
_MOST_ROUNDS = 20


@dataclass(frozen=True)
class DieStress:
    """A tool's surface near the workpiece, and what presses on it."""

    corners: FloatArray
    """Corners of its triangles where it stands (n, 3, 3) [mm]."""
    pressure: FloatArray
    """Pressure on each triangle (n,) [MPa]; 0 where the workpiece does not touch it."""


def find_die_stress(result: Result, tool: str, step: int = -1) -> DieStress:
    """Return the contact pressure on the surface of a tool in space at a saved step.

    The pressure is the normal part of the saved contact traction, linear over each face of the skin. Raises
    ResultError for an unknown tool or step, and where the run holds no contact traction.
    """
    if tool not in result.surfaces:
        raise ResultError(f"{result.folder} has no tool {tool!r} in space; it has {', '.join(result.surfaces)}")
    own = f"contact_traction_{tool}"
    name = own if own in result.field_names else "contact_traction"
    if name not in result.field_names:
        raise ResultError(f"{result.folder} holds no contact stress")
    points, traction = result.points(step), result.field(name, step)
    faces = _triangulate_skin(result, step)
    skin = points[faces]
    edge = float(np.linalg.norm(np.roll(skin, -1, axis=1) - skin, axis=2).mean())
    low, high = skin.min(axis=(0, 1)) - BESIDE * edge, skin.max(axis=(0, 1)) + BESIDE * edge
    corners = _refine(result.placed_surface(tool, step)[result.surfaces[tool][1]], FINE * edge, low, high)
    middle = corners.mean(axis=1)
    gap, normal, place, face = make_surface(Triangulation(points, faces, True)).nearest(middle, TOUCHING * edge)
    touched = np.flatnonzero(np.isfinite(gap))
    share = _find_shares(skin[face[touched]], place[touched])
    pressed = np.einsum("nk,nki->ni", share, traction[faces[face[touched]]])
    pressure = np.zeros(len(corners))
    pressure[touched] = np.maximum(-np.einsum("ni,ni->n", pressed, normal[touched]), 0.0)
    return DieStress(corners, pressure)


def _triangulate_skin(result: Result, step: int) -> IntArray:
    """Return the outer faces of the workpiece as triangles (n, 3)."""
    skin, _ = find_skin(result.mesh_at(step))
    return np.ascontiguousarray(
        np.concatenate([split_faces(block.connectivity.astype(np.int32)) for block in skin.blocks]), dtype=np.int32
    )


def _refine(corners: FloatArray, longest: float, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the triangles (n, 3, 3) that reach into a box, halved until no side is longer than that."""
    done = []
    for _ in range(_MOST_ROUNDS):
        inside = ((corners.max(axis=1) > low) & (corners.min(axis=1) < high)).all(axis=1)
        corners = corners[inside]
        length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        long = length.max(axis=1) > longest
        done.append(corners[~long])
        corners, side = corners[long], length[long].argmax(axis=1)
        if not len(corners):
            break
        turned = corners[np.arange(len(corners))[:, None], (side[:, None] + np.arange(3)) % 3]
        a, b, c = turned.transpose(1, 0, 2)
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)


def _find_shares(corners: FloatArray, places: FloatArray) -> FloatArray:
    """Return the barycentric coordinates (n, 3) of places in triangles (n, 3, 3)."""
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], places - corners[:, 0]
    uu, uv, vv, wu, wv = ((p * q).sum(axis=1) for p, q in ((u, u), (u, v), (v, v), (w, u), (w, v)))
    double = np.maximum(uu * vv - uv**2, 1e-300)
    s, t = (vv * wu - uv * wv) / double, (uu * wv - uv * wu) / double
    return np.stack([1.0 - s - t, s, t], axis=1)
