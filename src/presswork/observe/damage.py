# SPDX-License-Identifier: Apache-2.0
"""Where evolution laws have their largest values, and where a mean passes its critical value: there a crack begins."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswork.model import FloatArray, Mesh, Model
from presswork.observe.contract import Observed, Observer, Row
from presswork.observe.damage_length import find_lengths
from presswork.observe.neighbourhood import FormedBlock

DAMAGE = "damage_"
"""Beginning of the names of damage quantities in the history and the summary."""


@dataclass(frozen=True)
class Mean:
    """The largest mean over a neighbourhood of the material (observe/neighbourhood.py)."""

    value: float
    critical: float | None
    length: float
    """Radius of the neighbourhood [mm]."""
    cell: int
    """Cell in its middle, counted from 0 over all blocks."""
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
    """The largest of all means, or the one nearest to its critical value."""


class DamagePeaks(Observer):
    """The largest damage in the body by each criterion, at a point and as a mean over a neighbourhood."""

    def __init__(self, model: Model) -> None:
        """model: with the mesh that it has before forming."""
        self._model = model
        self._found: tuple[tuple[int, int], tuple[Peak, ...]] | None = None

    def columns(self, run: Observed) -> list[str]:
        """Return two for each criterion."""
        names = [name for name in run.evolved().critical if name.startswith(DAMAGE)]
        return [f"{name}{end}" for name in names for end in ("_max", "_mean_max")]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the largest values, wherever they are."""
        row: Row = {}
        peaks = self.find(run)
        evolved = run.evolved().values if peaks else {}
        for peak in peaks:
            row[f"{peak.name}_max"] = max(float(of.max()) for of in evolved[peak.name] if of.size)
            row[f"{peak.name}_mean_max"] = peak.mean.value
        return row

    @functools.cached_property
    def _lengths(self) -> list[float | None]:
        """Return for each block the radius over which the mean decides, where the material gives none [mm]."""
        return find_lengths(self._model)

    def find(self, run: Observed) -> tuple[Peak, ...]:
        """Return the peak of every damage; they are looked for once in an instant."""
        instant = run.number, run.epoch
        if self._found is None or self._found[0] != instant:
            evolved = run.evolved()
            found = find_peaks(run.model, run.mesh, run.positions(), evolved.values, evolved.critical, self._lengths)
            self._found = instant, found
        return self._found[1]


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
    none (observe/damage_length.py).
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
    chosen_length = None if chosen is None else chosen.length
    mean, middle, length = block.find_largest_mean(
        values.reshape(len(values), -1, layers).mean(axis=1),
        lengths[block.number] if chosen_length is None else chosen_length,
    )
    cell, point = (int(i) for i in np.unravel_index(int(np.argmax(values)), values.shape))
    place, around = (
        tuple(float(x) for x in block.position[of.connectivity[number]].mean(axis=0)) for number in (cell, middle)
    )
    found = Mean(mean, critical, length, first + middle, around)
    return Peak(name, float(values[cell, point]), critical, first + cell, point, place, found)
