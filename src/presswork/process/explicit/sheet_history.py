# SPDX-License-Identifier: Apache-2.0
"""What the layers of an explicit stamping go through, row by row (point_history.py)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.law_window import LawWindow
from presswork.explicit.shells import ExplicitShells
from presswork.law.elastic_plastic import back_stress, temperature
from presswork.law.history import EQPS
from presswork.model import FloatArray, Mesh, Model
from presswork.process.explicit.point_history import BlockPoints, PointHistory
from presswork.process.mesh_change.transfer import SheetBlock, at_points


class SheetHistory:
    """Windows and evolution laws of a sheet, zone after zone."""

    def __init__(self, model: Model, shells: ExplicitShells) -> None:
        self._materials = model.sheet_materials
        self._numbers = [self._materials.index(model.materials[own[0].material]) for own in model.blocks_of_zones]
        self._knows_heat = model.heat is not None
        self._rows = PointHistory(self._materials, self._numbers, is_solid=False)
        self.start(shells)

    def start(self, shells: ExplicitShells) -> None:
        """Give the quantities of shells their values at rest."""
        self._rows.start(self._look(shells))

    def _look(self, shells: ExplicitShells) -> list[BlockPoints]:
        """Return stress, plastic strain and temperature at the layers (n_cells, q, k) of each zone."""
        history, stress, kept = shells.history_at_points, shells.flow_stress_at_points, shells.kept_in_layers
        given, found = shells.prescribed_temperature, []
        for number, own in zip(self._numbers, shells.zones, strict=True):
            material, degrees, values = self._materials[number], None, history[own]
            if material.heating is not None or self._knows_heat:
                degrees = temperature(material, kept, values, None if given is None else given[own])
            back = back_stress(kept, values, 3) if material.kinematic is not None else None
            found.append(BlockPoints(stress[own], kept.of(EQPS, values), degrees, back))
        return found

    def take(self, blocks: Sequence[SheetBlock], shells: ExplicitShells) -> None:
        """Take the quantities of a sheet, block after block, where it has them."""
        for name, of_zones in self._rows.values.items():
            if not all(name in block.evolved for block in blocks):
                continue
            q = of_zones[0].shape[1]
            values = np.concatenate([at_points(block.evolved[name], q) for block in blocks])
            for own, of_zone in zip(shells.zones, of_zones, strict=True):
                if len(of_zone):
                    of_zone[:] = values[own]

    def begin_row(self, shells: ExplicitShells) -> None:
        """Keep what a row of cycles begins with."""
        if self._rows.is_needed:
            self._rows.begin_row(self._look(shells))

    def end_row(self, shells: ExplicitShells, dt: float) -> None:
        """Take up what a row has led to in dt [s] of the process."""
        if self._rows.is_needed:
            hardens = self._rows.end_row(self._look(shells), dt)
            if self._rows.softens:
                shells.recover(np.concatenate(hardens))

    def split(self, parent: NDArray[np.integer[Any]], before: ExplicitShells) -> None:
        """Give shells that were split the values of those that they come from (n_cells,), before that."""
        inside = [(parent >= own.start) & (parent < own.stop) for own in before.zones]
        self._rows.split([parent[i] - own.start for i, own in zip(inside, before.zones, strict=True)])

    def find_values(self, shells: ExplicitShells) -> dict[str, FloatArray]:
        """Return the quantities at the layers (n_cells, q, k); NaN in zones whose material has no such law."""
        found = {}
        for name, of_zones in self._rows.values.items():
            each = zip(shells.zones, of_zones, strict=True)
            found[name] = np.concatenate(
                [of if len(of) else np.full((own.stop - own.start, *of.shape[1:]), np.nan) for own, of in each]
            )
        return found

    def show(self, shells: ExplicitShells, mesh: Mesh) -> dict[str, list[FloatArray]]:
        """Return these and damage by quantity and block of the mesh (n_cells, q k)."""
        ends = np.cumsum([len(block.connectivity) for block in mesh.blocks])[:-1]
        kept = {**shells.damage, **self.find_values(shells)}
        return {name: np.split(values.reshape(len(values), -1), ends) for name, values in kept.items()}

    @property
    def window(self) -> LawWindow:
        """What the material has been through."""
        return self._rows.window

    def dump(self) -> dict[str, NDArray[np.generic]]:
        """Return what the next row depends on."""
        return self._rows.to_arrays()

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what dump gave."""
        self._rows.load_arrays(arrays)
