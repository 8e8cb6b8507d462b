# SPDX-License-Identifier: Apache-2.0
"""The fields that are saved, from the Model and a State: cell means, contact stress."""

from __future__ import annotations

import numpy as np

from presswork.mesh.edges import GAUSS_3, edge_shape_functions
from presswork.model import FloatArray, IntArray, Model
from presswork.state import State


def effective_stress(stress: FloatArray) -> FloatArray:
    """Return the von Mises stress of xx, yy, zz, xy (..., 4)."""
    sxx, syy, szz, sxy = np.moveaxis(stress, -1, 0)
    squares: FloatArray = 0.5 * ((sxx - syy) ** 2 + (syy - szz) ** 2 + (szz - sxx) ** 2) + 3 * sxy**2
    return np.asarray(np.sqrt(squares))


def cell_fields(state: State) -> dict[str, FloatArray]:
    """Return the volume-weighted cell means, cells in the order of the blocks."""
    names = ("equivalent_plastic_strain", "effective_stress", "stress", "hydrostatic_stress")
    parts: dict[str, list[FloatArray]] = {name: [] for name in names}
    for stress, eqps, volume in zip(state.stress, state.eqps, state.volume, strict=True):
        weight = volume / volume.sum(axis=1, keepdims=True)
        mean = np.einsum("cq,cqi->ci", weight, stress)
        parts["equivalent_plastic_strain"].append((weight * eqps).sum(axis=1))
        parts["effective_stress"].append((weight * effective_stress(stress)).sum(axis=1))
        parts["stress"].append(np.column_stack([mean, np.zeros((len(mean), 2))]))
        parts["hydrostatic_stress"].append(mean[:, :3].mean(axis=1))
    return {name: np.concatenate(values) for name, values in parts.items()}


def point_fields(model: Model, state: State, contact: ContactForces) -> dict[str, FloatArray]:
    """Return displacement (n_points, 3) and the contact stresses and forces at the nodes."""
    n = len(model.mesh.points)
    pressure, shear = contact_stress(model, state, contact)
    force = np.zeros((n, 3))
    force[contact.nodes, :2] = contact.push[:, None] * contact.normal + contact.drag[:, None] * contact.tangent
    displacement = np.column_stack([state.displacement, np.zeros(n)])
    return {"displacement": displacement, "contact_pressure": pressure, "contact_shear": shear, "contact_force": force}


class ContactForces:
    """Nodes in contact with their nodal push and drag [N]; normal points into the workpiece, tangent a quarter turn
    on.
    """

    def __init__(self, nodes: IntArray, normal: FloatArray, reaction: FloatArray) -> None:
        self.nodes = nodes
        self.normal = normal
        self.tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        self.push = (normal * reaction).sum(axis=1)
        self.drag = (self.tangent * reaction).sum(axis=1)


def contact_stress(model: Model, state: State, contact: ContactForces) -> tuple[FloatArray, FloatArray]:
    """Return pressure and shear stress of the tools on the nodes (n_points,) [MPa], zero where there is no contact.

    A nodal force is divided by the node's share of the edges in contact, int N_a dA: exact for a uniform stress. With
    quadratic edges, whose nodal forces alternate beside a peak, a node then takes the mean stress of its edges. A node
    with no edge wholly in contact takes its share of the edges beside it.
    """
    n = len(model.mesh.points)
    pressure, shear = np.zeros(n), np.zeros(n)
    if not len(contact.nodes):
        return pressure, shear
    held = np.zeros(n, dtype=bool)
    held[contact.nodes] = True
    edges = model.mesh.boundary_edges
    whole = edges[held[edges].all(axis=1)]
    alone = np.setdiff1d(contact.nodes, whole)
    edges = np.concatenate([whole, edges[np.isin(edges, alone).any(axis=1)]])
    points = model.mesh.points + state.displacement
    area = edge_shares(model, points, edges)[contact.nodes]
    safe = np.where(area > 1e-9 * area.max(), area, np.inf)  # a vertex on the axis has no share of a quadratic edge
    pressure[contact.nodes], shear[contact.nodes] = contact.push / safe, contact.drag / safe
    if whole.shape[1] == 3 and len(whole):
        _average_over_edges(model, points, whole, pressure)
        _average_over_edges(model, points, whole, shear)
    return pressure, shear


def _average_over_edges(model: Model, points: FloatArray, edges: IntArray, stress: FloatArray) -> None:
    """Give every node of the edges the mean of its edges' mean stresses, in place."""
    shares = _shares_by_edge(model, points, edges)
    area = shares.sum(axis=1)
    mean = (shares * stress[edges]).sum(axis=1) / area
    total, weight = np.zeros(len(points)), np.zeros(len(points))
    np.add.at(total, edges, (mean * area)[:, None])
    np.add.at(weight, edges, area[:, None])
    nodes = np.unique(edges)
    stress[nodes] = total[nodes] / weight[nodes]


def _shares_by_edge(model: Model, points: FloatArray, edges: IntArray) -> FloatArray:
    """Return int N_a dA of every edge and node (n_edges, 2 | 3) [mm2]; whole rings in axisymmetry."""
    x = points[edges]
    shares = np.zeros(edges.shape)
    for s, weight in GAUSS_3:
        N, dN = edge_shape_functions(edges.shape[1], s)
        length = np.linalg.norm(np.einsum("a,eai->ei", dN, x), axis=1)
        thickness = 2 * np.pi * (x[:, :, 0] @ N) if model.analysis == "axisymmetric" else model.depth
        shares += np.einsum("e,a->ea", weight * length * thickness, N)
    return shares


def edge_shares(model: Model, points: FloatArray, edges: IntArray) -> FloatArray:
    """Return int N_a dA of every node over the edges, (n_points,) [mm2]; whole rings in axisymmetry."""
    share = np.zeros(len(points))
    np.add.at(share, edges, _shares_by_edge(model, points, edges))
    return share
