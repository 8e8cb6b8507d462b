# SPDX-License-Identifier: Apache-2.0
"""Neighbours of an implicit run with new meshes.

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
from presswork.observe.marked_points import find_marked
from presswork.outcome import Failed, GaveUpError
from presswork.process.derivatives.derivatives import Derivatives
from presswork.process.implicit.forming import ImplicitForming
from presswork.process.implicit.increments import IncrementRun, find_position
from presswork.process.mesh_change.carrying import OnMesh, carry_peaks, carry_to_mesh
from presswork.process.mesh_change.new_balance import balance_new_mesh
from presswork.process.mesh_change.new_epoch import NewEpoch, keep_held
from presswork.process.model_run import NamedArrays

POINTS, ORIGIN, SHARE = "slope.points", "slope.origin", "slope.share"
"""Names in a checkpoint: derivatives of the mesh, of its material's first places, and of marked points' shares."""


class OnNewMeshes:
    """Lets the neighbours of a run follow it onto its new meshes."""

    def __init__(self, run: IncrementRun, derivatives: Derivatives[ImplicitForming]) -> None:
        self._run, self._derivatives = run, derivatives
        self._slopes: dict[str, FloatArray] = {}
        self._has_derivatives = True

    def leave_mesh(self, new: NewEpoch) -> None:
        """Find the mesh beside the run's new one, for each parameter."""
        self._has_derivatives = SensitivityArrays in self._run.procedure.state
        if not self._has_derivatives:
            return
        self._derivatives.spread()
        moves = self._derivatives.differ(lambda side: find_position(side.procedure))
        self._slopes = {POINTS: np.array([new.carrier.motion(move) for move in moves])}

    def take_mesh(self, new: NewEpoch) -> None:
        """Let the neighbours go on with the new mesh that the run has gone on to. Raises GaveUpError."""
        if not self._has_derivatives:
            return
        run, derivatives = self._run, self._derivatives
        # 1. the neighbours' states, carried to it
        for side, number, change in derivatives.placed:
            mesh = self._beside(number, change)
            _take_slaves(side, run.model)
            try:
                if derivatives.is_lost(number) and change:
                    _begin_at_rest(side, mesh)
                else:
                    _follow(side, new, mesh, find_marked(run).nodes)
            except GaveUpError:
                derivatives.lose(number if change else None)
                _begin_at_rest(side, mesh)
        self._slopes[ORIGIN] = derivatives.differ(lambda side: side.mesh.points)
        self._slopes[SHARE] = derivatives.differ(lambda side: find_marked(side).share)
        self._place()
        # 2. equilibrium, of the run once more, with those who follow it
        new.procedure.state = new.carried
        derivatives.follow(new.procedure, lambda side: side.procedure)
        beside = [side.procedure for side in derivatives.sides]
        outcome = balance_new_mesh(new.procedure, may_yield=new.may_yield, beside=beside)
        if isinstance(outcome, Failed):
            raise GaveUpError(f"no equilibrium on the new mesh, {outcome.reason}")

    def end(self) -> None:
        """End: contact of a body with itself has no derivatives."""
        self._run.procedure.state.drop(SensitivityArrays)
        self._derivatives.lose()
        self._slopes = {}

    def make_again(self, before: ImplicitProcedure, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Follow the procedure that was made for the epoch of a checkpoint, after another one."""
        if SensitivityArrays not in before.state:
            return
        self._slopes = {name: epoch[name] for name in (POINTS, ORIGIN, SHARE)}
        for side, number, change in self._derivatives.placed:
            _take_slaves(side, self._run.model)
            _begin_at_rest(side, self._beside(number, change))
        self._derivatives.follow(self._run.procedure, lambda side: side.procedure)

    def epoch_arrays(self) -> NamedArrays:
        """Return the derivatives of the mesh."""
        return dict(self._slopes)

    def load_epoch(self) -> None:
        """Go on in the epoch of make_again."""
        if self._slopes:
            self._place()

    def _beside(self, number: int, change: float) -> Mesh:
        """Return the mesh of a neighbour."""
        mesh = self._run.model.mesh
        return replace(mesh, points=mesh.points + change * self._slopes[POINTS][number])

    def _place(self) -> None:
        """Set where the neighbours' material was when the run began, and where their marked points are."""
        run = self._run
        for side, number, change in self._derivatives.placed:
            side.origin = run.mesh.points + change * self._slopes[ORIGIN][number]
            side.procedure.evolution.place(side.origin)
            find_marked(side).nodes = find_marked(run).nodes
            find_marked(side).share = find_marked(run).share + change * self._slopes[SHARE][number]


def _follow(side: ImplicitForming, new: NewEpoch, mesh: Mesh, marked: IndexArray) -> None:
    """Go on with a mesh beside the run's new one. marked: nodes that hold the marked points. Raises GaveUpError."""
    before, position = side.procedure, find_position(side.procedure)
    carrier = new.carrier.beside(position, mesh.points)
    after = carry_to_mesh(before, mesh, carrier, like=new.carried)
    carry_peaks(OnMesh.of(before), OnMesh.of(after), carrier)
    origin = carrier.material(side.mesh.points)
    keep_held(origin, after.model)
    places = find_marked(side).places(position)
    side.begin_on(after, origin, mesh.points)
    shares = [measure_shares(mesh.points[n][None], p)[0][0] for n, p in zip(marked, places, strict=True)]
    find_marked(side).share = np.array(shares).reshape(marked.shape)


def _take_slaves(side: ImplicitForming, like: Model) -> None:
    """Let contacts of bodies have the slaves that the run has on its new mesh."""
    pairs = zip(side.model.contacts, like.contacts, strict=True)
    contacts = tuple(replace(own, slave=led.slave) for own, led in pairs)
    side.model = replace(side.model, contacts=contacts)
    side.procedure.model = replace(side.procedure.model, contacts=contacts)


def _begin_at_rest(side: ImplicitForming, mesh: Mesh) -> None:
    """Go on with a mesh, in a state that is found elsewhere."""
    side.begin_epoch(mesh)
    side.make_run({})
