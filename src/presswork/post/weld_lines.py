# SPDX-License-Identifier: Apache-2.0
"""Weld lines of a welded blank in its results."""

from __future__ import annotations

import numpy as np

from presswork.mesh.weld_edges import find_weld_edges
from presswork.model import IntArray
from presswork.results import Result


def find_welds(result: Result, step: int = -1) -> IntArray:
    """Return the edges along the weld lines of a saved step, as nodes (n, 2); none of other parts."""
    if not result.zones:
        return np.zeros((0, 2), dtype=np.int32)
    blocks = result.mesh_at(step).blocks
    first = np.cumsum([0, *(len(block.connectivity) for block in blocks[:-1])])
    zones = result.field("zone", step)[first].astype(int).tolist()
    kinds = [block.connectivity.astype(np.int32) for block in blocks]
    found = [find_weld_edges(kinds, zones, zone) for zone in sorted({*zones} - {0})]
    return np.concatenate([np.zeros((0, 2), dtype=np.int32), *found])
