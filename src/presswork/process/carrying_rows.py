# SPDX-License-Identifier: Apache-2.0
"""The state of an explicit run on a new mesh: what its dump has, block by block and body by body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.evolution.of_material import BY_NAME
from presswork.model import FloatArray, Mesh
from presswork.remesh.carrier import Carrier, Part

OF_THE_RUN = ("loop.work", "run.clock", "run.energy", "run.scales")
OF_A_WALL = ("offset", "angle", "floating", "impulse")
BEGIN_ANEW = ("mass_factor", "hourglass", "force", "pressure")
"""Names in a dump of explicit solids: what goes along, and what begins anew in cells of a new mesh."""


@dataclass(frozen=True)
class MadeMesh:
    """A mesh on which some bodies have new cells, and others those that they had."""

    mesh: Mesh
    """Its points where those of each body were when its mesh began: of a new one, where they are now."""
    position: FloatArray
    """Where its nodes are now (n_points, d) [mm]."""
    parts: Sequence[Part]
    """What becomes of each body."""
    faults: Sequence[str] = ()
    """Why bodies that were to get new cells have none."""

    @property
    def lines(self) -> list[FloatArray]:
        """At which folds were left out."""
        return [seam for part in self.parts for seam in part.seams]

    @property
    def is_new(self) -> list[bool]:
        """Which bodies have new cells."""
        return [part.surface is not None for part in self.parts]


def carry_cells(carrier: Carrier, block: int, values: FloatArray, n_cells: int) -> FloatArray:
    """Return values of a block's old cells (n, ...), one point each, in its n_cells new ones."""
    if not values.size:
        return np.zeros((n_cells, *values.shape[1:]))
    given, rest = values[:, None], np.zeros((n_cells, 1, *values.shape[1:]))
    found = carrier.points(*(_in_row(carrier, block, own) for own in (given, rest)))
    return found[block][:, 0]


def keep_peaks(
    carrier: Carrier, block: int, name: str, values: FloatArray, found: FloatArray, volumes: FloatArray
) -> FloatArray:
    """Return a field carried by carry_cells from values of old cells (n, ...) with the peaks that it had.

    volumes: of the new cells (n_cells,).
    """
    rows = (_in_row(carrier, block, own) for own in (values.reshape(-1, 1), found.reshape(-1, 1), volumes[:, None]))
    return carrier.peaks(name, *rows)[block].reshape(found.shape)


def has_peaks(name: str) -> bool:
    """Say whether the largest value of an array of cells in a dump decides: plastic strain, damage."""
    quantity = BY_NAME.get(name.removeprefix("damage_"))
    return name == "eqps" or (quantity is not None and quantity.peak_counts)


def carry_blocks(
    carrier: Carrier,
    dump: Mapping[str, FloatArray],
    found: dict[str, FloatArray],
    volumes_n: Sequence[FloatArray],
    volumes: Sequence[FloatArray],
) -> None:
    """Fill the arrays of cells in the dump of a new mesh (found), in place, out of the one before (dump).

    volumes_n, volumes: of the old and of the new cells of each block (n_cells,). Work of stress and of hourglass
    control goes in proportion to the cells, so that its sums stay. What keeps its mesh keeps its state to the bit.
    """
    for block, part in enumerate(carrier.parts):
        prefix, volume = f"block_{block}.", volumes[block]
        for name, given in dump.items():
            what = name.removeprefix(prefix)
            if not name.startswith(prefix):
                continue
            if part.surface is None:
                found[name] = given
            elif what == "work":
                work = carry_cells(carrier, block, given / volumes_n[block][:, None], len(volume)) * volume[:, None]
                found[name] = work * given.sum(axis=0) / np.where(work.sum(axis=0) == 0.0, 1.0, work.sum(axis=0))
            elif what not in BEGIN_ANEW:
                found[name] = carry_cells(carrier, block, given, len(volume))
                if given.size and has_peaks(what):
                    found[name] = keep_peaks(carrier, block, name, given, found[name], volume)


def _in_row(carrier: Carrier, block: int, values: FloatArray) -> list[FloatArray]:
    """Return values of one block among those of all, which have none."""
    return [values if number == block else values[:0] for number in range(len(carrier.parts))]
