# SPDX-License-Identifier: Apache-2.0
"""The two surfaces of one contact of deformable bodies: which edges may touch, and the call of the mortar kernel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from presswork import _core
from presswork.mesh.topology import chain_edges, count_corners, edge_keys, list_cell_edges
from presswork.model import BodyContact, FloatArray, IndexArray, IntArray, MaskArray, Model
from presswork.state import ANEW, SURFACE, Arrays, OnNewMesh, State

STIFFNESS = 100.0
"""Of the contact: times Young's modulus of the softer body over the length of the slave edges."""
STICKING_PART = 0.4
"""Stiffness against slip over that against penetration, for bodies that stick."""
FRICTION_PART = 0.01
"""The same for laws by which they may slide: about as stiff as the bodies themselves, or Newton's method hunts."""
STEEPEST = {"frictionless": 0.0, "shear": 1.0, "sticking": 10.0}
"""Most shear over pressure that a law without mu of its own allows: where bodies part, shear goes as pressure does."""
COVERED = 0.01
"""Of the surface that a slot stands for: means are taken over no less, or a sliver of contact beside an edge would have
any pressure.
"""
MARGIN = 1.5
"""Edges nearer than this times the mean edge are candidates for contact."""
REACH = 0.25
"""A gap wider than this times the mean edge counts as none."""
TOUCHING = 1e-6
"""Gaps below this times the mean edge count as contact in the tangent."""
CREDIBLE = 0.05
"""Largest pressure, over Young's modulus, with which a slot is taken hold of that a guess has pushed in."""


@dataclass
class InterfaceArrays(Arrays):
    """What the contacts of deformable bodies with each other keep; slots are those of all contacts in a row."""

    owner = "body_contact"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "pressure": SURFACE,
        "shear": SURFACE,
        "slip": SURFACE,
        "force": ANEW,
        "friction": ANEW,
        "search_displacement": ANEW,
    }
    pressure: FloatArray
    """Between bodies, per slave node of each contact (n_slots,) [MPa]."""
    shear: FloatArray
    """Along the slave edge (n_slots,), in space a vector on the slave (n_slots, 3) [MPa]."""
    slip: FloatArray
    """Elastic slip of nodes that stick, still to be undone, in the same form [mm]."""
    force: FloatArray
    """Of the bodies on each other, at the nodes (n_points, 2 | 3) [N]."""
    friction: FloatArray
    """The part of it that friction makes, in the same form."""
    search_displacement: FloatArray
    """At which edges or faces that may touch were last looked for (n_points, 2 | 3) [mm]."""


