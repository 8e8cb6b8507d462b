# SPDX-License-Identifier: Apache-2.0
"""Where evolution laws have their largest values, and where a mean passes its critical value: there a crack begins."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswork.model import FloatArray, Mesh, Model
from presswork.process.neighbourhood import FormedBlock

DAMAGE = "damage_"
"""Beginning of the names of quantities that the history and the summary tell."""


@dataclass(frozen=True)
class Mean:
    """The largest mean over a neighbourhood of the material (process/neighbourhood.py)."""

    value: float
    critical: float | None
    length: float
    """Radius of the neighbourhood [mm]."""
    cell: int
    """In its middle, counted from 0 over all blocks."""
    place: tuple[float, ...]
    """Centre of the cell [mm]."""

    @property
    def is_beyond(self) -> bool:
        """Whether the critical value is passed."""
        return self.critical is not None and self.value > self.critical


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
    mean: Mean
    """Of all means the largest, or the one nearest to its critical value."""


class LatestPeaks:
    """The peaks of the latest instant, for which the row of the history and the limits both ask."""

    def __init__(self) -> None:
        self._instant: Hashable = None
        self._peaks: tuple[Peak, ...] = ()

    def find(self, instant: Hashable, find: Callable[[], tuple[Peak, ...]]) -> tuple[Peak, ...]:
        """Return the peaks of an instant, found once."""
        if instant != self._instant:
            self._instant, self._peaks = instant, find()
        return self._peaks


def peak_columns(evolved: Mapping[str, object]) -> list[str]:
    """Return the columns of history.csv that tell the largest damage in the body, at a point and as a mean."""
    return [f"{name}{end}" for name in evolved if name.startswith(DAMAGE) for end in ("_max", "_mean_max")]


def peak_row(peaks: Sequence[Peak], evolved: Mapping[str, Sequence[FloatArray]]) -> dict[str, float]:
    """Return what these columns hold; evolved: as find_peaks takes it."""
    row = {}
    for peak in peaks:
        row[f"{peak.name}_max"] = max(float(of.max()) for of in evolved[peak.name] if of.size)
        row[f"{peak.name}_mean_max"] = peak.mean.value
    return row


def find_peaks(
    model: Model,
    mesh: Mesh,
    position: FloatArray,
    evolved: Mapping[str, Sequence[FloatArray]],
    critical: Mapping[str, Sequence[float | None]],
    lengths: Sequence[float | None],
) -> tuple[Peak, ...]:
    """Return the peak of every damage.

    mesh: its points where their material was when the run began; position: of the nodes now (n_points, 2 | 3) [mm];
    evolved: values at the points by quantity and block (n_cells, p), of shells the layers of a point one after the
    other; critical: the critical value in each block, by quantity; lengths: in each block, where the material gives
    none (process/damage_length.py).
    """
    peaks = []
    for name in (name for name in evolved if name.startswith(DAMAGE)):
        limits = critical[name] if any(limit is not None for limit in critical[name]) else [1.0] * len(mesh.blocks)
        of_blocks = [
            (
                _find_peak(FormedBlock(model, mesh, position, number), name, values, critical[name][number], lengths),
                limit,
            )
            for number, (values, limit) in enumerate(zip(evolved[name], limits, strict=True))
            if values.size and limit is not None
        ]
        peak, _ = max(of_blocks, key=lambda found: found[0].value / found[1])
        mean, _ = max(((found.mean, limit) for found, limit in of_blocks), key=lambda found: found[0].value / found[1])
        peaks.append(replace(peak, mean=mean))
    return tuple(peaks)


def _find_peak(
    block: FormedBlock, name: str, values: FloatArray, critical: float | None, lengths: Sequence[float | None]
) -> Peak:
    """Return the peak of a block's values (n_cells, p)."""
    of = block.mesh.blocks[block.number]
    first = sum(len(each.connectivity) for each in block.mesh.blocks[: block.number])
    layers, chosen = 1 if of.section is None else of.section.points, block.model.materials[of.material].damage
    given = None if chosen is None else chosen.length
    mean, middle, length = block.find_largest_mean(
        values.reshape(len(values), -1, layers).mean(axis=1), lengths[block.number] if given is None else given
    )
    cell, point = (int(i) for i in np.unravel_index(int(np.argmax(values)), values.shape))
    place, around = (
        tuple(float(x) for x in block.position[of.connectivity[number]].mean(axis=0)) for number in (cell, middle)
    )
    found = Mean(mean, critical, length, first + middle, around)
    return Peak(name, float(values[cell, point]), critical, first + cell, point, place, found)
