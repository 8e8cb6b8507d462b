# SPDX-License-Identifier: Apache-2.0
"""Defects of a sheet's surface, from the bending of its shells: folds, and places that were bent and straightened.

The bending strain is half the difference of the strains at top and bottom. A fold is a wave: along the lines on which
its middle is compressed, the sheet bends to one side between two places where it bends as much to the other. A tool, a
wall or a round corner bends it to one side there, or, from punch to die, to one side and then to the other. The least
of the three bending strains, where no tool touches, is the amplitude of the fold. Its ratio to the compressive strain
shows how much of the compression has gone into folding: below 0.2 in flat flanges, above 1 where the sheet has folded
freely. Symmetry planes are looked through, so that a quarter has the folds of the whole part.

Faces that were bent and straightened have more plastic strain than the middle, and are not bent: the mean of the faces'
equivalent plastic strain, less that of the middle and of the present bending.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
import scipy

from presswork import _core
from presswork.model import BoolArray, CellBlock, FloatArray

STRAIGHTENED, FOLD, SIDE = "straightened_strain", "fold_ratio", "fold_side"
SURFACE_FIELDS = (STRAIGHTENED, FOLD, SIDE)
FOLDED = 0.3
"""Fold ratio from which a shell counts as folded."""
REACH = 20.0
"""Length of a line of compression, to either side, over the thickness."""
PLACES = 20
"""Number of places on that length."""
LEAST_HEIGHT = 0.05
"""Height of a wave over the thickness, from its middle line to its crest, below which it is no fold. Coarse shells on a
round tool ripple by less."""
PLANE = 1e-6
"""Distance of a node from a symmetry plane, over the sheet's size, up to which it lies in it."""
LEAST_COMPRESSION = 0.02
"""Compressive strain below which the fold ratio is over this: walls that are hardly compressed bend a little, too."""
YIELDED = 0.002
"""Compressive strain below which a shell does not fold: a middle that has not yielded is compressed along no direction.
The section of a low wall, bent over punch and die to either side, would be a fold otherwise."""
TOUCHED = 1e-6
"""Part of the largest force of tools on a node above which a node is touched."""
NEEDED = {"strain_bottom", "strain_middle", "strain_top", "equivalent_plastic_strain_middle"}
"""Quantities of a sheet that bends."""


class Cells(Protocol):
    """Cells of one kind: of a mesh, or as a results file has them."""

    @property
    def connectivity(self) -> npt.NDArray[np.integer[Any]]:
        """Their nodes (n_cells, n_nodes)."""


def surface_fields(
    sheet: Mapping[str, FloatArray],
    blocks: Sequence[CellBlock],
    points: FloatArray,
    tool_force: FloatArray | None,
    symmetry: tuple[bool, bool] = (False, False),
) -> dict[str, FloatArray]:
    """Return SURFACE_FIELDS (n_cells,) of a sheet's cells.

    sheet: quantities of the cells by name, NEEDED among them; points (n_points, 3): deformed [mm]; tool_force: on the
    nodes (n_points, 3) [N], None without tools; symmetry: whether x = 0 and y = 0 mirror the sheet.
    """
    touched = np.zeros(len(points), dtype=bool)
    if tool_force is not None:
        size = np.linalg.norm(tool_force, axis=1)
        touched = size > TOUCHED * size.max(initial=0.0)
    ratio, side = find_folds(sheet, blocks, points, touched, symmetry)
    return {STRAIGHTENED: find_straightened(sheet), FOLD: ratio, SIDE: side}


def find_straightened(sheet: Mapping[str, FloatArray]) -> FloatArray:
    """Return the plastic strain of bending that was undone (n_cells,)."""
    bottom, middle, top = (sheet[f"equivalent_plastic_strain_{place}"] for place in ("bottom", "middle", "top"))
    present = 0.5 * (sheet["strain_top"] - sheet["strain_bottom"])
    normal, shear = present[:, :3], present[:, 3:]
    # von Mises' strain of an incompressible sheet: the thickness takes the trace
    square = (normal**2).sum(axis=1) + normal.sum(axis=1) ** 2 + 2.0 * (shear**2).sum(axis=1)
    return np.asarray(np.maximum(0.5 * (bottom + top) - middle - np.sqrt(2.0 / 3.0 * square), 0.0))