class Interface:
    """The two surfaces of one contact, and the edges of them that may touch."""

    def __init__(self, model: Model, contact: BodyContact, first_slot: int) -> None:
        self.contact = contact
        self._model = model
        self.is_self = contact.slave == contact.master
        self.slave = self._surface(contact.slave)
        self.master = self.slave if self.is_self else self._surface(contact.master)
        self.nodes, slots = np.unique(self.slave[:, :2], return_inverse=True)
        self.slots = np.ascontiguousarray(slots.reshape(-1, 2), dtype=np.int32)
        self.places = slice(first_slot, first_slot + len(self.nodes))
        points = model.mesh.points
        lengths = [np.linalg.norm(points[e[:, 1]] - points[e[:, 0]], axis=1) for e in (self.slave, self.master)]
        self.mean_edge = float(np.concatenate(lengths).mean())
        self.edge = float(lengths[0].mean())
        young = find_softest(model, contact)
        # the same at all slots: then a uniform pressure makes a uniform penetration, and passes the patch test
        self.stiffness = np.full(len(self.nodes), STIFFNESS * young / self.edge)
        self.credible = CREDIBLE * young
        self._least_weight = COVERED * self._measure_slots()
        self._cell_of = [find_cells_of_edges(model, edges) for edges in (self.slave, self.master)]
        self.pairs: IntArray = np.zeros((0, 2), dtype=np.int32)
        # how deep the other body may reach behind each edge before the two count as apart: half a cell
        self._depth: tuple[FloatArray, FloatArray] = (np.zeros(len(self.slave)), np.zeros(len(self.master)))

    def _surface(self, body: int) -> IntArray:
        """Return a body's boundary edges in the order of the boundary, but for those on the axis."""
        edges = self._model.mesh.boundary_edges
        edges = edges[self._model.bodies[body].owns(edges)]
        points = self._model.mesh.points
        edges = chain_edges(edges, points)
        if self._model.analysis == "axisymmetric":
            edges = edges[np.abs(points[edges[:, :2], 0]).max(axis=1) > 1e-9 * np.ptp(points)]
        return np.ascontiguousarray(edges, dtype=np.int32)

    def _measure_slots(self) -> FloatArray:
        """Return the surface that each slot stands for where all of it is in contact (n_slots,) [mm2]."""
        points = self._model.mesh.points
        first, last = points[self.slave[:, 0]], points[self.slave[:, 1]]
        around = np.pi * (first[:, 0] + last[:, 0]) if self._model.analysis == "axisymmetric" else self._model.depth
        half = 0.5 * np.linalg.norm(last - first, axis=1) * around
        return np.bincount(self.slots.ravel(), np.repeat(half, 2), minlength=len(self.nodes)).astype(np.float64)

    def search(self, points: FloatArray) -> IntArray:
        """Look for the edges that may touch; return the node pairs (n, 2) that the matrix must hold."""
        self.pairs = _core.find_edge_pairs(self.slave, self.master, points, MARGIN * self.mean_edge, self.is_self)
        slave, master = (
            0.5 * measure_heights(self._model, points, edges, cells)
            for edges, cells in zip((self.slave, self.master), self._cell_of, strict=True)
        )
        self._depth = (slave, master)
        halves = self.slave.shape[1] - 1
        edge_pairs = np.unique(self.pairs // halves, axis=0)
        couplings = [np.zeros((0, 2), dtype=np.int32)]
        # all nodes of the edges that can share a slot
        slots = self.slots[edge_pairs[:, 0]]
        for slot in np.unique(slots):
            used = edge_pairs[(slots == slot).any(axis=1)]
            nodes = np.unique(np.concatenate([self.slave[used[:, 0]].ravel(), self.master[used[:, 1]].ravel()]))
            couplings.append(np.stack(np.meshgrid(nodes, nodes), axis=-1).reshape(-1, 2))
        return np.concatenate(couplings)

    def evaluate(
        self, state_n: State, trial: State, x_n: FloatArray, x: FloatArray, shear_flow: FloatArray, held: MaskArray,
        believed: FloatArray,
    ) -> _core.InterfaceResult:  # fmt: skip
        """Return the forces of the interface with its nodes at x (n_points, 2), with their tangent."""
        law = self.contact.contact
        with_shear = law in ("shear", "coulomb_capped")
        limit = self.contact.m * shear_flow[self.nodes] if with_shear else np.full(len(self.nodes), np.inf)
        shear, slip = trial[InterfaceArrays].shear, state_n[InterfaceArrays].slip
        return self._call(trial, shear, slip, x_n, x, held[self.places], believed[self.places], self.stiffness, limit)

    def apply(self, state: State, x: FloatArray) -> _core.InterfaceResult:
        """Return the forces of a converged state's pressure and shear, as they are."""
        return self._apply(state, x, state[InterfaceArrays].shear)

    def push(self, state: State, x: FloatArray) -> FloatArray:
        """Return the part of these forces that the pressure alone makes (n_points, 2) [N]."""
        return np.asarray(self._apply(state, x, np.zeros_like(state[InterfaceArrays].shear)).force)

    def show(self, result: _core.InterfaceResult, pressure: FloatArray, shear: FloatArray) -> None:
        """Write pressure and shear [MPa] at the nodes of both surfaces into fields (n_points,).

        At the ends of slave edges they are those of the slots, at their mid-sides the mean of the ends; at the master's
        nodes the nodal force over the node's share of the surface in contact.
        """
        area = np.asarray(result.area)
        touched = np.asarray(result.push) > 0
        safe = np.where(area > 1e-9 * area.max(initial=0.0), area, np.inf)
        pressure[touched] = (np.asarray(result.push) / safe)[touched]
        shear[touched] = -(np.asarray(result.drag) / safe)[touched]
        own, own_shear = np.asarray(result.pressure), np.asarray(result.shear)
        pushes = own > 0
        pressure[self.nodes[pushes]], shear[self.nodes[pushes]] = own[pushes], -own_shear[pushes]
        if self.slave.shape[1] == 3:
            middle = self.slave[:, 2]
            both = pushes[self.slots].any(axis=1)
            pressure[middle[both]] = own[self.slots].mean(axis=1)[both]
            shear[middle[both]] = -own_shear[self.slots].mean(axis=1)[both]

    def find_held(self, result: _core.InterfaceResult) -> tuple[FloatArray, FloatArray]:
        """Return places (n, 2) where the surfaces touch, and directions (n, 2) in which they hold each other there."""
        near = np.asarray(result.gap) <= 10 * TOUCHING * self.mean_edge
        edges = self.slave[near[self.slots].all(axis=1)]
        along = self._model.mesh.points[edges[:, 1]] - self._model.mesh.points[edges[:, 0]]
        along /= np.linalg.norm(along, axis=1)[:, None]
        normal = np.column_stack([along[:, 1], -along[:, 0]])
        middle = self._model.mesh.points[edges[:, :2]].mean(axis=1)
        if self.contact.contact == "frictionless":
            return middle, normal
        return np.concatenate([middle, middle]), np.concatenate([normal, along])

    def _apply(self, state: State, x: FloatArray, shear: FloatArray) -> _core.InterfaceResult:
        kept = state[InterfaceArrays]
        n = len(self.nodes)
        held, unlimited = np.ones(n, dtype=np.uint8), np.full(n, np.inf)
        pressure = kept.pressure[self.places]
        slip = kept.slip
        return self._call(state, shear, slip, x, x, held, pressure, np.zeros(n), unlimited, tangent=False)

    def _call(
        self, state: State, shear: FloatArray, slip: FloatArray, x_n: FloatArray, x: FloatArray, held: MaskArray,
        believed: FloatArray, stiffness: FloatArray, shear_limit: FloatArray, *, tangent: bool = True,
    ) -> _core.InterfaceResult:  # fmt: skip
        law = self.contact.contact
        return _core.evaluate_interface(
            self.slave,
            self.master,
            self.slots,
            self.pairs,
            x,
            x_n,
            slave_depth=self._depth[0],
            master_depth=self._depth[1],
            held=held,
            pressure=state[InterfaceArrays].pressure[self.places],
            shear=shear[self.places],
            slip=slip[self.places],
            believed=believed,
            least_weight=self._least_weight,
            stiffness=stiffness,
            shear_limit=shear_limit,
            mu=STEEPEST.get(law, self.contact.mu) if tangent else np.inf,
            tangential_part=STICKING_PART if law == "sticking" else FRICTION_PART,
            reach=REACH * self.mean_edge,
            touching=TOUCHING * self.mean_edge,
            thickness=0.0 if self._model.analysis == "axisymmetric" else self._model.depth,
            with_tangent=tangent,
        )


def find_softest(model: Model, contact: BodyContact) -> float:
    """Return Young's modulus of the softest material of the bodies of a contact [MPa]."""
    blocks = [model.mesh.blocks[i] for body in contact.between for i in model.bodies[body].blocks]
    return min(model.materials[block.material].young for block in blocks)


def find_cells_of_edges(model: Model, edges: IntArray) -> list[tuple[int, IndexArray, IntArray]]:
    """Return, for each block, its number, the places of the edges (n_edges, 2 | 3) in it, and their cells."""
    found = []
    keys = edge_keys(edges)
    for number, block in enumerate(model.mesh.blocks):
        own = edge_keys(list_cell_edges(block.connectivity))
        places = np.nonzero(np.isin(keys, own))[0]
        order = np.argsort(own, kind="stable")
        at = order[np.searchsorted(own[order], keys[places])]
        found.append((number, places, (at // count_corners(block.connectivity.shape[1])).astype(np.int32)))
    return found


def measure_heights(
    model: Model, points: FloatArray, edges: IntArray, cells: list[tuple[int, IndexArray, IntArray]]
) -> FloatArray:
    """Return the height of the cell behind each edge (n_edges,) [mm]: area over edge, twice that for triangles."""
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    height = np.zeros(len(edges))
    for number, places, cell in cells:
        connectivity = model.mesh.blocks[number].connectivity
        corners = count_corners(connectivity.shape[1])
        x, y = np.moveaxis(points[connectivity[cell, :corners]], -1, 0)
        area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
        height[places] = (2.0 if corners == 3 else 1.0) * area / length[places]
    return height
