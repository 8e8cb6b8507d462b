# SPDX-License-Identifier: Apache-2.0
"""What holds the sheet back in the one-step solver: holder, radii and beads, as friction at the part's nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from presswork.model import BoolArray, FloatArray, IntArray, PartBead
from presswork.onestep.flange import CHORD, FLAT, GENTLE, MOST, SMOOTH
from presswork.onestep.newton import Friction
from presswork.onestep.part import OneStepError, PartSurface

_COMPLIANCE = 0.01
"""Stiffness of holder, sheet and press across the flange over that of the sheet alone."""


@dataclass(frozen=True)
class Tools:
    """Which nodes lie under the holder, and the levels of die and punch."""

    flange: BoolArray
    """(n_nodes,)"""
    die_level: float
    """z of the flange [mm]."""
    punch_level: float
    """z of the lowest point [mm]."""


def find_tools(part: PartSurface, rim: IntArray, thickness: float) -> Tools:
    """Find the flange: nodes at the height of the rim's highest level stretch. rim: numbers of its nodes (k,).

    One of a curved binder goes on smoothly from there, as `find_flange` has it for triangles.
    """
    z, up = part.points[:, 2], part.normals[:, 2]
    ends = rim[up[rim] > FLAT]
    if not len(ends):
        return Tools(np.zeros(len(z), dtype=bool), float(np.median(z[rim])), float(z.min()))
    high = float(z[ends].max())
    flat = (up > FLAT) & (np.abs(z - high) < 0.5 * thickness)
    curved = _go_on_smoothly(part, flat & np.isin(np.arange(len(z)), rim), thickness)
    is_flat = flat[rim].sum() >= MOST * curved[rim].sum()
    return Tools(flat if is_flat else curved, high, float(z.min()))


def _go_on_smoothly(part: PartSurface, start: BoolArray, thickness: float) -> BoolArray:
    """Return the nodes (n_nodes,) to which a surface bends smoothly from some, as a binder does."""
    a, b = np.concatenate([part.triangles[:, [0, 1]], part.triangles[:, [1, 2]], part.triangles[:, [2, 0]]]).T
    turn = np.linalg.norm(part.normals[a] - part.normals[b], axis=1)
    distance = np.linalg.norm(part.points[a] - part.points[b], axis=1)
    smooth = (np.minimum(part.normals[a, 2], part.normals[b, 2]) > GENTLE) & (
        (turn < CHORD) | (turn * SMOOTH * thickness < distance)
    )
    n = len(part.points)
    links = scipy.sparse.coo_matrix((np.ones(int(smooth.sum())), (a[smooth], b[smooth])), shape=(n, n))
    piece = scipy.sparse.csgraph.connected_components(links, directed=False)[1]
    return np.asarray(np.isin(piece, piece[start]))


@dataclass(frozen=True)
class Holder:
    """A flat blank holder."""

    force: float
    """Force on what is modelled of the part [N]."""
    stiffness: float
    """Pressure per compression of what lies between holder and die [N/mm3]."""


def find_holder(force: float, share: float, young: float, thickness: float) -> Holder:
    """Return the holder of a sheet. share: of the whole part that is modelled."""
    return Holder(force * share, _COMPLIANCE * young / thickness)


def holder_friction(part: PartSurface, tools: Tools, holder: Holder, thickness: FloatArray, mu: float) -> Friction:
    """Return friction on both faces of the flange: the flat holder presses where the sheet is thickest.

    thickness: of the sheet at each node (n_nodes,) [mm]. The pressure is stiffness (thickness - gap) where above zero,
    the gap that at which it adds up to the force. Raises OneStepError without a level flange.
    """
    under = np.flatnonzero(tools.flange & (part.nodal_areas > 0.0))
    if not len(under):
        raise OneStepError("the part has no level flange that a holder could press: leave the holder's force out")
    under = under[np.argsort(-thickness[under], kind="stable")]
    area, t = part.nodal_areas[under], thickness[under]
    gaps = (np.cumsum(area * t) - holder.force / holder.stiffness) / np.cumsum(area)  # with the first 1, 2, ... pressed
    n = int(np.argmax(gaps >= np.append(t[1:], -np.inf)))
    force = np.zeros(len(part.points))
    force[under] = 2.0 * mu * holder.stiffness * np.maximum(t - gaps[n], 0.0) * area
    return Friction(force, np.full(len(force), tools.die_level))


def radius_friction(part: PartSurface, tools: Tools, forces: FloatArray, mu: float) -> Friction:
    """Return friction where the sheet is wound round tools: mu times the force that holds a node off its tool.

    forces: of what holds the sheet, at each node (n_nodes, 3). The punch pushes down, the die up.
    """
    normal = np.einsum("ni,ni->n", forces, part.normals)
    down = normal * part.normals[:, 2] < 0.0
    return Friction(mu * np.abs(normal), np.where(down, tools.punch_level, tools.die_level))


def bead_friction(part: PartSurface, tools: Tools, beads: tuple[PartBead, ...], share_of_edge: float) -> Friction:
    """Return the beads' force at the nodes that lie nearest to them, seen from above.

    share_of_edge: distance at which a bead is sampled [mm]. Raises OneStepError for a bead that misses the part.
    """
    force = np.zeros(len(part.points))
    level = np.abs(part.normals[:, 2]) > FLAT
    nodes = np.flatnonzero(level)
    if not len(nodes):
        raise OneStepError("the part is level nowhere: a bead needs a flange")
    tree = scipy.spatial.cKDTree(part.points[nodes, :2])
    for number, bead in enumerate(beads):
        for a, b in zip(bead.points[:-1], bead.points[1:], strict=True):
            length = float(np.linalg.norm(b - a))
            n = max(1, int(np.ceil(length / share_of_edge)))
            places = a + (np.arange(n) + 0.5)[:, None] / n * (b - a)
            distance, nearest = tree.query(places)
            if distance.max() > 4.0 * share_of_edge:
                x, y = places[int(np.argmax(distance))]
                raise OneStepError(f"bead {number + 1} leaves the part's flange near ({x:.4g}, {y:.4g})")
            np.add.at(force, nodes[nearest], bead.force * length / n)
    return Friction(force, np.full(len(force), tools.die_level))


def punch_force(forces: FloatArray, share: float) -> float:
    """Return what the punch must push down with [N]: the downward forces that hold the nodes, of the whole part."""
    return float(-np.minimum(forces[:, 2], 0.0).sum() / share)