def find_folds(
    sheet: Mapping[str, FloatArray],
    blocks: Sequence[CellBlock],
    points: FloatArray,
    touched: BoolArray,
    symmetry: tuple[bool, bool] = (False, False),
) -> tuple[FloatArray, FloatArray]:
    """Return the amplitude of waves over the compression (n_cells,), and the side that folded cells are bent to.

    The side is 1 or -1, and 0 of cells that are not folded. Arguments as surface_fields; touched (n_points,).
    """
    corners = [block.connectivity.T for block in blocks]
    centre = np.concatenate([points[c].mean(axis=0) for c in corners])
    free = np.concatenate([~touched[c].any(axis=0) for c in corners])
    values, vectors = np.linalg.eigh(_tensor(sheet["strain_middle"]))
    compressed = values[:, 0] < -YIELDED
    along = np.where(compressed[:, None], vectors[:, :, 0], 0.0)
    own = np.flatnonzero(free & compressed)
    ratio, side = np.zeros(len(centre)), np.zeros(len(centre))
    if len(own) == 0:
        return ratio, side

    size = np.concatenate([np.ptp(points[c], axis=0).max(axis=1) for c in corners])[own]
    thickness = sheet["thickness"][own]
    bending = 0.5 * (sheet["strain_top"] - sheet["strain_bottom"])
    bending[~free] = 0.0  # by the tool's shape
    centre, bending, along = _mirror(centre, bending, along, symmetry)
    amplitude, bent = _core.find_sheet_waves(
        centre, bending, along, own.astype(np.int32), REACH / PLACES * thickness, size, thickness,
        n_places=PLACES, least_height=LEAST_HEIGHT,
    )  # fmt: skip
    ratio[own] = amplitude / np.maximum(-values[own, 0], LEAST_COMPRESSION)
    side[own] = np.where(ratio[own] > FOLDED, np.sign(bent), 0.0)
    return ratio, side


def count_folds(
    side: FloatArray, blocks: Sequence[Cells], points: FloatArray, symmetry: tuple[bool, bool] = (False, False)
) -> int:
    """Return the number of folds of the whole part.

    A fold is a wave: connected shells of one side, its crest, beside those of the other, its trough. side (n_cells,):
    as find_folds returns it; points (n_points, 3) [mm]. A fold that a symmetry plane cuts counts once.
    """
    if not side.any():
        return 0
    near = PLANE * np.ptp(points, axis=0).max()
    in_plane = [np.abs(points[:, axis]) < near for axis in (0, 1) if symmetry[axis]]
    found = []
    for sign in (1.0, -1.0):
        cells = [b.connectivity[s == sign] for b, s in zip(blocks, _by_block(side, blocks), strict=True)]
        cell = np.concatenate([np.repeat(np.arange(len(c)), c.shape[1]) + sum(map(len, cells[:i]))
                               for i, c in enumerate(cells)])  # fmt: skip
        node = np.concatenate([c.ravel() for c in cells])
        n = sum(map(len, cells))
        graph = scipy.sparse.coo_array((np.ones(len(cell)), (cell, n + node)), shape=(n + len(points),) * 2)
        label = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
        groups = np.unique(label[:n])
        found.append(sum(int(np.prod([1 if plane[node[label[cell] == g]].any() else 2 for plane in in_plane]))
                         for g in groups))  # fmt: skip
    return max(1, min(found))


def _by_block(values: FloatArray, blocks: Sequence[Cells]) -> list[FloatArray]:
    return np.split(values, np.cumsum([len(block.connectivity) for block in blocks])[:-1])


def _mirror(
    centre: FloatArray, bending: FloatArray, along: FloatArray, symmetry: tuple[bool, bool]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return centres, bending and directions of the cells with their images, which come behind."""
    for axis in (0, 1):
        if symmetry[axis]:
            flip = np.where(np.arange(3) == axis, -1.0, 1.0)
            shears = flip[[0, 1, 0]] * flip[[1, 2, 2]]
            centre, along = (np.concatenate([v, v * flip]) for v in (centre, along))
            bending = np.concatenate([bending, bending * np.concatenate([np.ones(3), shears])])
    return centre, bending, along


def _tensor(voigt: FloatArray) -> FloatArray:
    """Return symmetric tensors (n, 3, 3) of xx, yy, zz, xy, yz, xz (n, 6)."""
    return np.asarray(voigt[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]])
