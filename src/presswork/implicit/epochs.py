# SPDX-License-Identifier: Apache-2.0
"""A run whose mesh changes: a row of epochs, each a mesh and the State that fits it.

A load, a support or a probe names a set of nodes, edges or faces. Every mesh of a run has the sets that its model
names, so all that acts on a place finds it anew in each epoch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from presswork.implicit.energy import Work, add_work
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import FloatArray, Mesh, change_mesh
from presswork.outcome import BadGuess, Converged, Failed, GaveUpError, Step
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
class NextMesh:
    """The mesh with which a run goes on."""

    mesh: Mesh
    transfer: Transfer
    origin: FloatArray | None = None
    """Where the material of its nodes was when the run began (n_points, 2 | 3) [mm]; None: where its points are."""
    reason: str = ""
    """Reason, for the log."""


AskForMesh = Callable[[Epoch], NextMesh | None]
"""Called after every converged increment but the last, and once where an increment fails; its result may depend on the
epoch alone, so that a resumed run gives the same bits."""


def balance_at_rest(run: ImplicitProcedure) -> Converged | Failed:
    """Find equilibrium of a State that comes from another mesh, with tools and loads as they are."""
    step, state_n = run.present_step(), run.state
    trial = state_n.duplicate()
    at_rest = np.zeros_like(state_n.nodes.increment)
    outcome = run.equilibrium.solve(state_n, trial, step, at_rest, keeps_factors=not run.followers)
    if isinstance(outcome, Failed):
        return outcome
    for follower in run.followers:
        follower.note(trial)
    end_increment_at_rest(run, state_n, trial, step)
    trial[Progress].iterations += len(outcome.log)
    for follower in run.followers:
        follower.follow(state_n, trial, step, None)
    run.state = trial
    return outcome


def end_increment_at_rest(run: ImplicitProcedure, state_n: State, trial: State, step: Step) -> None:
    """Complete a trial state in equilibrium on a new mesh: no time passes, and the last increment stays."""
    run.mechanics.end_increment(state_n, trial, 0.0)
    for interaction in run.interactions.all:
        interaction.commit(state_n, trial, step)
    for interaction in run.interactions.all:
        add_work(trial, interaction.work(state_n, trial))
    trial[Work].plastic_work += run.mechanics.plastic_work(state_n, trial, 0.0)
    trial.nodes.increment = state_n.nodes.increment


def new_epoch(run: ImplicitProcedure, mesh: Mesh, transfer: Transfer) -> ImplicitProcedure:
    """Return the procedure that goes on with another mesh; `run` stays as it is.

    What belongs to the run and not to its mesh, such as the places of tools and the work done, is taken over. Where the
    transfer leaves the contact with tools empty, nodes that lie on tools are found. Raises GaveUpError where the mesh
    lacks a set that the model names, or where a cell is inside out.
    """
    try:
        model = change_mesh(run.model, mesh)
    except ValueError as error:
        raise GaveUpError(str(error)) from error
    after = ImplicitProcedure(model, before=run)
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
    after.mechanics.complete(trial)
    state.cells.volume = trial.cells.volume
    return after
