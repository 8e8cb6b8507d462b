# SPDX-License-Identifier: Apache-2.0
"""The rigid tools of a plane or axisymmetric model: contact, friction, and the places of those that forces move."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Self

import numpy as np

from presswork.body.contract import Cells
from presswork.fields.contact_stress import ContactForces
from presswork.geometry.pose import ToolPose, start_centre, start_profile, to_tool_frame, turn_vectors
from presswork.geometry.segments import find_touch
from presswork.interaction.contract import Constraints, Factors, Forces, Point
from presswork.interaction.led import Tangent
from presswork.interaction.placing import Border, move_tools
from presswork.interaction.plane.floating_tools import Floating, FloatingTools
from presswork.interaction.plane.friction import Friction, FrictionForces
from presswork.interaction.plane.tool_contact import Contact
from presswork.interaction.supports import Supports
from presswork.interaction.tool_arrays import SLIDING, ContactArrays, ToolArrays
from presswork.interaction.tool_course import ToolCourse
from presswork.interaction.travelling import TravellingTools
from presswork.model import FloatArray, IntArray, Model, ToolMotion, find_direction
from presswork.outcome import GaveUpError, Step
from presswork.state import Arrays, State

TOO_DEEP = 1e-3
"""How deep a stage may put a tool into it, over the workpiece's size."""


