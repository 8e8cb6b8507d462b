# SPDX-License-Identifier: Apache-2.0
"""Shapes that a part goes through as the punch comes down, made from the part alone, and the sheet's places on them.

While the punch is above its last place by a height, so is the bottom; the flange is at its final place, and the walls
are shorter. The share of that height by which a node is raised solves Laplace's equation over the part, 0 at the flange
and 1 at the bottom; conductivity is so much lower where the part is steep and straight that the walls take nearly all
of it. On such a shape the sheet's metal lies farther out than in the part (carry_nodes).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

from presswork.geometry.foot_on_triangles import find_feet
from presswork.model import BoolArray, FloatArray, IntArray
from presswork.onestep.part import PartSurface

_STEEP = 8
"""Power of the slope's sine that conductivity falls with."""
_MOST_CONDUCTIVE = 1e4
"""Conductivity where the part is level, over that of an upright wall."""
_STRAIGHT = 20.0
"""Thicknesses; a wall bent down its slope to a radius so large conducts twice as well as a straight one."""
_WALL = 0.5
"""Sine of the slope of a wall: those that are steeper limit how far the bottom can be raised."""


def find_raise(part: PartSurface, flange: BoolArray, bottom: BoolArray, thickness: float) -> tuple[FloatArray, float]:
    """Return the share of the punch's height that raises each node (n_nodes,), and the height that uses up a wall [mm].

    part: with its curvature; flange, bottom: nodes that stay, and nodes that go with the punch (n_nodes,). The height
    is 0 for a part without walls between them.
    """
    cells, n = part.triangles, len(part.points)
    inverse = np.linalg.inv(part.edges)  # rows: gradients of the second and third corner's shape functions
    gradient = np.stack([-inverse[:, 0] - inverse[:, 1], inverse[:, 0], inverse[:, 1]], axis=1)
    fall = np.einsum("nai,na->ni", gradient, part.points[cells, 2])
    sine = np.linalg.norm(fall, axis=1)
    is_wall = sine > _WALL
    if not (flange.any() and bottom.any() and is_wall.any()):
        return np.zeros(n), 0.0
    down = fall / np.maximum(sine, 1e-12)[:, None]
    bent = np.einsum("ni,nij,nj->n", down, part.curvature[:, [0, 2, 2, 1]].reshape(-1, 2, 2), down)
    conductivity = np.maximum(sine, 1e-3) ** -_STEEP * (1.0 + (_STRAIGHT * thickness * bent) ** 2)
    conductivity = np.minimum(conductivity, _MOST_CONDUCTIVE)
    blocks = (conductivity * part.areas)[:, None, None] * np.einsum("nai,nbi->nab", gradient, gradient)
    rows, columns = np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, (1, 3)).ravel()
    matrix = sparse.csr_matrix((blocks.ravel(), (rows, columns)), shape=(n, n))
    share = bottom.astype(float)
    free = ~(flange | bottom)
    share[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix[free][:, ~free] @ share[~free]))
    rise = np.einsum("nai,na->ni", gradient, share[cells])
    used = -np.einsum("ni,ni->n", rise, fall)[is_wall] / sine[is_wall] ** 2  # of the wall's height, a millimetre raised
    return share, 1.0 / float(used.max()) if used.max() > 0.0 else 0.0


class RaisedSurface:
    """A smooth surface through the nodes of a raised part, on which the sheet's nodes are placed."""

    def __init__(self, part: PartSurface, triangles: IntArray, thickness: float) -> None:
        """Take a raised part; triangles: its cells, each counted once (n, 3); thickness: of the sheet [mm]."""
        self._part, self._triangles, self._thickness = part, triangles, thickness
        self._up = float(np.sign(part.normals[:, 2].sum()))

    def place(self, points: FloatArray, held: tuple[BoolArray, BoolArray] | None) -> tuple[FloatArray, FloatArray]:
        """Return the places on the surface nearest to points (n, 3), and its normals there, (n, 3) each.

        held: points on symmetry planes normal to x | y.

        The surface is quadratic in each triangle: halfway from its plane to those of its corners (Boubekeur & Alexa
        2008), which is exact for arcs of circles to the second order. Beyond the part's rim it goes on level.
        """
        points_on, normals, corners = self._part.points, self._part.normals, self._triangles
        feet = find_feet(points, points_on, corners)
        foot, normal = feet.interpolate(points_on, corners), feet.interpolate(normals, corners)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        own = corners[feet.triangle]
        height = np.einsum("nai,nai->na", foot[:, None] - points_on[own], normals[own])
        rounded = foot - 0.5 * np.einsum("na,na,nai->ni", feet.weight, height, normals[own])
        beside = points - foot
        beside -= np.einsum("ni,ni->n", beside, normal)[:, None] * normal
        beside[:, 2] = 0.0
        normal[np.linalg.norm(beside, axis=1) > self._thickness] = np.array([0.0, 0.0, self._up])
        placed = rounded + beside
        for axis, on_plane in enumerate(held or ()):
            placed[on_plane, axis] = normal[on_plane, axis] = 0.0
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return placed, normal


def carry_nodes(wanted: FloatArray, blank: FloatArray, points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return where metal lies that starts at wanted (k, 2), (k, 3).

    blank (n, 2), points (n, 3): where a sheet's nodes start and lie. Beyond the sheet's rim the metal keeps its
    distance from the rim.
    """
    flat, places = (np.column_stack([x, np.zeros(len(x))]) for x in (blank, wanted))
    feet = find_feet(places, flat, triangles)
    beyond = places - feet.interpolate(flat, triangles)
    return np.asarray(feet.interpolate(points, triangles) + beyond)
