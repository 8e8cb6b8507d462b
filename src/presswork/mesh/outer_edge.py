# SPDX-License-Identifier: Apache-2.0
"""The point of a flat sheet's edge that lies in a direction from the origin."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, IndexArray, Mesh

NEAR = 1e-9
"""How far a ray may pass beside the end of an edge and still meet it, over the edge's length."""


def find_outer_edge(mesh: Mesh, angle: float) -> tuple[IndexArray, FloatArray] | None:
    """Return the two nodes of the outermost edge that a ray at an angle from x [rad] meets, and their shares.

    The ray is drawn on the undeformed mesh. None: it meets no edge.
    """
    out, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    ends = mesh.boundary_edges[:, :2].astype(np.intp)
    places = mesh.points[ends][:, :, :2]
    off, along = places @ across, places @ out
    apart = off[:, 0] - off[:, 1]
    length = np.linalg.norm(places[:, 1] - places[:, 0], axis=1)
    crosses = np.abs(apart) > NEAR * length  # others run along the ray; their ends belong to other edges, too
    part = np.divide(off[:, 0], apart, out=np.full(len(ends), -1.0), where=crosses)
    at = (1.0 - part) * along[:, 0] + part * along[:, 1]
    met = np.flatnonzero(crosses & (part > -NEAR) & (part < 1.0 + NEAR) & (at > 0.0))
    if not len(met):
        return None
    outermost = met[np.argmax(at[met])]
    return ends[outermost], np.array([1.0 - part[outermost], part[outermost]])
