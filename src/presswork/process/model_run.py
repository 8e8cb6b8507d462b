# SPDX-License-Identifier: Apache-2.0
"""What all procedures at work on a model share: its mesh, or one mesh after another, and what a checkpoint holds.

A run is a row of epochs, each a mesh and the state that fits it: solids are meshed anew, blanks are refined or trimmed.
Results are written on the mesh of the present epoch, and a checkpoint holds it beside the state. What names a place
names a set of the mesh, and finds it anew in each epoch (model/mesh_change.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.files.dump import dump_mesh, load_mesh
from presswork.model import FloatArray, Mesh, Model, change_mesh
from presswork.observe.contract import Observed, Row
from presswork.process.run import Meta
from presswork.timing import Timing

NamedArrays = dict[str, NDArray[np.generic]]
EPOCH, NUMBER, ORIGIN = "epoch.", "number", "origin"
"""Prefix of an epoch's arrays in a checkpoint, and two of them."""


class ModelRun:
    """A procedure at work on a model; who inherits supplies columns, rows, the summary and the state."""

    timing: Timing

    def __init__(self, model: Model) -> None:
        self.model = model
        self.epoch = 0
        """How many meshes there were before the present one."""
        self._first_mesh = model.mesh
        self.origin: FloatArray | None = None

    @property
    def title(self) -> str:
        """What the case shows."""
        return self.model.title

    @property
    def mesh(self) -> Mesh:
        """The mesh of the present epoch, its points where their material was when the run began."""
        return self.model.mesh if self.origin is None else replace(self.model.mesh, points=self.origin)

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        raise NotImplementedError

    def row(self, report: Any) -> Row:
        """Return the row of the history."""
        raise NotImplementedError

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the contents of summary.json beyond status and wall time."""
        raise NotImplementedError

    def at_work(self) -> Observed | None:
        """Return what observers see; None where nothing is formed."""
        return None

    @property
    def checkpoint_every(self) -> int:
        """Reports between checkpoints."""
        return self.model.output.checkpoint_every

    def files(self) -> dict[str, str]:
        """Return the names and texts of further files to be written now."""
        return {}

    def meta(self) -> Meta:
        """Return nothing: the arrays hold all."""
        return {}

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up nothing."""

    # --- epochs ------------------------------------------------------------------------------------------------------

    def moved(self, displacement: FloatArray) -> FloatArray:
        """Return displacements since the run began, of those since the epoch's points (n_points, d) [mm]."""
        if self.origin is None:
            return displacement
        moved = displacement.copy()
        moved[:, : self.origin.shape[1]] += self.model.mesh.points - self.origin
        return moved

    def begin_epoch(self, mesh: Mesh, origin: FloatArray | None = None) -> None:
        """Go on with another mesh; the caller makes the procedure for it, and fills its state.

        origin: where the material of its nodes was when the run began (n_points, 2 | 3) [mm]; None: where they are.
        """
        self.model = change_mesh(self.model, mesh)
        self.origin = origin
        self.epoch += 1

    def to_arrays(self) -> NamedArrays:
        """Return all that the next report depends on: the state, and its mesh unless that is the first one."""
        return self._describe_epoch() | self._state_arrays()

    def _describe_epoch(self) -> NamedArrays:
        """Return the epoch, and its mesh unless that is the first one."""
        epoch: dict[str, NDArray[Any]] = {NUMBER: np.array(self.epoch), **self._epoch_arrays()}
        if self.epoch:
            epoch |= dump_mesh(self.model.mesh)
        if self.origin is not None:
            epoch[ORIGIN] = self.origin
        return {f"{EPOCH}{name}": values for name, values in epoch.items()}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Go back to the epoch and the state of these arrays. Raises ValueError if they belong to another model."""
        epoch = {name.removeprefix(EPOCH): values for name, values in arrays.items() if name.startswith(EPOCH)}
        if NUMBER not in epoch:
            raise ValueError("the checkpoint does not name its mesh")
        self._prepare_epoch(epoch)
        if int(epoch[NUMBER]) != self.epoch:
            self.begin_epoch(load_mesh(epoch) if epoch[NUMBER] else self._first_mesh, epoch.get(ORIGIN))
            self.epoch = int(epoch[NUMBER])
            self.make_run(epoch)
        self._load_epoch(epoch)
        self._load_state({name: values for name, values in arrays.items() if not name.startswith(EPOCH)})

    def _prepare_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make ready for an epoch that _epoch_arrays gave, before its mesh is taken up."""

    def _epoch_arrays(self) -> NamedArrays:
        """Return what belongs to the epoch beside its mesh."""
        return {}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Take up what _epoch_arrays gave."""

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make the procedure for the present mesh; epoch: what _epoch_arrays gave."""
        raise NotImplementedError

    def _state_arrays(self) -> NamedArrays:
        """Return the state."""
        raise NotImplementedError

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what _state_arrays gave. Raises ValueError if it belongs to another model."""
        raise NotImplementedError