class PlaneTools(TravellingTools):
    """Exact contact with rigid tools, as constraints of the nodes that they hold."""

    _arrays = ToolArrays

    def __init__(self, model: Model, cells: Cells, supports: Supports) -> None:
        self._model = model
        self._cells = cells
        self._supports = supports
        self.contact = Contact(model)
        self.friction = Friction(model, self.contact)
        self.floating = FloatingTools(model, self.contact)
        self._course = ToolCourse(model.plane_tools, model.stages, 2)
        self._held_by_supports: Constraints | None = None
        self._friction_forces: FrictionForces | None = None

    @property
    def softness(self) -> float:
        """How many times softer than they are the springs of friction are taken."""
        return self.friction.softness

    @softness.setter
    def softness(self, value: float) -> None:
        self.friction.softness = value

    @property
    def can_soften(self) -> bool:
        """Whether there is friction."""
        return self.friction.is_needed

    @property
    def has_consistent_tangent(self) -> bool:
        """Whether the tangent of friction is the consistent one."""
        return not self.friction.is_needed or self._model.solver.friction_tangent == "return_mapping"

    @property
    def n_undecided(self) -> int:  # type: ignore[override]
        """Nodes that may change no more in this increment, and pull."""
        return self.contact.n_undecided

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of tools that have not moved and touch nothing."""
        n_tools = len(self._model.plane_tools)
        touching = ContactArrays.at_rest(n_tools, len(self.contact.nodes))
        return ToolArrays.at_rest(n_tools), touching, *self.friction.sliding.at_rest()

    def surface_nodes(self) -> list[IntArray]:
        """Return the candidates for contact."""
        return [self.contact.nodes]

    def place(self, state_n: State, trial: State, step: Step, ratio: float) -> None:
        """Move the tools by their strokes; those that float go on as before."""
        self._course.place(state_n[ToolArrays], trial[ToolArrays], step.stage, step.fraction, ratio)

    def begin_stage(self, state: State, stage: int) -> bool:
        """Place the tools that a stage places anew; what they held is released over the first increment."""
        placed, held = state[ToolArrays], state[ContactArrays]
        releases = False
        for t, target in self._course.find_jumps(placed, stage, functools.partial(self._travel_to_touch, state)):
            faces = slice(2 * t, 2 * t + 2)
            forces = self.contact.forces(state, self._supports.fixed(stage - 1))
            own = forces.tool == t
            nodes = forces.nodes[own]
            state.nodes.external_force[nodes] += forces.force[own]
            held.status[faces], held.drag[np.isin(self.contact.nodes, nodes)] = 0, 0.0
            placed.force[t], placed.force_start[t] = 0.0, 0.0
            self._course.jump(placed, t, target)
            self._check_clear(state, t)
            releases |= len(nodes) > 0
        return releases

    def _check_clear(self, state: State, t: int) -> None:
        """Refuse a tool that a stage has put into the workpiece."""
        nodes = self._model.mesh.points[self.contact.nodes] + state.nodes.displacement[self.contact.nodes]
        depth = -float(self.contact.find_gaps(state, nodes)[t].min(initial=np.inf))
        if depth > TOO_DEEP * float(np.ptp(nodes, axis=0).max()):
            raise GaveUpError(
                f"{self._model.plane_tools[t].name!r} is put {depth:.4g} mm into the workpiece when its stage begins; "
                'give a position beside it, or position = "touch"'
            )

    def _travel_to_touch(self, state: State, t: int, motion: ToolMotion) -> FloatArray:
        """Return how far a tool goes along its direction until it touches the workpiece (2,) [mm]."""
        if (state[ContactArrays].status[2 * t : 2 * t + 2] > 0).any():
            return np.zeros(2)
        placed = state[ToolArrays]
        tool = self._model.plane_tools[t]
        direction = find_direction(motion, 2)
        nodes = self._model.mesh.points[self.contact.nodes] + state.nodes.displacement[self.contact.nodes]
        pose = ToolPose(start_centre(tool), placed.displacement[t], float(placed.angle[t]))
        gone = find_touch(to_tool_frame(nodes, pose), start_profile(tool), turn_vectors(direction, -pose.angle))
        if gone is None:
            raise GaveUpError(
                f'the tool {tool.name!r} has position = "touch", but along its path it passes the workpiece: give '
                "position = [x, y]"
            )
        return gone * direction

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Forget the changes of the increment before; take the flow stress that friction asks for."""
        self.contact.begin_increment(state_n)
        self.floating.begin_increment()
        if self.friction.is_needed:
            flow_stress = self._cells.nodal_flow_stress(state_n)
            self.friction.begin_increment(state_n, flow_stress, self._cells.nodal_temperature(state_n))

    def update(self, trial: State, point: Point, own: Forces | None, *, near: bool, pull: float) -> int:
        """Hold nodes inside tools; near equilibrium release those that pull."""
        self.contact.search(trial, point.guess.displacement)
        fixed = self._supports.fixed(point.guess.step.stage)
        return self.contact.update(trial, point.reaction, self.friction.drag, fixed, near=near, tolerance=pull)

    def hold_like(self, other: Self, trial: State, held: State, displacement: FloatArray) -> None:
        """Hold the nodes that another run holds, and let the same part of constant shear act on them."""
        own, found = trial[ContactArrays], held[ContactArrays]
        own.status, own.shear_part = found.status.copy(), found.shear_part.copy()
        trial[ToolArrays].gives = held[ToolArrays].gives.copy()
        self.contact.search(trial, displacement)

    def _directions(self, stage: int) -> dict[int, FloatArray]:
        return self.floating.directions(stage)

    def find_missing(self, trial: State, point: Point, own: Any) -> FloatArray:
        """Return what the tools that float lack (n,) [N]; constraints and friction are those found last."""
        if not self.floating.is_needed:
            return np.zeros(0)
        step, supports = point.guess.step, self._held_by_supports
        assert supports is not None
        return self.floating.find_missing(
            trial, point.reaction, self._friction_forces, supports, step.stage, step.fraction
        )

    def find_border(self, trial: State, point: Point, own: Any, tangent: Tangent) -> Border | None:
        """Return the equations of the tools that float."""
        if not self.floating.directions(point.guess.step.stage):
            return None
        assert self._held_by_supports is not None
        return self.floating.find_border(
            trial, self._friction_forces, self._held_by_supports, point.guess.step, tangent
        )

    def hold_anew(self, state: State, held: State) -> None:
        """Hold the nodes that another run holds on its new mesh, where they are."""
        state[ContactArrays].status = np.minimum(held[ContactArrays].status, SLIDING)
        self.contact.stick_nodes(state)

    def constrain(self, state_n: State, trial: State, point: Point, held: Constraints) -> Constraints:
        """Hold the nodes in contact on their tools."""
        self._held_by_supports = held
        return self.contact.constrain(trial, point.guess.displacement, held)

    def resist(self, state_n: State, trial: State, point: Point, constraints: Constraints) -> FrictionForces | None:
        """Return the friction of the nodes that are held along the normal alone."""
        if not self.friction.is_needed:
            return None
        free = constraints.turned == 1
        self._friction_forces = self.friction.evaluate(state_n, trial, point.guess.displacement, point.reaction, free)
        return self._friction_forces

    def find_area_blocks(
        self, point: Point, own: Forces | None, resistance: FrictionForces | None
    ) -> tuple[IntArray, FloatArray]:
        """Return how friction depends on the areas of edges."""
        return resistance.find_area_blocks() if resistance else super().find_area_blocks(point, own, resistance)

    def tune(self, trial: State, point: Point, *, pull: float, credible: float) -> int:
        """Find better parts of constant shear where nodes neither push nor lift off.

        In equilibrium release those that a body would follow a tool by.
        """
        fixed, drag = self._supports.fixed(point.guess.step.stage), self.friction.drag
        grazing = self.contact.graze(trial, point.reaction, drag, fixed, tolerance=pull, credible=credible)
        if grazing or credible > pull:
            return grazing
        return self.contact.release_idle(trial, point.reaction, fixed, pull)

    def border(
        self, trial: State, point: Point, own: Forces | None, resistance: Any, *, near: bool
    ) -> tuple[Floating | None, int]:
        """Return the tools that float at a guess, and how many springs have left or reached their stops."""
        if not self.floating.is_needed:
            return None, 0
        assert self._held_by_supports is not None
        step = point.guess.step
        return self.floating.evaluate(
            trial, point.reaction, resistance, self._held_by_supports, step.stage, step.fraction, near=near
        )

    def correct(
        self, border: Floating, own: Forces | None, resistance: Any, solution: FloatArray, factors: Factors
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction with the travel of the floating tools in it, and that travel [mm]."""
        return self.floating.correct(border, resistance, factors.matrix(), solution, factors.respond_in_frames)

    def move(self, trial: State, border: Floating, travel: FloatArray) -> None:
        """Move the floating tools by their travel [mm]."""
        move_tools(trial[ToolArrays], border, travel)

    def end_increment(self, state_n: State, trial: State, own: Forces | None, constraints: Constraints) -> None:
        """Keep the friction of a converged state."""
        self.friction.end_increment(state_n, trial, constraints.turned == 1)

    def commit(self, state_n: State, trial: State, step: Step) -> None:
        """Let nodes on sticking tools stick; keep the tools' forces and travel."""
        placed = trial[ToolArrays]
        self.contact.stick_nodes(trial)
        placed.travel_increment = placed.travel - state_n[ToolArrays].travel
        forces, torques = self.contact.tool_forces(trial, self._supports.fixed(step.stage))
        placed.force = np.column_stack([forces, torques])
        self.friction.commit(state_n, trial, step.dt)

    def forces(self, state: State, stage: int) -> ContactForces:
        """Return what each tool does to the nodes that it holds in a stage, with the factors of its friction there."""
        found = self.contact.forces(state, self._supports.fixed(stage))
        if not self.friction.has_factors:
            return found
        factors = self.friction.find_factors(state, self._cells.nodal_temperature(state))
        place = np.searchsorted(self.contact.nodes, found.nodes)
        return replace(found, factor=factors[found.tool, place])

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return the work of the tools by their own motion, and what friction takes [N mm]."""
        before, now = state_n[ToolArrays], trial[ToolArrays]
        moved = np.column_stack([now.displacement - before.displacement, now.angle - before.angle])
        return {
            "external_work": -0.5 * float(((before.force + now.force) * moved).sum()),
            "friction_work": self.friction.lost,
        }

    def stop(self, state: State, stage: int, fraction: float) -> None:
        """Let the tools rest where they are at a fraction of a stage's travel: later stages count from its end."""
        self._course.stop(state[ToolArrays], stage, fraction)

    def end_stage(self, state: State, next_stage: int) -> None:
        """Keep the force on each tool from which a push of the next stage begins."""
        placed = state[ToolArrays]
        placed.force_start = placed.force[:, :2].copy()
