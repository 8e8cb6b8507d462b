# SPDX-License-Identifier: Apache-2.0
"""What the material points of an explicit run go through from row to row of cycles.

Each row counts as one increment: of the windows of hot laws (body/law_window.py), and of evolution laws such as grain
size. Damage grows in every cycle, inside the loop.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.law_window import LawWindow
from presswork.evolution.contract import PointChange
from presswork.evolution.in_parts import advance_in_parts
from presswork.evolution.of_material import make_other_laws
from presswork.model import FloatArray, Material, SolverSettings

PREFIX = "evolved."
"""Prefix of the names in a checkpoint."""


@dataclass(frozen=True)
class BlockPoints:
    """The points of one block of cells at one instant."""

    stress: FloatArray
    """(..., 3 | 4 | 6) [MPa]."""
    eqps: FloatArray
    """Equivalent plastic strain (...), of a sheet (n_cells, q, layers)."""
    temperature: FloatArray | None
    """(...) [degrees C]; None: not known."""
    back_stress: FloatArray | None = None
    """Back stress of a sheet with kinematic hardening (..., 3) [MPa]."""


class PointHistory:
    """Windows and evolution laws of the blocks of a run."""

    def __init__(self, materials: Sequence[Material], numbers: Sequence[int], *, is_solid: bool) -> None:
        """numbers: which of the materials each block has."""
        self._materials, self._numbers, self._is_solid = materials, numbers, is_solid
        self._laws = [make_other_laws(materials[number], is_solid=is_solid) for number in numbers]
        self.window = LawWindow.at_rest(materials)
        self.values: dict[str, list[FloatArray]] = {}
        """Values by the quantity's name, an entry for each block, of the shape of its points; empty without the law."""
        self._before: list[BlockPoints] = []
        self.softens = any(law.softens for laws in self._laws for law in laws)
        """Whether what is recrystallised hardens no more."""

    @property
    def is_needed(self) -> bool:
        """Whether a material has a window or a law."""
        windows = (m.hardening is not None and m.hardening.window is not None for m in self._materials)
        return any(self._laws) or any(windows)

    def start(self, points: Sequence[BlockPoints]) -> None:
        """Give the quantities their values at rest."""
        names = dict.fromkeys(q.name for laws in self._laws for law in laws for q in law.quantities)
        self.values = {name: [] for name in names}
        for laws, block in zip(self._laws, points, strict=True):
            rest = {name: value for law in laws for name, value in law.at_rest().items()}
            for name, of in self.values.items():
                shape = block.eqps.shape if name in rest else (0, *block.eqps.shape[1:])
                of.append(np.full(shape, rest.get(name, 0.0)))

    def begin_row(self, points: Sequence[BlockPoints]) -> None:
        """Keep what a row of cycles begins with."""
        self._before = list(points)

    def end_row(self, points: Sequence[BlockPoints], dt: float) -> list[FloatArray]:
        """Take up what a row has led to in dt [s] of the process.

        Return the part of the plastic strain of each block's points that still hardens, of the shape of its points.
        """
        hardens = [np.ones_like(after.eqps) for after in points]
        for i, (before, after) in enumerate(zip(self._before, points, strict=True)):
            number, grown = self._numbers[i], after.eqps - before.eqps
            degrees = np.zeros_like(after.eqps) if after.temperature is None else after.temperature
            if dt > 0.0:
                self.window.note(number, self._materials[number], after.eqps, grown, dt, degrees)
            if self._laws[i]:
                hardens[i] = self._advance(i, before, after, dt)
        return hardens

    def _advance(self, block: int, before: BlockPoints, after: BlockPoints, dt: float) -> FloatArray:
        components = after.stress.shape[-1]
        change = PointChange(
            before.stress.reshape(-1, components),
            after.stress.reshape(-1, components),
            before.eqps.ravel(),
            after.eqps.ravel(),
            dt,
            None if before.temperature is None else before.temperature.ravel(),
            None if after.temperature is None else after.temperature.ravel(),
            back_stress=None if after.back_stress is None else after.back_stress.reshape(-1, components),
            layers=1 if self._is_solid else after.eqps.shape[-1],
        )
        hardens = np.ones_like(after.eqps)
        for law in self._laws[block]:
            values = {q.name: self.values[q.name][block].ravel() for q in law.quantities}
            found = advance_in_parts(law, values, change, SolverSettings.increment_tolerance)
            for name, value in found.items():
                self.values[name][block] = value.reshape(after.eqps.shape)
            if law.softens:
                kept = law.hardening_strain(found).reshape(after.eqps.shape)
                hardens = np.where(after.eqps > 0.0, kept / np.where(after.eqps > 0.0, after.eqps, 1.0), 1.0)
        return hardens

    def split(self, parents: Sequence[NDArray[np.integer[Any]]]) -> None:
        """Give the cells of each block the values of those that they come from (n_cells,)."""
        for of in self.values.values():
            of[:] = [values[parent] if len(values) else values for values, parent in zip(of, parents, strict=True)]

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return what the next row depends on."""
        kept = {f"{PREFIX}{name}.{i}": own.copy() for name, of in self.values.items() for i, own in enumerate(of)}
        return {**self.window.to_arrays(), **kept}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what to_arrays gave."""
        self.window.load_arrays(arrays)
        for name, of in self.values.items():
            of[:] = [np.array(arrays[f"{PREFIX}{name}.{i}"], dtype=float) for i in range(len(of))]
