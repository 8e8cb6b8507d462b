# SPDX-License-Identifier: Apache-2.0
"""The two faces that cut a sector out of a body of cyclic symmetry."""

from __future__ import annotations

import math

import numpy as np
import scipy

from presswork.mesh.checks import MeshError
from presswork.model import CyclicSector, FloatArray, IntArray, Mesh

SAME = 1e-6
"""How far a node may lie off the place of its partner, over the size of the body."""


def turn_of(cyclic: CyclicSector) -> FloatArray:
    """Return the rotation (3, 3) about z that takes the first face to the last."""
    angle = 2.0 * math.pi / cyclic.sectors
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def pair_faces(cyclic: CyclicSector, mesh: Mesh) -> tuple[IntArray, IntArray]:
    """Return the nodes of the first face and their partners on the last (n,). Raises MeshError."""
    first, last = mesh.node_sets[cyclic.first], mesh.node_sets[cyclic.last]
    size = float(np.ptp(mesh.points, axis=0).max())
    distance, partner = scipy.spatial.cKDTree(mesh.points[last]).query(mesh.points[first] @ turn_of(cyclic).T)
    if len(first) == len(last) and distance.max() < SAME * size and len(np.unique(partner)) == len(partner):
        return first, last[partner]
    angle = 360.0 / cyclic.sectors
    raise MeshError(
        f"turned by {angle:g} degrees about z, the {len(first)} nodes of `{cyclic.first}` do not lie on the "
        f"{len(last)} of `{cyclic.last}`; one is {distance.max():.3g} mm off",
        "mesh both faces alike, and name first the one from which the other comes by turning from x towards y",
    )


def count_sectors(mesh: Mesh, first: str, last: str) -> float:
    """Return a whole turn over the angle from one set of nodes about z to another."""
    angles = []
    for name in (first, last):
        x, y = mesh.points[mesh.node_sets[name], :2].mean(axis=0)
        angles.append(math.atan2(y, x))
    return 2.0 * math.pi / max((angles[1] - angles[0]) % (2.0 * math.pi), 1e-9)
