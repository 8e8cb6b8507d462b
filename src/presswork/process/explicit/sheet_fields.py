# SPDX-License-Identifier: Apache-2.0
"""Fields of the shells of an explicit stamping."""

from __future__ import annotations

import numpy as np

from presswork.explicit.shells import ExplicitShells
from presswork.fields.evolved_layers import find_path_margins
from presswork.fields.explicit_fields import OnePointFields
from presswork.fields.shell_fields import state_variable_field, temperature_field
from presswork.law.history import EQPS
from presswork.model import FloatArray, Model
from presswork.process.explicit.sheet_history import SheetHistory
from presswork.process.mesh_change.transfer import law_axes


class SheetFields:
    """Makes fields of the shells on one mesh."""

    def __init__(self, model: Model, shells: ExplicitShells, layers: SheetHistory, *, begins_flat: bool) -> None:
        """begins_flat: the shells begin as the blank, whose axes follow from the undeformed mesh."""
        section, self._material = model.sheet
        blocks = model.mesh.blocks
        self._model, self._shells, self._layers, self._begins_flat = model, shells, layers, begins_flat
        rolling = np.asarray(model.rolling_direction)
        if any(block.rolling for block in blocks):
            each = [np.tile(block.rolling or rolling, (len(block.connectivity), 1)) for block in blocks]
            rolling = np.concatenate(each)
        self.of_shells = OnePointFields(model.mesh, model.cells, section, rolling, model.symmetry)

    def find_evolved(self) -> dict[str, list[FloatArray]]:
        """Return what evolution laws keep at the layers by quantity and block of the mesh (n_cells, q k)."""
        return self._layers.show(self._shells, self._model.mesh)

    def find(self) -> dict[str, FloatArray]:
        """Return the fields of the cells."""
        shells, history, material = self._shells, self._shells.history_at_points, self._material
        kept = shells.kept_in_layers
        fields = self.of_shells.cell_fields(
            shells.position,
            shells.thickness,
            shells.flow_stress_at_points,
            shells.pressure_at_points,
            kept.of(EQPS, history),
            axis=None if self._begins_flat else law_axes(shells),
        )
        degrees = temperature_field(material, kept, history, shells.prescribed_temperature)
        of_layers = find_path_margins(self._model.mesh.blocks, self.find_evolved())
        return fields | degrees | state_variable_field(material, history) | of_layers

    def find_middle_strains(self) -> dict[str, FloatArray]:
        """Return the strains of the middle surface alone."""
        return self.of_shells.middle_strains(self._shells.position, self._shells.thickness)
