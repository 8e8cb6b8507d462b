# SPDX-License-Identifier: Apache-2.0
"""The rigid tools of a model in space, a sheet's drawbeads, and the places of those that forces push."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.geometry.touch_in_space import Nearest, find_touch_in_space
from presswork.interaction.contract import Factors, Guess, Point, turn, turn_back
from presswork.interaction.led import Tangent
from presswork.interaction.placing import Border, move_tools
from presswork.interaction.space.floating_space_tools import FloatingInSpace, FloatingSpaceTools
from presswork.interaction.space.sheet_contact import SheetContact
from presswork.interaction.space.solid_contact import SolidContact
from presswork.interaction.space.space_contact import SpaceForces
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.interaction.tool_course import ToolCourse
from presswork.interaction.travelling import TravellingTools
from presswork.model import FloatArray, IndexArray, IntArray, Model, ToolMotion, find_direction
from presswork.outcome import GaveUpError, Step
from presswork.state import Arrays, State

TOO_DEEP = 1e-3
"""How deep a stage may put a tool into it, over the workpiece's size."""


class SpaceTools(TravellingTools):
    """Contact of nodes with tools in space."""

    _arrays = SpaceToolArrays

    def __init__(self, model: Model, cells: Mechanics | ShellMechanics, before: SpaceTools | None = None) -> None:
        """before: the same tools of the run on the mesh before, whose surfaces a solid's contact takes over."""
        self._model = model
        contact_n = before.contact if before else None
        self.contact: SolidContact | SheetContact = (
            SolidContact(model, cells, contact_n) if isinstance(cells, Mechanics) else SheetContact(model, cells)
        )
        self.floating = FloatingSpaceTools(model)
        self._course = ToolCourse(model.space_tools, model.stages, 3)
        self._rounding = 0.0

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of tools and beads that have not moved and touch nothing."""
        return self.contact.at_rest()

    def place(self, state_n: State, trial: State, step: Step, ratio: float) -> None:
        """Move the tools by their strokes; those that float go on as before."""
        self._course.place(state_n[SpaceToolArrays], trial[SpaceToolArrays], step.stage, step.fraction, ratio)

    def begin_stage(self, state: State, stage: int) -> bool:
        """Place the tools that a stage places anew; what they held is released over the first increment."""
        placed, releases = state[SpaceToolArrays], False
        for t, target in self._course.find_jumps(placed, stage, functools.partial(self._travel_to_touch, state)):
            releases |= bool(placed.force[t].any())
            state.nodes.external_force[:, :3] += placed.force[t]
            placed.force[t], placed.friction[t], placed.force_start[t] = 0.0, 0.0, 0.0
            self._course.jump(placed, t, target)
            name, nearest = self._model.space_tools[t].name, self.contact.placed(t, placed).nearest
            check_clear(name, self._outside(state), nearest)
        return releases

    def _travel_to_touch(self, state: State, t: int, motion: ToolMotion) -> FloatArray:
        """Return how far a tool goes along its direction until it touches the workpiece (3,) [mm]."""
        placed, tool = state[SpaceToolArrays], self._model.space_tools[t]
        if placed.force[t].any():
            return np.zeros(3)
        nearest = self.contact.placed(t, placed).nearest
        return find_travel_to_touch(tool.name, nearest, self._outside(state), find_direction(motion))

    def _outside(self, state: State) -> FloatArray:
        """Return where the nodes on the boundary are (n, 3) [mm]."""
        outside = np.unique(self._model.mesh.boundary_faces)
        return np.asarray(self._model.mesh.points[outside] + state.nodes.displacement[outside, :3])

    def held_directions(self, state: State, stage: int, *, lying: bool) -> tuple[IndexArray, FloatArray]:
        """Return nodes (n,) and vectors (n, 3) along which tools hold them in a stage.

        lying: nodes that lie on tools are held, too, pushed or not.
        """
        pushed_along = {t: np.array(push.direction) for t, push in self.floating.pushes(stage).items()}
        pushed_along = pushed_along if self._model.analysis == "solid" else {}
        return self.contact.held_directions(state, pushed_along, self._rounding, lying=lying)

    def lead(self, state_n: State, trial: State, guess: FloatArray) -> FloatArray:
        """Return a first guess with the nodes of a sheet where the tools push on them as they did."""
        return self.contact.lead(state_n, trial, guess) if isinstance(self.contact, SheetContact) else guess

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Take what belongs to the nodes as it is when the increment begins."""
        self.floating.begin_increment()
        self.contact.begin_increment(state_n)

    def discard_guess(self, state_n: State, trial: State) -> None:
        """Put the floating tools back to where the increment began."""
        placed, placed_n = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        placed.displacement -= placed.travel - placed_n.travel
        placed.travel, placed.gives = placed_n.travel.copy(), placed_n.gives.copy()

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> SpaceForces:
        """Return the forces of tools and beads on the nodes."""
        step = guess.step
        return self.contact.evaluate(state_n, trial, guess.displacement, step.stage, step.fraction)

    def predict(self, found: Any, change: FloatArray) -> None:
        """Take note of a correction that is about to be evaluated."""
        self.contact.predict(found)

    def update(self, trial: State, point: Point, own: Any, *, near: bool, pull: float) -> int:
        """Take the force that counts as none."""
        self._rounding = pull
        return 0

    def tune(self, trial: State, point: Point, *, pull: float, credible: float) -> int:
        """Return how many nodes the tangent of the law of contact still pushes otherwise than the law."""
        own = next(f for f in point.forces if isinstance(f, SpaceForces))
        return self.contact.count_undecided(trial, own, point.guess.displacement, pull)

    def border(
        self, trial: State, point: Point, own: Any, resistance: Any, *, near: bool
    ) -> tuple[FloatingInSpace | None, int]:
        """Return the tools that float at a guess, and how many springs have left or reached their stops."""
        if not self.floating.is_needed:
            return None, 0
        step = point.guess.step
        return self.floating.evaluate(trial, own, step.stage, step.fraction, near=near)

    def find_columns(self, border: FloatingInSpace, own: Any) -> Sequence[FloatArray]:
        """Return the forces on the nodes for each mm of travel of the floating tools."""
        return self.floating.find_columns(border, own)

    def correct(
        self, border: FloatingInSpace, own: Any, resistance: Any, solution: FloatArray, factors: Factors
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction with the travel of the floating tools in it, and that travel [mm]."""
        held = factors.constraints
        found, travel = self.floating.correct(border, own, turn_back(held, solution), factors.responses)
        return turn(held, found), travel

    def move(self, trial: State, border: FloatingInSpace, travel: FloatArray) -> None:
        """Move the floating tools by their travel [mm]."""
        move_tools(trial[SpaceToolArrays], border, travel)

    def hold_like(self, other: Self, trial: State, held: State, displacement: FloatArray) -> None:
        """Let the faces shear that shear in another run, and the springs give that give there."""
        self.contact.touch_like(other.contact)
        trial[SpaceToolArrays].gives = held[SpaceToolArrays].gives.copy()

    def _directions(self, stage: int) -> dict[int, FloatArray]:
        return self.floating.directions(stage)

    def find_missing(self, trial: State, point: Point, own: Any) -> FloatArray:
        """Return what the tools that float lack (n,) [N]. Raises GaveUpError where one stands on its stop."""
        step = point.guess.step
        return self.floating.find_missing(trial, own, step.stage, step.fraction)

    def find_border(self, trial: State, point: Point, own: Any, tangent: Tangent) -> Border | None:
        """Return the equations of the tools that float."""
        stage = point.guess.step.stage
        if not self.floating.directions(stage):
            return None
        return self.floating.find_border(trial, own, stage, tangent.answer)

    def find_area_blocks(self, point: Point, own: Any, resistance: Any) -> tuple[IntArray, FloatArray]:
        """Return how friction depends on the areas of faces."""
        return self.contact.find_area_blocks(self._model.mesh.points + point.guess.displacement[:, :3], own)

    def augment_like(self, trial: State, own: Any) -> None:
        """Take multipliers over as another run has done."""
        self.contact.take_over(own)

    def augment(self, trial: State, own: Any) -> bool:
        """Take multipliers over in equilibrium if they are not good enough yet."""
        return self.contact.augment(own)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep the forces of tools and beads; a tool that leaves, and only touches by rounding, has none."""
        self.contact.end_increment(trial, own)
        placed, placed_n = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        moved = placed.displacement - placed_n.displacement
        leaves = np.einsum("tni,ti->t", placed.force, moved) < 0.0
        leaves &= np.linalg.norm(placed.force, axis=2).max(axis=1, initial=0.0) <= self._rounding
        placed.force[leaves], placed.friction[leaves] = 0.0, 0.0

    def commit(self, state_n: State, trial: State, step: Step) -> None:
        """Keep the travel of the increment."""
        placed = trial[SpaceToolArrays]
        placed.travel_increment = placed.travel - state_n[SpaceToolArrays].travel
        self.contact.commit(state_n, trial, step.dt)

    def stop(self, state: State, stage: int, fraction: float) -> None:
        """Let the tools rest where they are at a fraction of a stage's travel: later stages count from its end."""
        self._course.stop(state[SpaceToolArrays], stage, fraction)

    def end_stage(self, state: State, next_stage: int) -> None:
        """Keep the force on each tool from which a push of the next stage begins."""
        state[SpaceToolArrays].force_start = self.contact.tool_forces(state)

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return the work of tools and beads by their own motion, and what friction takes [N mm]."""
        of_tools, lost = self.contact.work(state_n, trial)
        return {"external_work": of_tools, "friction_work": lost}

    def stored(self, state: State) -> float:
        """Return the energy of the normal forces [N mm]."""
        return state[SpaceToolArrays].energy


def find_travel_to_touch(name: str, nearest: Nearest, outside: FloatArray, direction: FloatArray) -> FloatArray:
    """Return how far a tool goes along a unit vector (3,) until it touches the workpiece (3,) [mm].

    outside: nodes on the boundary (n, 3) [mm]. Raises GaveUpError where it never does.
    """
    gone = find_touch_in_space(nearest, outside, direction)
    if gone is None:
        raise GaveUpError(
            f'the tool {name!r} has position = "touch", but along its path it passes the workpiece: give '
            "position = [x, y, z]"
        )
    return gone * direction


def check_clear(name: str, outside: FloatArray, nearest: Nearest) -> None:
    """Raise GaveUpError for a tool that a stage has put into the workpiece; outside: nodes on the boundary (n, 3)."""
    depth = -float(nearest(outside, 0.0)[0].min())
    if depth > TOO_DEEP * float(np.ptp(outside, axis=0).max()):
        raise GaveUpError(
            f"{name!r} is put {depth:.4g} mm into the workpiece when its stage begins; give a position beside it, or "
            'position = "touch"'
        )
