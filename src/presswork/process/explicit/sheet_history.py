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
    """Windows and evolution laws of the one material of a sheet."""

    def __init__(self, model: Model, shells: ExplicitShells) -> None:
        self._material = model.sheet[1]
        self._knows = self._material.heating is not None or model.heat is not None
        self._rows = PointHistory([self._material], [0], is_solid=False)
        self.start(shells)

    def start(self, shells: ExplicitShells) -> None:
        """Give the quantities of shells their values at rest."""
        self._rows.start(self._look(shells))

    def _look(self, shells: ExplicitShells) -> list[BlockPoints]:
        """Return stress, plastic strain and temperature at the layers (n_cells, q, k)."""
        history, kept = shells.history_at_points, shells.kept_in_layers
        degrees = temperature(self._material, kept, history, shells.prescribed_temperature) if self._knows else None
        kinematic = self._material.kinematic is not None
        back = back_stress(kept, history, 3) if kinematic else None
        return [BlockPoints(shells.flow_stress_at_points, kept.of(EQPS, history), degrees, back)]

    def take(self, blocks: Sequence[SheetBlock]) -> None:
        """Take the quantities of a sheet, a block of triangles after one of quadrilaterals, where it has them."""
        for name, (own,) in self._rows.values.items():
            if all(name in block.evolved for block in blocks):
                q = own.shape[1]
                own[:] = np.concatenate([at_points(block.evolved[name], q) for block in blocks])

    def begin_row(self, shells: ExplicitShells) -> None:
        """Keep what a row of cycles begins with."""
        if self._rows.is_needed:
            self._rows.begin_row(self._look(shells))

    def end_row(self, shells: ExplicitShells, dt: float) -> None:
        """Take up what a row has led to in dt [s] of the process."""
        if self._rows.is_needed:
            (hardens,) = self._rows.end_row(self._look(shells), dt)
            if self._rows.softens:
                shells.recover(hardens)

    def split(self, parent: NDArray[np.integer[Any]]) -> None:
        """Give shells that were split the values of those that they come from (n_cells,)."""
        self._rows.split([parent])

    @property
    def values(self) -> dict[str, FloatArray]:
        """The quantities at the layers (n_cells, q, k)."""
        return {name: values for name, (values,) in self._rows.values.items()}

    def show(self, shells: ExplicitShells, mesh: Mesh) -> dict[str, list[FloatArray]]:
        """Return these and damage by quantity and block of the mesh (n_cells, q k)."""
        ends = np.cumsum([len(block.connectivity) for block in mesh.blocks])[:-1]
        kept = {**shells.damage, **self.values}
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
