# SPDX-License-Identifier: Apache-2.0
"""The rigid tools of a model in space, a sheet's drawbeads, and the places of those that forces push."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.interaction.contract import Factors, Guess, Interaction, Point, turn, turn_back
from presswork.interaction.placing import move_tools
from presswork.interaction.pushed_space_tools import Pushed, PushedSpaceTools
from presswork.interaction.sheet_contact import SheetContact
from presswork.interaction.solid_contact import SolidContact
from presswork.interaction.space_contact import SpaceForces
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import FloatArray, Model
from presswork.outcome import Step
from presswork.state import Arrays, State


class SpaceTools(Interaction):
    """Contact of nodes with tools in space."""

    def __init__(self, model: Model, cells: Mechanics | ShellMechanics) -> None:
        self._model = model
        self.contact = SolidContact(model, cells) if isinstance(cells, Mechanics) else SheetContact(model)
        self.pushed = PushedSpaceTools(model)

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of tools and beads that have not moved and touch nothing."""
        return self.contact.at_rest()

    def place(self, state_n: State, trial: State, step: Step, ratio: float) -> None:
        """Move the tools by their strokes; those that forces push go on as before."""
        placed = trial[SpaceToolArrays]
        pushed = self.pushed.numbers(step.stage)
        placed.travel[pushed] += ratio * state_n[SpaceToolArrays].travel_increment[pushed]
        placed.displacement = self.contact.move(step.stage, step.fraction) + placed.travel

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Take what belongs to the nodes as it is when the increment begins."""
        self.contact.begin_increment(state_n)

    def give_up_guess(self, state_n: State, trial: State) -> None:
        """Put the pushed tools back to where the increment began."""
        placed, placed_n = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        placed.displacement -= placed.travel - placed_n.travel
        placed.travel = placed_n.travel.copy()

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> SpaceForces:
        """Return the forces of tools and beads on the nodes."""
        step = guess.step
        return self.contact.evaluate(state_n, trial, guess.displacement, step.stage, step.fraction)

    def border(self, trial: State, point: Point, own: Any, resistance: Any, *, near: bool) -> tuple[Pushed | None, int]:
        """Return the pushed tools at a guess."""
        if not self.pushed.is_needed:
            return None, 0
        step = point.guess.step
        return self.pushed.evaluate(trial, own, step.stage, step.fraction), 0

    def correct(
        self, border: Pushed, own: Any, resistance: Any, solution: FloatArray, factors: Factors
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction with the travel of the pushed tools in it, and that travel [mm]."""
        held = factors.constraints
        found, travel = self.pushed.correct(border, own, turn_back(held, solution), factors.respond)
        return turn(held, found), travel

    def move(self, trial: State, border: Pushed, travel: FloatArray) -> None:
        """Move the pushed tools by their travel [mm]."""
        move_tools(trial[SpaceToolArrays], border, travel)

    def augment(self, trial: State, own: Any) -> bool:
        """Take multipliers over in equilibrium if they are not good enough yet."""
        return self.contact.augment(own)

    def settle(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep the forces of tools and beads."""
        self.contact.settle(trial, own)

    def commit(self, state_n: State, trial: State, step: Step) -> None:
        """Keep the travel of the increment."""
        placed = trial[SpaceToolArrays]
        placed.travel_increment = placed.travel - state_n[SpaceToolArrays].travel

    def stop(self, state: State, stage: int, fraction: float) -> None:
        """Let the tools rest where they are at a fraction of a stage's way: later stages count from its end."""
        placed = state[SpaceToolArrays]
        placed.travel -= self.contact.move(stage, 1.0) - self.contact.move(stage, fraction)
        placed.displacement = self.contact.move(stage, 1.0) + placed.travel

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return the work of tools and beads by their own motion, and what friction takes [N mm]."""
        of_tools, lost = self.contact.work(state_n, trial)
        return {"external_work": of_tools, "friction_work": lost}

    def stored(self, state: State) -> float:
        """Return the energy of the normal forces [N mm]."""
        return state[SpaceToolArrays].energy
