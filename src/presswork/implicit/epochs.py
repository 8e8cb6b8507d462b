# SPDX-License-Identifier: Apache-2.0
"""A run whose mesh changes: a row of epochs, each a mesh and the State that fits it.

A load, a support or a probe names a set of nodes, edges or faces. Every mesh of a run has the sets that its model
names, so all that acts on a place finds it anew in each epoch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import FloatArray, Mesh, Model
from presswork.outcome import BadGuess, GaveUpError
from presswork.state import State


@dataclass(frozen=True)
class Epoch:
    """A part of a run on one mesh, at a converged instant."""

    mesh: Mesh
    state: State
    run: ImplicitProcedure
    """The procedure on this mesh: its contact, supports and laws."""
    failure: str = ""
    """Why the next increment finds no equilibrium; empty where none has failed."""


Transfer = Callable[[Epoch, Epoch], None]
"""Fills the State of the second epoch from the first: all arrays that belong to nodes and cells."""


@dataclass(frozen=True)
class MeshChange:
    """The mesh with which a run goes on."""

    mesh: Mesh
    transfer: Transfer
    origin: FloatArray | None = None
    """Where the material of its nodes was when the run began (n_points, 2 | 3) [mm]; None: where its points are."""
    reason: str = ""
    """For the log."""


AskForMesh = Callable[[Epoch], MeshChange | None]
"""Asked after every converged increment but the last, and once where an increment fails; its answer may depend on the
epoch alone, so that a resumed run gives the same bits."""


def new_epoch(run: ImplicitProcedure, mesh: Mesh, transfer: Transfer) -> ImplicitProcedure:
    """Return the procedure that goes on with another mesh; `run` stays as it is.

    What belongs to the run and not to its mesh, such as the places of tools and the work done, is taken over. Where the
    transfer leaves the contact with tools empty, nodes that lie on tools are found. Raises GaveUpError where the mesh
    lacks a set that the model names, or where a cell is inside out.
    """
    _check_sets(run.model, mesh)
    after = ImplicitProcedure(replace(run.model, mesh=mesh), before=run)
    state = after.state
    state.take_over(run.state)
    transfer(Epoch(run.model.mesh, run.state, run), Epoch(mesh, state, after))
    if ContactArrays in state and not state[ContactArrays].status.any():
        stage = max(state[Progress].stage - int(state[Progress].fraction == 0.0), 0)
        after.interactions.tools.contact.begin(state, after.interactions.supports.fixed(stage))
    trial = state.duplicate()
    found = after.mechanics.evaluate(state, trial, np.zeros_like(state.nodes.displacement), with_stiffness=False)
    if isinstance(found, BadGuess):
        raise GaveUpError(f"the new mesh cannot be used: {found}")
    state.cells.volume = trial.cells.volume
    return after


def _check_sets(model: Model, mesh: Mesh) -> None:
    for kind, name in list_sets(model):
        if name not in getattr(mesh, f"{kind}_sets"):
            raise GaveUpError(f"the new mesh has no {kind} set {name!r}, which the model names")


def list_sets(model: Model) -> Iterator[tuple[str, str]]:
    """Yield kind (node, edge, face) and name of every set of the mesh that a model names."""
    yield from (("node", support.node_set) for support in model.supports)
    for stage in model.stages:
        yield from (("node", moved.node_set) for moved in stage.prescribed)
        yield from (("node", force.node_set) for force in stage.forces)
        yield from (("node", pressure.node_set) for pressure in stage.shell_pressures)
        yield from (("edge", pressure.edge_set) for pressure in stage.pressures)
        yield from (("edge", force.edge_set) for force in stage.edge_forces)
        yield from (("face", pressure.face_set) for pressure in stage.face_pressures)
        yield from (("face", force.face_set) for force in stage.face_forces)
