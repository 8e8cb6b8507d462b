# SPDX-License-Identifier: Apache-2.0
"""Fields of solids: effective stress, and contact at the nodes from the forces of tools and bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from presswork.fields.contact_stress import BodyTraction, ContactForces
from presswork.fields.instant import NodalContact
from presswork.fields.tool_stress import recover_tool_stress, shear_strength
from presswork.model import FloatArray, Model


def effective_stress(stress: FloatArray) -> FloatArray:
    """Return the von Mises stress of xx, yy, zz, xy (..., 4), in space also yz, zx (..., 6)."""
    sxx, syy, szz, *shears = np.moveaxis(stress, -1, 0)
    squares: FloatArray = 0.5 * ((sxx - syy) ** 2 + (syy - szz) ** 2 + (szz - sxx) ** 2)
    for shear in shears:
        squares = squares + 3 * shear**2
    return np.asarray(np.sqrt(squares))


def find_contact(
    model: Model,
    displacement: FloatArray,
    contact: ContactForces,
    flow_stress: FloatArray,
    between_bodies: BodyTraction | None = None,
) -> NodalContact:
    """Return the contact at the nodes from the forces of tools.

    displacement: of the nodes (n_points, 2) [mm]. flow_stress: of the material at the nodes (n_points,) [MPa].
    between_bodies: what the bodies do to each other is added.
    """
    n = len(model.mesh.points)
    stress = recover_tool_stress(model, model.mesh.points + displacement, contact, flow_stress)
    force = np.zeros((n, 3))
    np.add.at(force[:, :2], contact.nodes, contact.force)
    pressure, shear = stress.pressure, stress.shear
    if between_bodies is not None:
        strength = shear_strength(model, flow_stress)
        between = between_bodies.pressure, np.clip(between_bodies.shear, -strength, strength)
        pressure, shear = np.where(between[0] != 0, between, (pressure, shear))
        force[:, :2] += between_bodies.force
    return NodalContact(
        gap=contact.gap,
        status=contact.status.astype(np.float64),
        pressure=pressure,
        shear=shear,
        friction_limit=stress.friction_limit,
        traction={tool.name: stress.traction[i] for i, tool in enumerate(model.plane_tools)},
        total_traction=stress.traction.sum(axis=0),
        force=force,
    )


def add_bodies(find_contact: Callable[[], NodalContact] | None, between_bodies: BodyTraction) -> NodalContact:
    """Return the contact at the nodes of solids in space: what bodies do to each other, and tools if there are any."""
    n = len(between_bodies.pressure)
    if find_contact is not None:
        found = find_contact()
    else:
        none, no_force = np.zeros(n), np.zeros((n, 3))
        found = NodalContact(np.full(n, np.nan), none, none, none, none, {}, no_force, no_force)
    touched = between_bodies.pressure != 0.0
    return replace(
        found,
        pressure=np.where(touched, between_bodies.pressure, found.pressure),
        shear=np.where(touched, between_bodies.shear, found.shear),
        force=found.force + between_bodies.force,
    )
