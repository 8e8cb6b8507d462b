# SPDX-License-Identifier: Apache-2.0
"""The axes of laws on a new mesh: directions that were fitted one value at a time become directions again."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray


def straighten_axes(values: FloatArray) -> FloatArray:
    """Return the nearest axes of laws to fitted ones (..., 2 | 6): x in the plane, x and y in space.

    In the plane x gets its length back. In space x and y become the pair of unit vectors at right angles that is
    nearest in least squares: the orthogonal factor of the polar decomposition of the matrix with columns x and y.
    """
    if values.shape[-1] == 2:
        length = np.linalg.norm(values, axis=-1, keepdims=True)
        return np.asarray(values / np.where(length > 0.0, length, 1.0))
    left, _, right = np.linalg.svd(values.reshape(*values.shape[:-1], 2, 3), full_matrices=False)
    return np.asarray((left @ right).reshape(values.shape))
