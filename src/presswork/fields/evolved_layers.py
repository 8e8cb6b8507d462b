# SPDX-License-Identifier: Apache-2.0
"""What evolution laws keep at the layers of a sheet, as one number for each cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from presswork.formability import PATH_MARGINS
from presswork.model import CellBlock, FloatArray


def best_of_layers(blocks: Sequence[CellBlock], values: Sequence[FloatArray]) -> FloatArray:
    """Return the largest value through the thickness, its mean over the points in the plane (n_cells,).

    values: of each block (n_cells, q k), the k layers of a point one after the other; without rows where the material
    has no such law, whose cells have NaN.
    """
    parts = []
    for block, own in zip(blocks, values, strict=True):
        if len(own) == 0:
            parts.append(np.full(len(block.connectivity), np.nan))
            continue
        assert block.section is not None, "layers belong to shells"
        parts.append(own.reshape(len(own), -1, block.section.points).max(axis=2).mean(axis=1))
    return np.concatenate(parts)


def find_path_margins(
    blocks: Sequence[CellBlock], evolved: Mapping[str, Sequence[FloatArray]]
) -> dict[str, FloatArray]:
    """Return the least margins to the forming limit along the paths of a sheet's cells (n_cells,), those there are."""
    return {name: best_of_layers(blocks, evolved[name]) for name in PATH_MARGINS if name in evolved}
