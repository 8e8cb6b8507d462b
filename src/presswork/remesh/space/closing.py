# SPDX-License-Identifier: Apache-2.0
"""Whether the surface of a body in space is about to fold onto itself."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.model import FloatArray, IntArray, find_cell
from presswork.remesh.triggers import AHEAD, CLOSED, FACES

SOUGHT = 1.5
"""Distance, over the mean side of a face, within which closing faces are searched; faces farther off close later than
the next increments."""


def find_closing_faces(points: FloatArray, moves: FloatArray, faces: IntArray) -> FloatArray | None:
    """Return where a free surface is about to fold onto itself (3,) [mm]; None: nowhere.

    points: of the nodes (n_points, 3) [mm]; moves: of them in the last increment, in the same form; faces: of a body,
    wound outwards (n, 3 | 4). A face counts where its distance outwards to a face that faces it will be less than
    CLOSED of its side after AHEAD increments like the last.
    """
    x = points[faces]
    side = np.linalg.norm(np.roll(x, -1, axis=1) - x, axis=2).mean(axis=1)
    faces = np.ascontiguousarray(faces, dtype=np.int32)
    pairs = _core.find_face_pairs(faces, faces, np.ascontiguousarray(points), SOUGHT * float(side.mean()), True)
    if not len(pairs):
        return None
    (a, b), (c, d) = find_cell(2, faces).spans
    normal = np.cross(x[:, b] - x[:, a], x[:, d] - x[:, c])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    middle, moved = x.mean(axis=1), moves[faces].mean(axis=1)
    own, other = np.concatenate([pairs, pairs[:, ::-1]]).T
    cosine = (normal[own] * normal[other]).sum(axis=1)
    away = middle[other] - middle[own]
    facing = cosine < FACES
    gap = np.where(facing, (away * normal[other]).sum(axis=1) / np.where(facing, cosine, 1.0), np.inf)
    # where the way outwards meets the plane of the other face: within a circle round its middle that has its size
    beside = np.linalg.norm(np.where(facing, gap, 0.0)[:, None] * normal[own] - away, axis=1)
    meets = facing & (gap > 0.0) & (beside < 0.5 * side[other])
    closing = ((moved[other] - moved[own]) * normal[own]).sum(axis=1)
    expected = np.where(meets & (closing < 0.0), (gap + AHEAD * closing) / side[own], np.inf)
    worst = int(np.argmin(expected))
    return np.asarray(middle[own[worst]]) if expected[worst] < CLOSED else None
