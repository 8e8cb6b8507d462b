# SPDX-License-Identifier: Apache-2.0
"""When to mesh anew: before the mesh is of no more use."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from presswork import _core
from presswork.geometry.profile_path import ProfilePath
from presswork.model import FloatArray, IndexArray, find_cell
from presswork.remesh.fill import SizeField, measure_quality

TOO_LONG = 1.5
"""Edge on the boundary over the size wanted there."""
CLOSED, AHEAD = 0.25, 2.0
"""Gap between sides of one outline over their length, and the increments ahead, at which it counts as closing."""
FEW, MORE = 2.5, 1.2
"""Cells across the metal that count as fewer than three, and the factor that a new mesh must gain."""
FACES = -0.5
"""Product of the normals of sides that face each other, at most."""
TOO_DEEP = 0.08
"""Depth to which a tool cuts an edge, over its length."""


def find_flat_cell(position: FloatArray, increment: FloatArray, cells: IndexArray, least: float) -> str | None:
    """Describe the cell that will be flat after another increment like the last (n_points, 2) [mm], or is now."""
    expected = np.minimum(measure_quality(position, cells), measure_quality(position + increment, cells))
    worst = int(np.argmin(expected))
    if expected[worst] >= least:
        return None
    x, y = position[cells[worst]].mean(axis=0)
    return f"a cell near ({x:.4g}, {y:.4g}) of quality {expected[worst]:.2g} after the next increment"


def find_long_edge(line: FloatArray, size: SizeField, *, longest: float = TOO_LONG) -> str | None:
    """Describe an edge of a closed line (n, 2) that is too long for the tools ahead of it or the metal beneath it."""
    after = np.roll(line, -1, axis=0)
    middle = 0.5 * (line + after)
    ratio = np.linalg.norm(after - line, axis=1) / size(middle)
    worst = int(np.argmax(ratio))
    if ratio[worst] <= longest:
        return None
    x, y = middle[worst]
    return f"an edge {ratio[worst]:.2g} times too long near ({x:.4g}, {y:.4g})"


def find_cut_edge(
    line: FloatArray, profiles: Sequence[FloatArray], *, deepest: float = TOO_DEEP, corners_count: bool = False
) -> str | None:
    """Describe an edge of a closed line (n, 2) that lies too deep in a tool between its nodes.

    Round a sharp corner of a tool every edge does, until its node behind has passed: unless corners_count, only its
    length counts there.
    """
    after = np.roll(line, -1, axis=0)
    middle = np.ascontiguousarray(0.5 * (line + after))
    length = np.linalg.norm(after - line, axis=1)
    for profile in profiles:
        gap, *_ = _core.touch_profile(np.ascontiguousarray(profile), middle)
        path = ProfilePath(profile)
        corners, turns = path.corners()
        depth = np.where(gap < -deepest * length, -gap / length, 0.0)
        if (turns < 0.0).any() and not corners_count:
            apart, _ = scipy.spatial.cKDTree(path.at(corners[turns < 0.0])).query(middle)
            depth[apart < 0.75 * length] = 0.0
        worst = int(np.argmax(depth))
        if depth[worst] > 0.0:
            x, y = middle[worst]
            return f"a tool {-gap[worst]:.2g} mm deep in an edge near ({x:.4g}, {y:.4g})"
    return None


def find_closing_gap(sides: FloatArray, moves: FloatArray) -> FloatArray | None:
    """Return where a free outline is about to fold onto itself (2,) [mm]; None: nowhere.

    sides: of a body, the metal on their left (k, 2, 2) [mm]; moves: of their ends in the last increment, in the same
    form. A side counts whose distance outwards to the nearest side that faces it will be less than CLOSED of its length
    after AHEAD increments like the last.
    """
    line, along = sides[:, 0], sides[:, 1] - sides[:, 0]
    length = np.linalg.norm(along, axis=1)
    outwards = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    middle, moved = sides.mean(axis=1), moves.mean(axis=1)
    cross = outwards[:, None, 0] * along[None, :, 1] - outwards[:, None, 1] * along[None, :, 0]
    away = line[None] - middle[:, None]
    faces = outwards @ outwards.T < FACES
    safe = np.where(faces, cross, np.inf)
    gap = (away[..., 0] * along[None, :, 1] - away[..., 1] * along[None, :, 0]) / safe
    part = (away[..., 0] * outwards[:, None, 1] - away[..., 1] * outwards[:, None, 0]) / safe
    gap = np.where(faces & (gap > 0.0) & (part >= 0.0) & (part <= 1.0), gap, np.inf)
    shares = (sides[:, None, 1] == sides[None, :, 0]).all(axis=-1)
    gap[shares | shares.T] = np.inf
    nearest = gap.argmin(axis=1)
    closing = ((moved[nearest] - moved) * outwards).sum(axis=1)
    expected = (gap[np.arange(len(gap)), nearest] + AHEAD * np.minimum(closing, 0.0)) / length
    worst = int(np.argmin(np.where(closing < 0.0, expected, np.inf)))
    return np.asarray(middle[worst]) if closing[worst] < 0.0 and expected[worst] < CLOSED else None


def count_across(
    sides: FloatArray, cells: IndexArray, edges: IndexArray, position: FloatArray, thickness: FloatArray
) -> FloatArray:
    """Return how many cells of the size of the one behind it lie across the metal from each side of an outline (k,).

    sides: (k, 2, 2) [mm]; cells: corners (n_cells, 3 | 4); edges: the nodes of the sides (k, 2); position: of the nodes
    (n_points, 2) [mm]; thickness: of the metal behind the sides (k,) [mm].
    """
    n, corners = len(position), cells.shape[1]
    keys = (cells * n + np.roll(cells, -1, axis=1)).ravel()
    order = np.argsort(keys)
    own = order[np.searchsorted(keys[order], edges[:, 0] * n + edges[:, 1])] // corners
    x, y = np.moveaxis(position[cells[own]], -1, 0)
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
    length = np.linalg.norm(sides[:, 1] - sides[:, 0], axis=1)
    height = area / length * (2.0 if find_cell(2, cells).is_simplex else 1.0)
    return np.asarray(thickness / height)


def find_few_across(sides: FloatArray, across: FloatArray, wanted: FloatArray, *, wait: float = 1.0) -> str | None:
    """Describe where fewer than three cells lie across the metal, though the requested size has more.

    sides: of an outline (k, 2, 2) [mm]; across, wanted: cells across the metal behind each, as they are and with the
    size asked for (k,). Rows of unequal height count as three down to FEW; a new mesh must add a fifth.
    """
    few = (across < FEW / wait) & (np.minimum(wanted, 3.0) > MORE * across)
    if not few.any():
        return None
    worst = int(np.argmin(np.where(few, across, np.inf)))
    x, y = sides[worst].mean(axis=0)
    return f"{across[worst]:.2g} cells across the metal near ({x:.4g}, {y:.4g})"
