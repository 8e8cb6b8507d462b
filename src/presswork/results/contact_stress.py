# SPDX-License-Identifier: Apache-2.0
"""Contact stress from nodal forces, so that its integral over the surface in contact gives the forces back.

The surface in contact consists of the boundary edges all of whose nodes are held, and of those beside a held node that
none of the former has. A node's stress is its force over its share of that surface, int N_a dA; interpolated by N_a it
integrates to the sum of the nodal forces, exactly: sum_a (f_a / A_a) int N_a dA = sum_a f_a.

With quadratic edges nodal forces alternate beside a peak, so stresses are smoothed there: an edge's mean stress is that
of its nodes' forces, f_a s_ae / A_a with s_ae the node's share of the edge; a node then takes the mean of its edges',
weighted by s_ae. The integral stays what it was, since sum_a sum_e t_e s_ae = sum_e t_e A_e = sum_a f_a.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.mesh.edges import edge_shape_functions
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Model
from presswork.state import ContactArray

_NO_SHARE = 1e-9
EDGE_RULES = {2: np.polynomial.legendre.leggauss(2), 3: np.polynomial.legendre.leggauss(12)}


@dataclass(frozen=True)
class ContactForces:
    """What tools do to the nodes that they hold: an entry for each node and tool, n in all."""

    nodes: IntArray
    """(n,); a node that two tools hold comes twice."""
    tool: IndexArray
    """Index into Model.tools (n,)."""
    segment: IntArray
    """Of the tool's profile that the node touches (n,); of its first face in an inner corner."""
    push: FloatArray
    """Along the normal into the workpiece (n,) [N]; in an inner corner of a tool the sum over both faces."""
    drag: FloatArray
    """Along the tangent, a quarter turn on from the normal (n,) [N]; none in an inner corner."""
    force: FloatArray
    """The whole force (n, 2) [N]."""
    status: ContactArray
    """Of every node (n_points,): 0 apart, 1 held along the normal, 2 held in both directions."""
    gap: FloatArray
    """Distance of every node from the nearest tool (n_points,) [mm]; NaN inside the body and where there is none."""


class ContactSurface:
    """The surface in contact at one instant, and the nodes' shares of it."""

    def __init__(self, model: Model, points: FloatArray, held: BoolArray) -> None:
        """Take deformed points (n_points, 2) [mm] and which nodes are held (n_points,)."""
        edges, n_whole = find_contact_edges(model.mesh.boundary_edges, held)
        shares = shares_by_edge(model, points, edges)
        has_area = shares.sum(axis=1) > _NO_SHARE * shares.sum(axis=1).max(initial=0.0)  # not on the axis
        self._edges, self._shares, self._n_whole = edges[has_area], shares[has_area], int(has_area[:n_whole].sum())
        self._area = np.zeros(len(points))
        np.add.at(self._area, self._edges, self._shares)
        self._has_share = np.abs(self._area) > _NO_SHARE * self._area.max(initial=0.0)

    @property
    def nodal_area(self) -> FloatArray:
        """Share of every node (n_points,) [mm2]; zero of a vertex on the axis of a quadratic edge (int N r dr = 0)."""
        return np.where(self._has_share, self._area, 0.0)

    def stress_of(self, force: FloatArray) -> FloatArray:
        """Return the stress of nodal forces at the nodes [MPa]; both (n_points,) or (n_points, k)."""
        columns = force.reshape(len(force), -1)
        area = np.where(self._has_share, self._area, np.inf)[:, None]
        stress: FloatArray = columns / area
        if self._edges.shape[1] == 3 and len(self._edges):
            stress = self._smooth(columns, stress)
        return stress.reshape(force.shape)

    def _smooth(self, force: FloatArray, stress: FloatArray) -> FloatArray:
        """Return the smoothed stress of quadratic edges: see the head of this file."""
        # 1. every edge's part of the nodal forces; a node without a share gives its force to its edges in equal parts
        edges, shares = self._edges, self._shares
        has_share, count = self._has_share[edges][..., None], np.bincount(edges.ravel(), minlength=len(force))
        part = np.where(has_share, shares[..., None] * stress[edges], force[edges] / count[edges][..., None])
        # 2. the mean of the edges that are held whole, or that a node without a share pushes
        mean = part.sum(axis=1, keepdims=True) / shares.sum(axis=1)[:, None, None]
        spread = (np.arange(len(edges)) < self._n_whole)[:, None, None] | ~has_share.all(axis=1, keepdims=True)
        part = np.where(spread, shares[..., None] * mean, part)
        # 3. back to the nodes
        total, average = np.zeros_like(stress), np.zeros_like(stress)
        np.add.at(total, edges, part)
        np.add.at(average, edges, mean / count[edges][..., None])
        area = np.where(self._has_share, self._area, 1.0)[:, None]
        return np.where(self._has_share[:, None], total / area, average)


def find_contact_edges(edges: IntArray, held: BoolArray) -> tuple[IntArray, int]:
    """Return the edges (n, 2 | 3) of the surface in contact, and how many of them, the first ones, are held whole."""
    whole = edges[held[edges].all(axis=1)]
    alone = held.copy()
    alone[whole] = False
    return np.concatenate([whole, edges[alone[edges].any(axis=1)]]), len(whole)


def shares_by_edge(model: Model, points: FloatArray, edges: IntArray) -> FloatArray:
    """Return int N_a dA of every edge and node (n_edges, 2 | 3) [mm2]; whole rings in axisymmetry.

    Exact for straight edges; twelve points for quadratic ones, which are strongly curved where they fold onto a tool.
    """
    n_nodes = edges.shape[1]
    x = points[edges]
    s, weight = EDGE_RULES[n_nodes]
    N, dN = (np.array(values) for values in zip(*(edge_shape_functions(n_nodes, at) for at in s), strict=True))
    area = weight * np.linalg.norm(np.einsum("sa,eai->esi", dN, x), axis=2)
    area *= 2 * np.pi * (x[:, :, 0] @ N.T) if model.analysis == "axisymmetric" else model.depth
    shares: FloatArray = area @ N
    return shares


def edge_shares(model: Model, points: FloatArray, edges: IntArray) -> FloatArray:
    """Return int N_a dA of every node over the edges, (n_points,) [mm2]; whole rings in axisymmetry."""
    share = np.zeros(len(points))
    np.add.at(share, edges, shares_by_edge(model, points, edges))
    return share
