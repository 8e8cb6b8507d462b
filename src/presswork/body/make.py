# SPDX-License-Identifier: Apache-2.0
"""Choose what evaluates the cells of a model."""

from __future__ import annotations

from presswork.body.divided_shells import DividedShellMechanics
from presswork.body.divided_solids import DividedMechanics
from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.model import Model
from presswork.ranks.world import World
from presswork.timing import Timing


def make_mechanics(model: Model, timing: Timing, world: World | None = None) -> Mechanics | ShellMechanics:
    """Return what evaluates a model's cells. world: the ranks that share them, if there are several."""
    if model.analysis == "shell":
        return DividedShellMechanics(model, timing, world) if world else ShellMechanics(model, timing)
    return DividedMechanics(model, timing, world) if world else Mechanics(model, timing)
