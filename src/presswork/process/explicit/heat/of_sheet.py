# SPDX-License-Identifier: Apache-2.0
"""Heat of a sheet that explicit dynamics stamps: after each row of cycles heat flows for the time that the row takes in
the press, and the shells go on at the temperatures that it has led to (interaction/heat/heat_of_sheet.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.body.sheet_heat import LayerMap
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.tools import RigidTool
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetInstant
from presswork.law.elastic_plastic import plastic_work_density
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import Dwell, FloatArray, Model

ONE_POINT = np.full((1, 4), 0.25)


class HeatOfShells:
    """Heat of a model's sheet, beside its explicit shells."""

    def __init__(self, model: Model, shells: ExplicitShells, tools: list[RigidTool]) -> None:
        self.sheet = HeatOfSheet(model)
        self.arrays = self.sheet.at_rest()
        self._model, self._shells, self._tools = model, shells, tools
        section = model.sheet[0]
        heights, weights = thickness_rule(section)
        q = shells.history_at_points.shape[1]
        shapes = ONE_POINT if q == 1 else np.asarray(_core.shell_shape("shell4_mitc")[0])
        self._map = LayerMap(model.cells, shapes, heights, model.heat.levels if model.heat else 2, len(shells.start))
        area = self.sheet.conduction.measure_areas(shells.start)
        area = area.sum(axis=1, keepdims=True) if q == 1 else area
        self._volume = section.thickness * area[:, :, None] * 0.5 * weights
        self._prescribe_temperature()
        self.begin_row()

    def _prescribe_temperature(self) -> None:
        self._shells.prescribed_temperature = self._map.to_layers(self.arrays.temperature)

    def begin_row(self) -> None:
        """Keep what a row of cycles begins with."""
        shells = self._shells
        self._history = shells.history_at_points
        self._points, self._places = shells.position, self._tool_places()
        self._force = np.zeros((len(self._tools), *shells.start.shape))
        self._samples = 0

    def _tool_places(self) -> FloatArray:
        return np.array([tool.position for tool in self._tools]).reshape(-1, 3)

    def sample(self) -> None:
        """Note the forces of the tools on the nodes."""
        self._samples += 1
        for mean, tool in zip(self._force, self._tools, strict=True):
            mean += (self._shells.force_of(tool) - mean) / self._samples

    def advance(self, dt: float, dwell: Dwell | None) -> None:
        """Let heat flow for dt [s] of the process, with what the row has made. Raises GaveUpError."""
        shells, places = self._shells, self._tool_places()
        moved, travel = shells.position - self._points, places - self._places
        plastic = np.zeros_like(self.arrays.temperature) if dwell else self._map.to_levels(self._plastic_work(dt))
        now = SheetInstant(
            shells.position, shells.thickness, places, self._force, moved[None] - travel[:, None], plastic
        )
        self.arrays = self.sheet.advance(self.arrays, now, dt, dwell)
        self._prescribe_temperature()

    def _plastic_work(self, dt: float) -> FloatArray:
        """Return the plastic work of the row at the layers (n_cells, q, k) [N mm]."""
        shells, law = self._shells, self._shells.blocks[0].law
        after = shells.history_at_points
        assert isinstance(law, _core.SheetLaw), "heat is not computed with a UMAT"
        n, given = after.shape[-1], shells.prescribed_temperature
        assert given is not None
        density = plastic_work_density(
            self._model.sheet[1],
            law,
            shells.kept_in_layers,
            self._history.reshape(-1, n),
            after.reshape(-1, n),
            shells.flow_stress_at_points.reshape(-1, 3),
            dt,
            (given, given),
        )
        return np.asarray(density.reshape(after.shape[:3]) * self._volume)

    def show(self) -> dict[str, Any]:
        """Return what an Instant shows of it."""
        sheet, arrays = self.sheet, self.arrays
        return {"temperature": sheet.mean_at_nodes(arrays), "heated": sheet.fields(arrays)}

    def dump(self) -> dict[str, NDArray[np.generic]]:
        """Return what the next row depends on."""
        return self.arrays.to_arrays()

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what dump gave."""
        taken = self.sheet.at_rest()
        taken.load_arrays(arrays)
        self.arrays = taken
        self._prescribe_temperature()
