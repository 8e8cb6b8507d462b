# SPDX-License-Identifier: Apache-2.0
"""Where evolution laws have their largest values, and where one passes its critical value: there a crack begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, Mesh

DAMAGE = "damage_"
"""Beginning of the names of quantities that the history and the summary tell."""


@dataclass(frozen=True)
class Peak:
    """The largest value of a quantity in the body, or, where there are critical values, the one nearest to its own."""

    name: str
    value: float
    critical: float | None
    cell: int
    """Counted from 0 over all blocks."""
    point: int
    """Counted from 0 in the cell."""
    place: tuple[float, ...]
    """Centre of the cell [mm]."""

    @property
    def is_beyond(self) -> bool:
        """Whether the critical value is passed."""
        return self.critical is not None and self.value > self.critical


def peak_columns(evolved: Mapping[str, object]) -> list[str]:
    """Return the columns of history.csv that tell the largest damage in the body."""
    return [f"{name}_max" for name in evolved if name.startswith(DAMAGE)]


def peak_row(evolved: Mapping[str, Sequence[FloatArray]]) -> dict[str, float]:
    """Return what these columns hold."""
    return {
        f"{name}_max": max(float(of.max()) for of in blocks if of.size)
        for name, blocks in evolved.items()
        if name.startswith(DAMAGE)
    }


def find_peaks(
    mesh: Mesh,
    position: FloatArray,
    evolved: Mapping[str, Sequence[FloatArray]],
    critical: Mapping[str, Sequence[float | None]],
) -> tuple[Peak, ...]:
    """Return the peak of every damage.

    position: of the nodes now (n_points, 2 | 3) [mm]; evolved: values at the points by quantity and block (n_cells, p);
    critical: the critical value in each block, by quantity.
    """
    return tuple(
        _find_peak(mesh, position, name, blocks, critical[name])
        for name, blocks in evolved.items()
        if name.startswith(DAMAGE)
    )


def _find_peak(
    mesh: Mesh, position: FloatArray, name: str, blocks: Sequence[FloatArray], critical: Sequence[float | None]
) -> Peak:
    judged = any(limit is not None for limit in critical)
    first = np.cumsum([0, *(len(block.connectivity) for block in mesh.blocks)])
    best: tuple[float, Peak] | None = None
    for number, (values, limit) in enumerate(zip(blocks, critical, strict=True)):
        if values.size == 0 or (judged and limit is None):
            continue
        cell, point = (int(i) for i in np.unravel_index(int(np.argmax(values)), values.shape))
        value = float(values[cell, point])
        share = value / limit if limit is not None else value
        if best is None or share > best[0]:
            place = position[mesh.blocks[number].connectivity[cell]].mean(axis=0)
            best = share, Peak(name, value, limit, int(first[number]) + cell, point, tuple(float(x) for x in place))
    assert best is not None, "a quantity belongs to a block"
    return best[1]
