# SPDX-License-Identifier: Apache-2.0
"""Runs whose mesh changes on the way: a row of epochs, each a mesh and the state that fits it.

Solids are meshed anew, blanks are refined. Results are written on the mesh of the present epoch, and a checkpoint holds
it beside the state. What names a place names a set of the mesh, and finds it anew in each epoch (model/mesh_change.py).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.files.dump import dump_mesh, load_mesh
from presswork.model import FloatArray, Mesh, Model, change_mesh
from presswork.process.recording import ModelRecording

NamedArrays = dict[str, NDArray[np.generic]]
EPOCH, NUMBER, ORIGIN = "epoch.", "number", "origin"
"""Prefix of an epoch's arrays in a checkpoint, and two of them."""


class EpochRecording(ModelRecording, ABC):
    """A procedure at work on a model, on one mesh after another."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.epoch = 0
        """How many meshes there were before the present one."""
        self._first_mesh = model.mesh
        self._origin: FloatArray | None = None

    @property
    def mesh(self) -> Mesh:
        """The mesh of the present epoch, its points where their material was when the run began."""
        return self.model.mesh if self._origin is None else replace(self.model.mesh, points=self._origin)

    def moved(self, displacement: FloatArray) -> FloatArray:
        """Return displacements since the run began, of those since the epoch's points (n_points, d) [mm]."""
        if self._origin is None:
            return displacement
        moved = displacement.copy()
        moved[:, : self._origin.shape[1]] += self.model.mesh.points - self._origin
        return moved

    def _begin_epoch(self, mesh: Mesh, origin: FloatArray | None = None) -> None:
        """Go on with another mesh; the caller makes the procedure for it, and fills its state.

        origin: where the material of its nodes was when the run began (n_points, 2 | 3) [mm]; None: where they are.
        """
        self.model = change_mesh(self.model, mesh)
        self._origin = origin
        self.epoch += 1

    def to_arrays(self) -> NamedArrays:
        """Return all that the next report depends on: the state, and its mesh unless that is the first one."""
        return self._describe_epoch() | self._state_arrays()

    def _describe_epoch(self) -> NamedArrays:
        """Return the epoch, and its mesh unless that is the first one."""
        epoch: dict[str, NDArray[Any]] = {NUMBER: np.array(self.epoch), **self._epoch_arrays()}
        if self.epoch:
            epoch |= dump_mesh(self.model.mesh)
        if self._origin is not None:
            epoch[ORIGIN] = self._origin
        return {f"{EPOCH}{name}": values for name, values in epoch.items()}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Go back to the epoch and the state of these arrays. Raises ValueError if they belong to another model."""
        epoch = {name.removeprefix(EPOCH): values for name, values in arrays.items() if name.startswith(EPOCH)}
        if NUMBER not in epoch:
            raise ValueError("the checkpoint does not say which mesh it is of")
        if int(epoch[NUMBER]) != self.epoch:
            self._begin_epoch(load_mesh(epoch) if epoch[NUMBER] else self._first_mesh, epoch.get(ORIGIN))
            self.epoch = int(epoch[NUMBER])
            self._make_run(epoch)
        self._load_epoch(epoch)
        self._load_state({name: values for name, values in arrays.items() if not name.startswith(EPOCH)})

    def _epoch_arrays(self) -> NamedArrays:
        """Return what belongs to the epoch beside its mesh."""
        return {}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Take up what _epoch_arrays gave."""

    @abstractmethod
    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make the procedure for the present mesh; epoch: what _epoch_arrays gave."""

    @abstractmethod
    def _state_arrays(self) -> NamedArrays:
        """Return the state."""

    @abstractmethod
    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what _state_arrays gave. Raises ValueError if it belongs to another model."""
