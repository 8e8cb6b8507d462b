# SPDX-License-Identifier: Apache-2.0
"""All interactions of one model."""

from __future__ import annotations

from collections.abc import Sequence

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.interaction.bodies.body_contact import BodyContacts
from presswork.interaction.bodies.laps import LapMarks
from presswork.interaction.bodies.sheet_on_itself import SheetOnItself
from presswork.interaction.contract import Interaction
from presswork.interaction.cyclic import CyclicTies
from presswork.interaction.gravity import Gravity
from presswork.interaction.inertia import Inertia
from presswork.interaction.loads import Loads
from presswork.interaction.loose_bodies import LooseBodies
from presswork.interaction.plane.plane_tools import PlaneTools
from presswork.interaction.sheet_pressure import SheetPressures
from presswork.interaction.shell_loads import ShellLoads
from presswork.interaction.space.space_tools import SpaceTools
from presswork.interaction.supports import Supports
from presswork.model import Model


class Interactions:
    """What acts on the nodes of a model, by name for those who ask, and as one list for Newton's method."""

    def __init__(
        self,
        model: Model,
        cells: Mechanics | ShellMechanics,
        others: Sequence[Interaction] = (),
        before: Interactions | None = None,
    ) -> None:
        """others: of one's own. before: of the same run on the mesh before."""
        self.loads: Loads | ShellLoads
        if isinstance(cells, ShellMechanics):
            self.supports = Supports(model, cells.directors.smooth, cells.directors.node)
            self.loads = ShellLoads(model, cells.directors, self.supports)
        else:
            self.supports = Supports(model)
            self.loads = Loads(model, self.supports)
        self.bodies = BodyContacts(model, cells)
        self.tools = PlaneTools(model, cells, self.supports)
        tools_n = before.space_tools if before else None
        self.space_tools: SpaceTools | None = (
            SpaceTools(model, cells, tools_n) if model.space_tools or model.beads else None
        )
        self.self_contact = (
            SheetOnItself(model, cells) if model.self_contact and isinstance(cells, ShellMechanics) else None
        )
        self.inertia = Inertia(model) if model.solver.inertia > 0.0 else None
        self.loose = None if self.inertia else LooseBodies(model, self.supports)
        self.all: tuple[Interaction, ...] = (
            self.supports,
            self.loads,
            *((Gravity(model),) if model.gravity else ()),
            *((SheetPressures(model),) if model.sheet_pressures else ()),
            *((self.loose,) if self.loose else ()),
            *((self.bodies,) if model.contacts else ()),
            *((LapMarks(model, self.bodies),) if model.remeshing is not None else ()),
            *((CyclicTies(model, cells),) if model.cyclic and isinstance(cells, Mechanics) else ()),
            *((self.tools,) if model.plane_tools else ()),
            *((self.space_tools,) if self.space_tools else ()),
            *((self.self_contact,) if self.self_contact else ()),
            *((self.inertia,) if self.inertia else ()),
            *others,
        )
        """All of them in the order of the calls: what holds comes after what pushes."""
