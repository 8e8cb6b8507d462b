# SPDX-License-Identifier: Apache-2.0
"""Tool forces by integration of the saved contact traction, to be held against the reactions in the history."""

from __future__ import annotations

import numpy as np

from presswork.mesh.edges import edge_shape_functions
from presswork.model import FloatArray
from presswork.results import Result, ResultError
from presswork.results.contact_stress import EDGE_RULES, find_contact_edges


def integrate_contact_force(result: Result, tool: str | None = None, step: int = -1) -> FloatArray:
    """Return the force of the workpiece on a whole tool [N], shape (2,), from the contact traction at a saved step.

    The traction is integrated over the deformed edges in contact, by the Gauss points that gave the nodes their shares,
    over the full ring in axisymmetry (the x component is then the radial load summed round the ring), over the depth in
    plane strain, and counts twice where a symmetry plane cuts the tool: as `force_x` and `force_y` in the history,
    which are reactions. `tool` may be left out if there is only one. Raises ResultError for an unknown tool or step.
    """
    name = _choose(result, tool)
    field = "contact_traction" if len(result.tools) == 1 else f"contact_traction_{name}"
    traction = result.field(field, step)[:, :2]
    held = result.field("contact_status", step) > 0
    edges, _ = find_contact_edges(result.mesh.boundary_edges.astype(np.int32), held)
    points = result.points(step)[edges]
    force = np.zeros(2)
    for s, weight in zip(*EDGE_RULES[edges.shape[1]], strict=True):
        N, dN = edge_shape_functions(edges.shape[1], s)
        length = np.linalg.norm(np.einsum("a,eai->ei", dN, points), axis=1)
        is_ring = result.info["analysis"] == "axisymmetric"
        thickness = 2 * np.pi * (points[:, :, 0] @ N) if is_ring else float(result.info["depth"])
        force -= weight * np.einsum("e,eai,a->i", length * thickness, traction[edges], N)
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
