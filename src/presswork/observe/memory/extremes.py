# SPDX-License-Identifier: Apache-2.0
"""The extremes of every field over the saved steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from presswork.fields.table import split_components, to_scalar
from presswork.model import FloatArray, Mesh
from presswork.observe.contract import History
from presswork.observe.memory.contract import Memory, Saved


class FieldExtremes(Memory):
    """The least and the largest value of every field, with place and time."""

    name = "fields"

    def __init__(self) -> None:
        self._fields: dict[str, dict[str, dict[str, Any]]] = {}

    def note_step(self, number: int, mesh: Mesh, step: Saved) -> None:
        """Take up the extremes of a step; places are those of the deformed body."""
        space = np.zeros((len(mesh.points), 3))
        space[:, : mesh.points.shape[1]] = mesh.points
        space += step.point_data.get("displacement", 0.0)
        centres = np.concatenate([space[block.connectivity].mean(axis=1) for block in mesh.blocks])
        for data, places in ((step.point_data, space), (step.cell_data, centres)):
            for name, values in data.items():
                for each, numbers in _scalars(name, np.asarray(values)).items():
                    self._take(each, numbers, places, {"step": number, "time_s": step.time})

    def _take(self, name: str, values: FloatArray, places: FloatArray, when: Mapping[str, float]) -> None:
        finite = np.isfinite(values)
        if not finite.any():
            return
        own = slice(None) if finite.all() else np.flatnonzero(finite)
        known, numbers = self._fields.setdefault(name, {}), np.arange(len(values))[own]
        for key, sign, find in (("smallest", -1.0, np.argmin), ("largest", 1.0, np.argmax)):
            at = int(numbers[find(values[own])])
            value = float(values[at])
            if key not in known or sign * value > sign * known[key]["value"]:
                known[key] = {"value": value, "at_mm": [float(x) for x in places[at]], **when}

    def summary(self, history: History) -> dict[str, Any]:
        """Return the extremes of every field."""
        return {"fields": self._fields}

    def to_data(self) -> Any:
        """Return the extremes."""
        return self._fields

    def load_data(self, data: Any) -> None:
        """Take up what to_data gave."""
        self._fields = data


def _scalars(name: str, values: FloatArray) -> dict[str, FloatArray]:
    """Return a field as scalars: the components of a tensor, the length of a vector."""
    one = to_scalar(name, values)
    return split_components(name, values) if one is None else {name: one}
