# SPDX-License-Identifier: Apache-2.0
"""Metal that has flowed past the end of a tool's profile: nothing holds it there, and its cells fold round the end."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from presswork.model import BoolArray, FloatArray, IntArray

NEAR = 0.1
"""Distance of the end of a profile from an edge of the workpiece, over the edge's length."""


def explain_passed_ends(
    profiles: Mapping[str, FloatArray], points: FloatArray, edges: IntArray, held: BoolArray
) -> list[str]:
    """Return a sentence for each end of a tool's profile that lies on the workpiece's boundary.

    profiles: segments by name, where the tools stand; points (n_points, 2) [mm]; edges: of the boundary (n_edges, 2);
    held (n_points,): nodes of symmetry planes and other supports, beside which a profile may well end.
    """
    start, along = points[edges[:, 0]], points[edges[:, 1]] - points[edges[:, 0]]
    length = np.linalg.norm(along, axis=1)
    found = []
    for name, segments in profiles.items():
        for end in (segments[0, :2], segments[-1, 2:4]):
            part = np.clip(((end - start) * along).sum(axis=1) / length**2, 0.0, 1.0)
            distance = np.linalg.norm(start + part[:, None] * along - end, axis=1) / length
            nearest = int(np.argmin(distance))
            if distance[nearest] < NEAR and not held[edges[nearest, :2]].any():
                found.append(
                    f"the profile of {name} ends on the metal, at ({end[0]:.4g}, {end[1]:.4g}) mm: extend the profile"
                )
    return found
