# SPDX-License-Identifier: Apache-2.0
"""Tool forces by integration of the saved contact traction, to be held against the reactions in the history."""

from __future__ import annotations

import numpy as np

from presswork.fields.contact_stress import ContactSurface
from presswork.model import FloatArray
from presswork.results import Result, ResultError


def integrate_contact_force(result: Result, tool: str | None = None, step: int = -1) -> FloatArray:
    """Return the force of the workpiece on a whole tool [N], shape (2,), from the contact traction at a saved step.

    The traction, linear between neighbouring nodes, is integrated over the deformed surface in contact, over the full
    ring in axisymmetry (the x component is then the radial load summed round the ring), over the depth in plane strain,
    and counts twice where a symmetry plane cuts the tool: as `force_x` and `force_y` in the history, which are
    reactions. `tool` may be left out if there is only one. Raises ResultError for an unknown tool or step.
    """
    name = _choose(result, tool)
    field = "contact_traction" if len(result.tools) == 1 else f"contact_traction_{name}"
    traction = result.field(field, step)[:, :2]
    held = result.field("contact_status", step) > 0
    is_ring = result.info["analysis"] == "axisymmetric"
    surface = ContactSurface(
        result.mesh_at(step).boundary_edges.astype(np.int32),
        result.points(step),
        held,
        result.field("gap", step),
        depth=None if is_ring else float(result.info["depth"]),
    )
    force: FloatArray = -(surface.nodal_area[:, None] * traction).sum(axis=0)
    for normal, axis in enumerate("xy"):
        if name in str(result.info[f"mirrored_{axis}"]).split("\n"):
            force[normal] = 0.0
            force[1 - normal] *= 2.0
    return force


def _choose(result: Result, tool: str | None) -> str:
    """Return the tool's name; the only one if none is given."""
    names = list(result.tools)
    if tool is None and len(names) == 1:
        return names[0]
    if tool not in names:
        there_are = ", ".join(sorted(names)) or "none"
        raise ResultError(f"{result.folder} has no tool {tool or 'to choose by itself'}; name one of: {there_are}")
    return tool
