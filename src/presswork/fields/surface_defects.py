# SPDX-License-Identifier: Apache-2.0
"""Defects of a sheet's surface, from the bending of its shells: folds, and places that were bent and straightened.

The bending strain is half the difference of the strains at top and bottom. A fold bends the sheet to both sides along
the direction in which its middle is compressed most; a tool, a wall or a round corner bends it to one side there. So
the smaller of the largest bending strains to either side, within REACH on the line along that direction, is the
amplitude of the fold. Over the compressive strain it tells how much of the compression has gone into folding: below
0.2 in flat flanges, above 1 where the sheet has folded freely. Shells that a tool touches have none: there its shape
decides.

Faces that were bent and straightened have more plastic strain than the middle, and are not bent: the mean of the faces'
equivalent plastic strain, less that of the middle and of the present bending.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from presswork import _core
from presswork.model import BoolArray, CellBlock, FloatArray

STRAIGHTENED, FOLD = "straightened_strain", "fold_ratio"
SURFACE_FIELDS = (STRAIGHTENED, FOLD)
FOLDED = 0.3
"""Fold ratio from which a shell counts as folded."""
REACH = 15.0
"""Distance along which folds are looked for, to either side, over the thickness."""
STEPS = 12
"""Places on that distance."""
LEAST_COMPRESSION = 0.02
"""Compressive strain below which the fold ratio is over this: walls that are hardly compressed bend a little, too."""
YIELDED = 0.002
"""Compressive strain below which a shell does not fold: a middle that has not yielded is compressed along no direction.
The section of a low wall, bent over punch and die to either side, would be a fold otherwise."""
TOUCHED = 1e-6
"""Part of the largest force of tools on a node above which a node is touched."""
NEEDED = {"strain_bottom", "strain_middle", "strain_top", "equivalent_plastic_strain_middle"}
"""Quantities of a sheet that bends."""


def surface_fields(
    sheet: Mapping[str, FloatArray], blocks: Sequence[CellBlock], points: FloatArray, tool_force: FloatArray | None
) -> dict[str, FloatArray]:
    """Return SURFACE_FIELDS (n_cells,) of a sheet's cells.

    sheet: quantities of the cells by name, NEEDED among them; points (n_points, 3): deformed [mm]; tool_force: on the
    nodes (n_points, 3) [N], None without tools.
    """
    touched = np.zeros(len(points), dtype=bool)
    if tool_force is not None:
        size = np.linalg.norm(tool_force, axis=1)
        touched = size > TOUCHED * size.max(initial=0.0)
    return {STRAIGHTENED: find_straightened(sheet), FOLD: find_fold_ratio(sheet, blocks, points, touched)}


def find_straightened(sheet: Mapping[str, FloatArray]) -> FloatArray:
    """Return the plastic strain of bending that was undone (n_cells,)."""
    bottom, middle, top = (sheet[f"equivalent_plastic_strain_{place}"] for place in ("bottom", "middle", "top"))
    present = 0.5 * (sheet["strain_top"] - sheet["strain_bottom"])
    normal, shear = present[:, :3], present[:, 3:]
    # von Mises' strain of an incompressible sheet: the thickness takes the trace
    square = (normal**2).sum(axis=1) + normal.sum(axis=1) ** 2 + 2.0 * (shear**2).sum(axis=1)
    return np.asarray(np.maximum(0.5 * (bottom + top) - middle - np.sqrt(2.0 / 3.0 * square), 0.0))


def find_fold_ratio(
    sheet: Mapping[str, FloatArray], blocks: Sequence[CellBlock], points: FloatArray, touched: BoolArray
) -> FloatArray:
    """Return the amplitude of bending along the most compressed direction over the compression (n_cells,)."""
    corners = [block.connectivity.T for block in blocks]
    centre = np.concatenate([points[c].mean(axis=0) for c in corners])
    free = np.flatnonzero(np.concatenate([~touched[c].any(axis=0) for c in corners]))
    values, vectors = np.linalg.eigh(_tensor(sheet["strain_middle"][free]))
    folds = values[:, 0] < -YIELDED
    own, compressed, along = free[folds], values[folds, 0], vectors[folds, :, 0]
    ratio = np.zeros(len(centre))
    if len(own) == 0:
        return ratio

    size = np.concatenate([np.ptp(points[c], axis=0).max(axis=1) for c in corners])[own]
    outwards = np.arange(1, STEPS + 1) / STEPS
    way = np.concatenate([outwards, -outwards]) * REACH * sheet["thickness"][own, None]
    far = np.maximum(size[:, None], 0.35 * np.abs(way))  # beyond the edge of the sheet
    bending = 0.5 * (sheet["strain_top"] - sheet["strain_bottom"])
    up, down = _core.find_bending_along(centre, bending, own.astype(np.int32), along, way, far)
    ratio[own] = np.minimum(up, down) / np.maximum(-compressed, LEAST_COMPRESSION)
    return ratio


def _tensor(voigt: FloatArray) -> FloatArray:
    """Return symmetric tensors (n, 3, 3) of xx, yy, zz, xy, yz, xz (n, 6)."""
    return np.asarray(voigt[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]])
