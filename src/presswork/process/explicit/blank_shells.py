# SPDX-License-Identifier: Apache-2.0
"""The shells of an explicit stamping on one mesh."""

from __future__ import annotations

from typing import Literal

import numpy as np

from presswork.evolution.damage import make_damage
from presswork.explicit.blocks import Shells
from presswork.explicit.device import refuse
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.space import choose_precision
from presswork.law.elastic_plastic import heats
from presswork.law.umat import open_sheet_law
from presswork.mesh.pressed_cells import find_pressed_cells, find_side
from presswork.mesh.topology import with_four_nodes
from presswork.model import ExplicitSheet, IntArray, Model
from presswork.process.explicit.intervals import weigh_nodes
from presswork.process.mesh_change.transfer import ShellStart
from presswork.process.stamping_tools import share_pressures, tabulate_pressure
from presswork.ranks.world import World


def find_precision(model: Model) -> Literal["double", "single"]:
    """Return the precision of the shells: that of the case, or the one that suits their law."""
    assert isinstance(model.explicit, ExplicitSheet)
    if model.explicit.precision:
        return model.explicit.precision
    found = {choose_precision(open_sheet_law(material)) for material in model.sheet_materials}
    return "single" if found == {"single"} else "double"


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


def _list_zones(model: Model, settings: ExplicitSheet, start: ShellStart | None) -> list[Shells]:
    """Return the shells of each zone of the blank, in the order of its cells."""
    zones, first, every_relief = [], 0, np.concatenate(model.find_relief())
    for blocks in model.blocks_of_zones:
        section, material = blocks[0].section, model.materials[blocks[0].material]
        assert section is not None
        assert section.rule != "simpson"
        cells = np.concatenate([with_four_nodes(block.connectivity) for block in blocks])
        own = slice(first, first + len(cells))
        first = own.stop
        zones.append(
            Shells(
                connectivity=cells,
                thickness=np.concatenate([b.thickness for b in blocks]) if start is None else start.thickness[own],
                law=open_sheet_law(material),
                density=material.density,
                axis=np.asarray(blocks[0].rolling or model.rolling_direction) if start is None else start.axis[own],
                damage=make_damage(material.damage, material.umat, is_solid=False),
                heating=(material.heating.start if material.heating else 20.0, heats(material)),
                relief=every_relief[own] if every_relief.any() else (),
                options=ShellOptions(
                    element=settings.element, n_points=section.points, rule=section.rule, ironing=settings.ironing
                ),
            )
        )
    return zones


def make_shells(
    model: Model,
    start: ShellStart | None,
    hanging: IntArray,
    world: World | None,
) -> ExplicitShells:
    """Return the shells of the undeformed mesh as it is split now.

    start: where they begin; None: as the blank. hanging: nodes as SplitMesh has them.
    world: ranks that share the cycles.
    """
    settings = model.explicit
    assert isinstance(settings, ExplicitSheet)
    if model.refinement:
        refuse(settings.device, "refined sheets")
    if model.zones:
        refuse(settings.device, "zones of a blank")
    shells = ExplicitShells.of_zones(
        model.mesh.points if start is None else start.position,
        _list_zones(model, settings, start),
        precision=find_precision(model),
        device=settings.device,
        hanging=hanging,
        world=world,
    )
    add_pressures(model, shells)
    if model.gravity:
        shells.force = weigh_nodes(shells.mass[:, 0], model.gravity, shells.force.shape[1])
    return shells
