# SPDX-License-Identifier: Apache-2.0
"""Contact stress of tools, within what the material beneath can carry: see contact_stress.py for the surface.

Bounds of a node, k its shear flow stress (flow stress over root 3):

    0 <= pressure <= the larger of (2 + pi) k and the median of the nine nodes around it
    |shear| <= k, and what the tool's friction law allows

(2 + pi) k is what a perfectly plastic half-space bears beside a free surface (Prandtl 1920): a peak of a node or two
that stands out above it and above its surroundings is the mesh's picture of a singular end. Its force goes to the nodes
beside it. On a sticking tool coarse meshes may have more tangential force than the surface can carry: what finds no
room within REACH nodes is left out of the shear, and only the traction, whose integral is always the force, has it.
Bounds of k do not apply to materials whose flow stress only a UMAT knows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.fields.contact_stress import ContactForces, ContactSurface, confine
from presswork.law.friction import limit_stress
from presswork.model import BoolArray, FloatArray, IndexArray, Model, Tool

BEARING = 2 + np.pi
"""Pressure over k that a half-space bears beside a free surface."""
WINDOW = 9
"""Number of nodes whose median pressure distinguishes a peak from a hill."""
REACH = 4
"""Nodes over which shear that a sticking tool has beyond k is moved."""


@dataclass(frozen=True)
class ToolStress:
    """Contact stress of all tools at the nodes, zero apart."""

    pressure: FloatArray
    """Positive in compression (n_points,) [MPa]."""
    shear: FloatArray
    """(n_points,) [MPa]."""
    traction: FloatArray
    """Contact stress of each tool on the workpiece (n_tools, n_points, 3) [MPa]."""
    friction_limit: FloatArray
    """Largest shear that the tools' laws allow (n_points,) [MPa]; zero apart from tools with friction."""


def recover_tool_stress(
    model: Model, points: FloatArray, contact: ContactForces, flow_stress: FloatArray
) -> ToolStress:
    """Return the contact stress of nodal forces, with the deformed points (n_points, 2) [mm].

    flow_stress: of the material at the nodes (n_points,) [MPa].
    """
    n = len(points)
    depth = None if model.analysis == "axisymmetric" else model.depth
    surface = ContactSurface(model.mesh.boundary_edges, points, contact.status > 0, contact.gap, depth=depth)
    smooth = ~surface.corners()
    smooth[contact.nodes[contact.in_corner]] = False
    strength = shear_strength(model, flow_stress)
    pressure, shear, limit = np.zeros(n), np.zeros(n), np.zeros(n)
    traction = np.zeros((len(model.plane_tools), n, 3))
    for t, tool in enumerate(model.plane_tools):
        own = np.flatnonzero(contact.tool == t)
        nodes = contact.nodes[own]
        touches = np.zeros(n, dtype=bool)
        touches[nodes] = True
        forces = np.zeros((4, n))
        forces[:, nodes] = contact.push[own], contact.drag[own], *contact.force[own].T
        push, drag, *whole = (surface.share(force) for force in forces)
        mine = [surface.stress_of(surface.smooth(force, smooth & touches)) for force in (push, drag)]
        free = touches & smooth
        mine[0] = _confine_pressure(surface, mine[0], touches, free, strength)
        friction = friction_limit(tool, contact, own, mine[0], flow_stress)
        if tool.friction.law != "frictionless":
            sticks = tool.friction.law == "sticking"
            bound = strength if sticks else np.minimum(strength, friction)
            moved = _confine(surface, mine[1], touches, free, -bound, bound, REACH if sticks else None)
            mine[1] = np.where(free, np.clip(moved, -bound, bound), moved)
        pressure, shear = pressure + mine[0], shear + mine[1]
        limit[nodes] = friction[nodes]
        traction[t, :, :2] = _to_vectors(surface.nodal_area, contact, own, mine[0], mine[1], np.column_stack(whole))
    return ToolStress(pressure, shear, traction, limit)


def friction_limit(
    tool: Tool, contact: ContactForces, own: IndexArray, pressure: FloatArray, flow_stress: FloatArray
) -> FloatArray:
    """Return the largest friction stress that a tool's law allows (n_points,) [MPa]; zero without friction.

    own: the tool's entries in contact.
    """
    limit = np.zeros(len(pressure))
    nodes, segment = contact.nodes[own], contact.segment[own]
    m, mu = (of[segment] for of in tool.friction_by_segment())
    if contact.factor is not None:
        m, mu = m * contact.factor[own], mu * contact.factor[own]
    shear_flow = flow_stress[nodes] / np.sqrt(3.0)
    limit[nodes], _ = limit_stress(tool.friction, m, mu, np.maximum(pressure[nodes], 0.0), shear_flow)
    return limit


def shear_strength(model: Model, flow_stress: FloatArray) -> FloatArray:
    """Return the largest shear that the material at a node carries (n_points,) [MPa]; infinite where not known."""
    strength: FloatArray = flow_stress / np.sqrt(3.0)
    for block in model.mesh.blocks:
        material = model.materials[block.material]
        if material.umat is not None or material.is_elastic:
            strength[np.unique(block.connectivity)] = np.inf
    return strength


def _confine_pressure(
    surface: ContactSurface, pressure: FloatArray, touches: BoolArray, free: BoolArray, strength: FloatArray
) -> FloatArray:
    """Return the pressure (n_points,) without pull and without peaks; nodes that are not free keep theirs."""
    most = BEARING * strength
    for chain in surface.chains(touches):
        most[chain.nodes] = np.maximum(most[chain.nodes], _running_median(pressure[chain.nodes]))
    return _confine(surface, pressure, touches, free, np.zeros(len(pressure)), most)


def _confine(
    surface: ContactSurface,
    stress: FloatArray,
    touches: BoolArray,
    free: BoolArray,
    low: FloatArray,
    high: FloatArray,
    reach: int | None = None,
) -> FloatArray:
    """Return stresses (n_points,) moved to within bounds on every boundary; nodes that are not free keep theirs."""
    confined = stress.copy()
    low, high = np.where(free, low, stress), np.where(free, high, stress)
    for chain in surface.chains(touches):
        nodes = chain.nodes
        confined[nodes] = confine(chain, stress[nodes], surface.nodal_area[nodes], low[nodes], high[nodes], reach)
    return confined


def _running_median(values: FloatArray) -> FloatArray:
    """Return the median of the WINDOW values around each (n,), of those at the end near the ends."""
    size = min(WINDOW, len(values))
    windows = np.lib.stride_tricks.sliding_window_view(values, size)
    start = np.clip(np.arange(len(values)) - size // 2, 0, len(values) - size)
    return np.asarray(np.median(windows, axis=1)[start])


def _to_vectors(
    area: FloatArray,
    contact: ContactForces,
    own: IndexArray,
    pressure: FloatArray,
    shear: FloatArray,
    force: FloatArray,
) -> FloatArray:
    """Return a tool's traction (n_points, 2) [MPa], with the sum of its nodal forces (n_points, 2) [N]: what pressure
    and shear lack of that, on a curved tool or where shear was left out, is spread over all of its surface.
    """
    traction = np.zeros((len(pressure), 2))
    own = own[area[contact.nodes[own]] > 0]
    nodes, normal = contact.nodes[own], contact.normal[own]
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    along = pressure[nodes, None] * normal + shear[nodes, None] * tangent
    traction[nodes] = np.where(contact.in_corner[own, None], force[nodes] / area[nodes, None], along)
    missing = force.sum(axis=0) - (area[:, None] * traction).sum(axis=0)
    traction[nodes] += missing / max(area[nodes].sum(), 1e-300)
    return traction
