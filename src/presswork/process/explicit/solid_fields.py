# SPDX-License-Identifier: Apache-2.0
"""What fields and limits of an explicit run of solids are computed from."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from presswork.fields.instant import Instant, SolidPoints
from presswork.fields.solid_fields import add_bodies, effective_stress
from presswork.model import FloatArray
from presswork.observe.contract import Metal

if TYPE_CHECKING:
    from presswork.process.explicit.forming import ExplicitForming


def show_solids(run: ExplicitForming) -> Instant:
    """Return what the fields of the present state are computed from; a cell has one point."""
    solids, model = run.solids, run.model
    heats = run.heat is not None or any(material.heating for material in model.materials)
    by_tools = sum((wall.nodal_force for wall in run.walls), start=np.zeros_like(model.mesh.points))
    between = run.contacts.find_traction(by_tools)
    return Instant(
        model,
        solids.position - model.mesh.points,
        velocity=solids.velocity,
        reaction=run.reactions(),
        tool_force=by_tools,
        find_contact=partial(add_bodies, None, between) if between else None,
        points=SolidPoints(
            stress=run.split(solids.stress[:, None]),
            eqps=run.split(solids.equivalent_plastic_strain[:, None]),
            volume=run.split(np.ones((len(solids.stress), 1))),
            user=solids.points if run.has_pores else (),
            kept=solids.kept,
            temperature=solids.temperature if heats else None,
        ),
        evolved={**solids.damage, **run.points.values},
        temperature=run.heat.arrays.temperature if run.heat else None,
    )


def find_metal(run: ExplicitForming) -> Metal:
    """Return the cells; with UMATs there is no flow stress to which a mean pressure could be compared."""
    model, solids = run.model, run.solids
    centres = np.concatenate([solids.position[b.connectivity].mean(axis=1) for b in model.mesh.blocks])
    is_known = model.tools and not any(material.umat for material in model.materials)
    volume = np.concatenate(run.domain.measure_volumes(model)) if is_known else None
    return Metal("workpiece", solids.stress[:, :3].mean(axis=1), find_flow_stress(run), centres, volume)


def find_flow_stress(run: ExplicitForming) -> FloatArray:
    """Return the flow stress of the cells (n_cells,) [MPa], as SolidMaterial has it; effective stress of a UMAT."""
    solids, materials = run.solids, run.model.materials
    found = (solids.equivalent_plastic_strain, solids.temperature, effective_stress(solids.stress))
    parts = zip(run.mesh.blocks, *(run.split(values) for values in found), strict=True)
    return np.concatenate(
        [
            effective if materials[b.material].umat else run.laws[b.material].flow_stress(eqps, t)
            for b, eqps, t, effective in parts
        ]
    )
