# SPDX-License-Identifier: Apache-2.0
"""Remedies to report to a user whose increments find no equilibrium however small they are."""

from __future__ import annotations

from presswork.interaction.space.resting import find_loose
from presswork.model import Model

MESH = "Try a finer mesh where cells are most distorted, or look at the last saved step for folded cells"

SNAP = (
    "Where a sheet lies loose, or a wall or flange snaps over, there is none: set implicit.inertia = 1 to give it its "
    "mass"
)


MAXIMUM = "A given pressure does not pass its maximum: give pressure.NAME.fluid, and stages its inflow in place of p"


def find_remedy(model: Model, negative_pivots: int) -> str:
    """Return a sentence on what to do.

    negative_pivots: the most of any tangent in the last attempt; for shells they show a limit load. Solids soften for
    many other reasons.
    """
    held = {name for stage in model.stages for name, course in stage.pressure_course.items() if course.held}
    if any(pressure.fluid is None and pressure.name not in held for pressure in model.sheet_pressures):
        return f"{MAXIMUM}. {MESH}"
    if _is_stamping(model) and model.solver.inertia == 0.0:
        return f"{SNAP}. {MESH}"
    if model.analysis != "shell" or negative_pivots == 0 or model.solver.inertia > 0.0:
        loose = find_loose(model)
        if not loose or model.solver.inertia > 0.0:
            return MESH
        return (
            f"{MESH}. Only tools hold the body along {' and '.join(loose)}: where they come off, nothing does. Hold it "
            "there by a support or a displacement, or set solver.inertia = 1 (and a density in the materials)"
        )
    pivots = "a negative pivot" if negative_pivots == 1 else f"{negative_pivots} negative pivots"
    limit = (
        f"The tangent stiffness has {pivots}: the shell reaches a limit, where it buckles, snaps or "
        "collapses, and smaller increments do not pass it. "
    )
    inertia = "set solver.inertia = 1 (and a density in the materials) so that it can snap"
    if not _is_under_loads_alone(model):
        return f"{limit}S{inertia[1:]}"
    return f'{limit}Set solver.control = "arc_length" to follow its path on, with less load where need be; or {inertia}'


def _is_stamping(model: Model) -> bool:
    """Return whether the model is one of shells between tools, which the procedure of a stamping builds itself."""
    return model.analysis == "stamping" or (model.analysis == "shell" and bool(model.tools))


def _is_under_loads_alone(model: Model) -> bool:
    """Return whether arc length may compute the model: no tools, nothing prescribed, no law that needs time."""
    moved = model.tools or model.beads or any(stage.prescribed for stage in model.stages)
    return not moved and all(material.rate is None for material in model.materials)
