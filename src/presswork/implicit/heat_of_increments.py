# SPDX-License-Identifier: Apache-2.0
"""Heat in implicit increments of forming, staggered with equilibrium.

An increment begins with the temperatures that the last rate predicts. Once it is in equilibrium, the heat equation
takes them to its end (heat_of_forming.py). Where a law was given temperatures that are off by more than the tolerance,
equilibrium is found again with the new ones.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.body.phase_mixtures import PhaseMixtures
from presswork.body.solids import Mechanics
from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.implicit.newton import Augmentation
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.heat.forming_instant import BetweenBodies, FormingInstant, Poses, find_poses
from presswork.interaction.of_model import Interactions
from presswork.interaction.tool_arrays import ContactArrays, SpaceToolArrays, ToolArrays
from presswork.model import BodyContact, CellBlock, FloatArray, Model, find_cell
from presswork.outcome import Failed, Step
from presswork.state import State
from presswork.timing import Timing

MOST_PASSES = 5
"""Most times that equilibrium and heat are found in an increment."""


def _grows_evenly(model: Model, block: CellBlock) -> bool:
    """Return whether a block's cells are of first order and expand, so that their points take one temperature.

    Their volume has one strain: expansion that varies over a cell would load its hourglass modes, in which hot metal
    flows.
    """
    thermoelastic = model.materials[block.material].thermoelastic
    expands = thermoelastic is not None and thermoelastic.expansion is not None
    return expands and not find_cell(model.dimension, block.connectivity).is_quadratic


class HeatOfIncrements:
    """Conducts heat in the bodies of an implicit run."""

    def __init__(
        self, model: Model, cells: Mechanics, interactions: Interactions, timing: Timing, threads: int
    ) -> None:
        assert model.heat is not None
        self._model, self._cells, self._interactions = model, cells, interactions
        usual = min(stage.duration for stage in model.stages) * model.solver.max_increment
        self.forming = HeatOfForming(model, timing, threads, usual)
        """What conducts and stores the heat."""
        self.tolerance = model.heat.tolerance
        """Largest error of the temperatures given to laws [K]."""
        self.passes: list[tuple[State, Sequence[Augmentation]]] = []
        """Where the last increment was in equilibrium, each time before heat was found, and where it took over
        multipliers before; kept for followers of the run."""
        self.mixtures = PhaseMixtures(model)
        """What the phases of a steel make of its points."""
        self._even = [_grows_evenly(model, block) for block in model.mesh.blocks]
        self._fraction = model.heat.plastic_fraction
        self._across = {name: tool.gap for name, tool in model.heat.tools.items()}
        self._contacts = {contact.name: contact for contact in model.contacts}

    def at_points(self, state: State, block: int) -> FloatArray:
        """Return the temperature at a block's points (n_cells, p) [degrees C]."""
        return self.forming.to_points(block, state[HeatArrays].temperature)

    def spread(self, state: State) -> None:
        """Give the nodes' temperatures to the integration points of materials that depend on them."""
        for i, given in enumerate(state.cells.temperature):
            if given.size:
                state.cells.temperature[i] = self._supply(i, state[HeatArrays].temperature)

    def begin_increment(self, state_n: State, trial: State, dt: float) -> None:
        """Give laws the temperatures that the last rate foretells for the end of an increment of dt [s]."""
        arrays = state_n[HeatArrays]
        for i, given in enumerate(trial.cells.temperature):
            if given.size:
                trial.cells.temperature[i] = self._supply(i, arrays.temperature + dt * arrays.rate)
        self.mixtures.find(state_n, trial, dt)

    def _supply(self, block: int, temperature: FloatArray) -> FloatArray:
        """Return temperatures of the nodes (n_points,) as the laws of a block's points take them (n_cells, p)."""
        degrees = self.forming.to_points(block, temperature)
        if self._even[block]:
            degrees[:] = degrees.mean(axis=1, keepdims=True)
        return degrees

    def rest(self, state: State, duration: float) -> HeatArrays:
        """Return the arrays after a time [s] in which the tools with meshes lie open without a workpiece.

        Raises GaveUpError where heat finds no balance.
        """
        return self.forming.rest(state[HeatArrays], self._points(state), self._poses(state), duration)

    def advance(self, state_n: State, trial: State, step: Step, dt: float) -> float | Failed:
        """Bring the temperatures of a trial state in equilibrium to the end of its increment of dt [s].

        Return by how much those given to laws were off at most [K], or why heat finds no balance.
        """
        found = self.forming.advance(state_n[HeatArrays], self._show(state_n, trial, step, dt), dt)
        if isinstance(found, Failed):
            return found
        trial.replace(found)
        before = list(trial.cells.temperature)
        self.spread(trial)
        self.mixtures.find(state_n, trial, dt)
        pairs = zip(before, trial.cells.temperature, strict=True)
        return max((float(np.abs(a - b).max()) for a, b in pairs if a.size), default=0.0)

    def _points(self, state: State) -> FloatArray:
        return self._model.mesh.points + state.nodes.moved

    def _poses(self, state: State) -> Poses:
        if not self.forming.dies.dies:  # which alone are placed by them
            return []
        placed = state[ToolArrays]
        return find_poses(self._model.plane_tools, placed.displacement, placed.angle)

    def _show(self, state_n: State, trial: State, step: Step, dt: float) -> FormingInstant:
        """Return what heat asks of an increment in equilibrium."""
        n, tools = len(self._model.mesh.points), self._interactions.tools
        shape = (len(self._model.tools), n)
        holds, push = np.zeros(shape, dtype=bool), np.zeros(shape)
        friction_work, gap = np.zeros(shape), np.full(shape, np.inf)
        if (space := self._interactions.space_tools) is not None:
            placed = trial[SpaceToolArrays]
            push = np.linalg.norm(placed.force - placed.friction, axis=2)
            holds, friction_work = push > 0.0, space.contact.lost_at(state_n, trial)
            for t, tool in enumerate(self._model.tools):
                width = self._across.get(tool.name, 0.0)
                if width > 0.0:
                    gap[t] = space.contact.placed(t, placed).nearest(self._points(trial), width)[0]
        elif self._model.plane_tools:
            contact = tools.contact
            held, pushes = contact.pushes(trial, self._interactions.supports.fixed(step.stage))
            holds[:, contact.nodes], push[:, contact.nodes] = held, np.maximum(pushes, 0.0)
            gap[:, contact.nodes] = contact.gap[::2]
            tool_at = np.argmax(trial[ContactArrays].status > 0, axis=0) // 2
            friction_work[tool_at, contact.nodes] = tools.friction.lost_at
        return FormingInstant(
            points=self._points(trial),
            poses=self._poses(trial),
            holds=holds,
            push=push,
            gap=gap,
            plastic=list(self._cells.plastic_heat_at_points(state_n, trial, dt, self._fraction)),
            friction_work=friction_work,
            stage=step.stage,
            between=self._show_bodies(state_n, trial),
        )

    def _show_bodies(self, state_n: State, trial: State) -> BetweenBodies:
        """Return how bodies press on each other and slide."""
        assert self._model.heat is not None
        entries = [self._contacts[entry.name] for entry in self._model.heat.contacts]
        arrays = trial[InterfaceArrays] if entries else None
        if arrays is None:
            return BetweenBodies({}, {}, trial.nodes.increment, 0.0)
        shear = np.linalg.norm(arrays.shear, axis=1) if arrays.shear.ndim == 2 else np.abs(arrays.shear)
        return BetweenBodies(
            pressure={contact.name: self._spread(contact, arrays.pressure) for contact in entries},
            shear={contact.name: self._spread(contact, shear) for contact in entries},
            moved=trial.nodes.increment,
            lost=self._interactions.bodies.work(state_n, trial)["friction_work"],
        )

    def _spread(self, contact: BodyContact, slots: FloatArray) -> FloatArray:
        """Return values at the slave's nodes (n_points,) from those of the slots of all contacts (n_slots,)."""
        nodal = np.zeros(len(self._model.mesh.points))
        interface = next(i for i in self._interactions.bodies.interfaces if i.contact is contact)
        nodal[interface.nodes] = slots[interface.places]
        if self._model.dimension == 2 and find_cell(1, interface.slave).is_quadratic:
            first, last, middle = interface.slave.T
            nodal[middle] = 0.5 * (nodal[first] + nodal[last])
        return nodal
