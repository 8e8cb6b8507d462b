# SPDX-License-Identifier: Apache-2.0
"""Directors of a model's shells: where symmetry planes lay them, which rotations are drilling, how they turn."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.mesh.directors import Directors, find_directors
from presswork.model import BoolArray, FloatArray, Model


def find_model_directors(model: Model) -> Directors:
    """Return the directors of the undeformed mesh; on symmetry planes they lie in the plane."""
    blocks = model.mesh.blocks
    slopes = [_core.shell_shape(b.element)[3] for b in blocks]
    found = find_directors(model.mesh.points, blocks, slopes, model.mesh.normals)
    lay_directors(model, found, found.vectors)
    return found


def lay_directors(model: Model, directors: Directors, vectors: FloatArray) -> None:
    """Lay vectors (n_directors, 3) of directors at nodes on symmetry planes into these, and give all the length one."""
    for support in model.lasting_supports:
        if all(support.fix[:3]):
            continue  # a clamp, not a plane
        for normal in range(3):
            others = [3 + (normal + 1) % 3, 3 + (normal + 2) % 3]
            if not (support.fix[normal] and all(support.fix[r] for r in others)):
                continue
            on_plane = np.isin(directors.node, model.mesh.node_sets[support.node_set])
            on_plane &= directors.smooth[directors.node]
            on_plane &= np.abs(vectors[:, normal]) < 0.5  # not where the plane holds the sheet's face
            vectors[on_plane, normal] = 0.0
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)


def find_drilling(directors: Directors) -> BoolArray:
    """Mark the freedoms that are drilling rotations, prescribed all through a run (n_points * 6,).

    A smooth node's is the first rotation in the node's own frame (interaction/supports.py).
    """
    drilling = np.zeros((len(directors.smooth), 6), dtype=bool)
    turning = directors.node[directors.smooth[directors.node]]
    drilling[turning, 3] = True
    return drilling.reshape(-1)


def turn_vectors(theta: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return vectors (n, 3) turned by rotation vectors (n, 3)."""
    square = (theta**2).sum(axis=1, keepdims=True)
    angle = np.sqrt(square)
    a = np.sinc(angle / np.pi)
    b = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    cross = np.cross(theta, vectors)
    along = (theta * vectors).sum(axis=1, keepdims=True)
    turned: FloatArray = vectors + a * cross + b * (along * theta - square * vectors)
    return turned
