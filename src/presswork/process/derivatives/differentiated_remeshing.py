# SPDX-License-Identifier: Apache-2.0
"""Implicit runs with new meshes, whose history has derivatives by numbers of the case beside its columns.

A new mesh belongs to the material: its nodes keep their places in the cells of the old mesh, whatever the parameter.
So the neighbours take over the cells of the run's new mesh, each where its own material is, and carry their own
states to it from the points that the run has chosen. Then they find equilibrium as the run does.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.neighbours import SensitivityArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.simplices import measure_shares
from presswork.model import FloatArray, IndexArray, Mesh, Model
from presswork.outcome import Failed, GaveUpError
from presswork.process.derivatives.derivatives import WithDerivatives
from presswork.process.epochs import NamedArrays
from presswork.process.implicit.implicit_recording import ImplicitRecording
from presswork.process.implicit.increments import find_position
from presswork.process.implicit.remeshing import RemeshedForming
from presswork.process.implicit.remeshing_in_space import RemeshedSpaceForming
from presswork.process.mesh_change.carrying import OnMesh, carry_peaks, carry_to_mesh
from presswork.process.mesh_change.new_balance import balance_new_mesh
from presswork.process.mesh_change.new_epoch import NewEpoch, keep_held

POINTS, ORIGIN, SHARE = "slope.points", "slope.origin", "slope.share"
"""Names in a checkpoint: derivatives of the mesh, of its material's first places, and of marked points' shares."""


class DifferentiatedRemeshing(WithDerivatives["_Side"], RemeshedForming):
    """An implicit procedure at work on bodies that are meshed anew, beside its neighbours. Raises StartError."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self.begin_derivatives(lambda m: _Side(m, threads=threads))
        self.derivatives.follow(self.procedure, lambda side: side.procedure)
        self._slopes: dict[str, FloatArray] = {}

    def _go_on(self, new: NewEpoch) -> None:
        if SensitivityArrays not in self.procedure.state:
            super()._go_on(new)
            return
        # 1. the mesh beside the run's, for each parameter
        self.derivatives.spread()
        moves = self.derivatives.differ(lambda side: find_position(side.procedure))
        self._slopes = {POINTS: np.array([new.carrier.motion(move) for move in moves])}
        super()._go_on(new)
        # 2. the neighbours' states, carried to it
        for side, number, change in self.derivatives.placed:
            mesh = self._beside(number, change)
            side.take_slaves(self.model)
            try:
                if self.derivatives.is_lost(number) and change:
                    side.begin_at_rest(mesh)
                else:
                    side.follow(new, mesh, self.marked.nodes)
            except GaveUpError:
                self.derivatives.lose(number if change else None)
                side.begin_at_rest(mesh)
        self._slopes[ORIGIN] = self.derivatives.differ(lambda side: side.mesh.points)
        self._slopes[SHARE] = self.derivatives.differ(lambda side: side.marked.share)
        self._place()
        # 3. equilibrium, of the run once more, with those who follow it
        new.procedure.state = new.carried
        self.derivatives.follow(new.procedure, lambda side: side.procedure)
        beside = [side.procedure for side in self.derivatives.sides]
        outcome = balance_new_mesh(new.procedure, may_yield=new.may_yield, beside=beside)
        if isinstance(outcome, Failed):
            raise GaveUpError(f"no equilibrium on the new mesh, {outcome.reason}")

    def _beside(self, number: int, change: float) -> Mesh:
        """Return the mesh of a neighbour."""
        mesh = self.model.mesh
        return replace(mesh, points=mesh.points + change * self._slopes[POINTS][number])

    def _place(self) -> None:
        """Tell the neighbours where the material was when the run began, and where the marked points are."""
        for side, number, change in self.derivatives.placed:
            origin = self.mesh.points + change * self._slopes[ORIGIN][number]
            share = self.marked.share + change * self._slopes[SHARE][number]
            side.place(origin, self.marked.nodes, share)

    def _go_on_with(self, procedure: ImplicitProcedure) -> None:
        """Go on with contact of a body with itself, which has no derivatives."""
        super()._go_on_with(procedure)
        procedure.state.drop(SensitivityArrays)
        self.derivatives.lose()
        self._slopes = {}

    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        has_derivatives = SensitivityArrays in self.procedure.state
        super()._make_run(epoch)
        if not has_derivatives:
            return
        self._slopes = {name: epoch[name] for name in (POINTS, ORIGIN, SHARE)}
        for side, number, change in self.derivatives.placed:
            side.take_slaves(self.model)
            side.begin_at_rest(self._beside(number, change))
        self.derivatives.follow(self.procedure, lambda side: side.procedure)

    def _epoch_arrays(self) -> NamedArrays:
        return super()._epoch_arrays() | self._slopes

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        super()._load_epoch(epoch)
        if self._slopes:
            self._place()


class DifferentiatedSpaceRemeshing(DifferentiatedRemeshing, RemeshedSpaceForming):
    """The same of bodies of tetrahedra."""


class _Side(ImplicitRecording):
    """A neighbour of a run that gets new meshes."""

    def follow(self, new: NewEpoch, mesh: Mesh, marked: IndexArray) -> None:
        """Go on with a mesh beside the run's new one. marked: nodes that hold the marked points. Raises GaveUpError."""
        before, position = self.procedure, find_position(self.procedure)
        carrier = new.carrier.beside(position, mesh.points)
        after = carry_to_mesh(before, mesh, carrier, like=new.carried)
        carry_peaks(OnMesh.of(before), OnMesh.of(after), carrier)
        origin = carrier.material(self.mesh.points)
        keep_held(origin, after.model)
        places = self.marked.places(position)
        self._begin_on(after, origin, mesh.points)
        shares = [measure_shares(mesh.points[n][None], p)[0][0] for n, p in zip(marked, places, strict=True)]
        self.marked.share = np.array(shares).reshape(marked.shape)

    def take_slaves(self, like: Model) -> None:
        """Let contacts of bodies have the slaves that the run has on its new mesh."""
        pairs = zip(self.model.contacts, like.contacts, strict=True)
        contacts = tuple(replace(own, slave=led.slave) for own, led in pairs)
        self.model = replace(self.model, contacts=contacts)
        self.procedure.model = replace(self.procedure.model, contacts=contacts)

    def begin_at_rest(self, mesh: Mesh) -> None:
        """Go on with a mesh, in a state that is found elsewhere."""
        self._begin_epoch(mesh)
        self._make_run({})

    def place(self, origin: FloatArray, nodes: IndexArray, share: FloatArray) -> None:
        """Take first places of the material (n_points, 2) [mm], and nodes and shares of the marked points."""
        self._origin = origin
        self.procedure.evolution.place(origin)
        self.marked.nodes, self.marked.share = nodes, share
