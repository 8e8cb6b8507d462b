# SPDX-License-Identifier: Apache-2.0
"""The shells of an explicit stamping on one mesh."""

from __future__ import annotations

from typing import Literal

import numpy as np

from presswork.evolution.damage import DamageLaw
from presswork.explicit.device import refuse
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.space import choose_precision
from presswork.law.elastic_plastic import heats
from presswork.law.umat import open_sheet_law
from presswork.mesh.pressed_cells import find_pressed_cells, find_side
from presswork.model import ExplicitSheet, IntArray, Model
from presswork.process.explicit.intervals import weigh_nodes
from presswork.process.mesh_change.transfer import ShellStart
from presswork.process.stamping_tools import share_pressures, tabulate_pressure
from presswork.ranks.world import World


def find_precision(model: Model) -> Literal["double", "single"]:
    """Return the precision of the shells: that of the case, or the one that suits their law."""
    assert isinstance(model.explicit, ExplicitSheet)
    return model.explicit.precision or choose_precision(open_sheet_law(model.sheet[1]))


def add_pressures(model: Model, shells: ExplicitShells) -> None:
    """Let the pressures of a model act on its shells, a fluid in the part of its space that is modelled."""
    points, cells = model.mesh.points, model.cells
    for pressure in share_pressures(model):
        times, values = tabulate_pressure(model, pressure.name)
        fluid = pressure.fluid
        if fluid is not None:
            values = fluid.room + values / model.whole
        pressed = cells[find_pressed_cells(points, cells, pressure)]
        shells.add_pressure(pressure.name, pressed, find_side(points, cells, pressure.face), (times, values), fluid)


def make_shells(
    model: Model,
    start: ShellStart | None,
    hanging: IntArray,
    damage: tuple[DamageLaw, ...],
    world: World | None,
) -> ExplicitShells:
    """Return the shells of the undeformed mesh as it is split now.

    start: where they begin; None: as the blank. hanging: nodes as SplitMesh has them.
    damage: laws that follow it; world: ranks that share the cycles.
    """
    settings = model.explicit
    assert isinstance(settings, ExplicitSheet)
    section, material = model.sheet
    assert section.rule != "simpson"
    if model.refinement:
        refuse(settings.device, "refined sheets")
    rolling = np.asarray(model.rolling_direction)
    shells = ExplicitShells(
        model.mesh.points if start is None else start.position,
        model.cells,
        section.thickness if start is None else start.thickness,
        open_sheet_law(material),
        material.density,
        axis=rolling if start is None else start.axis,
        damage=damage,
        heating=(material.heating.start if material.heating else 20.0, heats(material)),
        options=ShellOptions(
            element=settings.element, n_points=section.points, rule=section.rule, ironing=settings.ironing
        ),
        precision=find_precision(model),
        device=settings.device,
        hanging=hanging,
        world=world,
    )
    add_pressures(model, shells)
    if model.gravity:
        shells.force = weigh_nodes(shells.mass[:, 0], model.gravity, shells.force.shape[1])
    return shells
