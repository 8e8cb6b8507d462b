# SPDX-License-Identifier: Apache-2.0
"""The two surfaces of one contact of deformable bodies in space: what body_interface.py is in the plane."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.interaction.body_interface import (
    COVERED,
    CREDIBLE,
    FRICTION_PART,
    MARGIN,
    REACH,
    STEEPEST,
    STICKING_PART,
    STIFFNESS,
    TOUCHING,
    InterfaceArrays,
    find_softest,
)
from presswork.mesh.faces import face_areas, list_cell_faces
from presswork.model import BodyContact, FloatArray, IntArray, MaskArray, Model
from presswork.state import State


class SpaceInterface:
    """The two surfaces of one contact in space, and the faces of them that may touch."""

    def __init__(self, model: Model, contact: BodyContact, first_slot: int) -> None:
        self.contact = contact
        self._model = model
        self.is_self = contact.slave == contact.master
        self.slave = self._surface(contact.slave)
        self.master = self.slave if self.is_self else self._surface(contact.master)
        self.nodes, slots = np.unique(self.slave, return_inverse=True)
        self.slots = np.ascontiguousarray(slots.reshape(self.slave.shape), dtype=np.int32)
        self.places = slice(first_slot, first_slot + len(self.nodes))
        points = model.mesh.points
        lengths = [_measure_edges(points, faces) for faces in (self.slave, self.master)]
        self.mean_edge = float(np.concatenate(lengths).mean())
        self.edge = float(lengths[0].mean())
        young = find_softest(model, contact)
        # the same at all slots: then a uniform pressure makes a uniform penetration, and passes the patch test
        self.stiffness = np.full(len(self.nodes), STIFFNESS * young / self.edge)
        self.credible = CREDIBLE * young
        whole = np.bincount(self.slots.ravel(), face_areas(points, self.slave).ravel(), minlength=len(self.nodes))
        self._least_weight = np.asarray(COVERED * whole, dtype=np.float64)
        self._cell_of = [_find_cells(model, faces) for faces in (self.slave, self.master)]
        self.pairs: IntArray = np.zeros((0, 2), dtype=np.int32)
        self._depth: tuple[FloatArray, FloatArray] = (np.zeros(len(self.slave)), np.zeros(len(self.master)))

    def _surface(self, body: int) -> IntArray:
        faces = self._model.mesh.boundary_faces
        return np.ascontiguousarray(faces[self._model.bodies[body].owns(faces)], dtype=np.int32)

    def search(self, points: FloatArray) -> IntArray:
        """Look for the faces that may touch; return the node pairs (n, 2) that the matrix must hold."""
        self.pairs = _core.find_face_pairs(self.slave, self.master, points, MARGIN * self.mean_edge, self.is_self)
        slave, master = (
            0.5 * _measure_heights(self._model, points, faces, cells)
            for faces, cells in zip((self.slave, self.master), self._cell_of, strict=True)
        )
        self._depth = (slave, master)
        # a slot couples all nodes of its faces and of those that these may touch
        rows = self.pairs[:, 0].repeat(self.slave.shape[1])
        slot = self.slots[self.pairs[:, 0]].ravel()
        touched = np.concatenate([self.slave[rows], self.master[self.pairs[:, 1].repeat(self.slave.shape[1])]], axis=1)
        members = np.unique(np.column_stack([slot.repeat(touched.shape[1]), touched.ravel()]), axis=0)
        counts = np.bincount(members[:, 0], minlength=len(self.nodes))
        ends = np.cumsum(counts)
        of_slots = [members[end - n : end, 1] for end, n in zip(ends.tolist(), counts.tolist(), strict=True) if n]
        couplings = [np.stack(np.meshgrid(nodes, nodes), axis=-1).reshape(-1, 2) for nodes in of_slots]
        return np.concatenate([np.zeros((0, 2), dtype=np.int32), *couplings]).astype(np.int32)

    def evaluate(
        self, state_n: State, trial: State, x_n: FloatArray, x: FloatArray, shear_flow: FloatArray, held: MaskArray,
        believed: FloatArray,
    ) -> _core.FaceInterfaceResult:  # fmt: skip
        """Return the forces of the interface with its nodes at x (n_points, 3), with their tangent."""
        with_shear = self.contact.contact in ("shear", "coulomb_capped")
        limit = self.contact.m * shear_flow[self.nodes] if with_shear else np.full(len(self.nodes), np.inf)
        shear, slip = trial[InterfaceArrays].shear, state_n[InterfaceArrays].slip
        return self._call(trial, shear, slip, x_n, x, held[self.places], believed[self.places], self.stiffness, limit)

    def apply(self, state: State, x: FloatArray) -> _core.FaceInterfaceResult:
        """Return the forces of a converged state's pressure and shear, as they are."""
        return self._apply(state, x, state[InterfaceArrays].shear)

    def push(self, state: State, x: FloatArray) -> FloatArray:
        """Return the part of these forces that the pressure alone makes (n_points, 3) [N]."""
        return np.asarray(self._apply(state, x, np.zeros_like(state[InterfaceArrays].shear)).force)

    def _apply(self, state: State, x: FloatArray, shear: FloatArray) -> _core.FaceInterfaceResult:
        n = len(self.nodes)
        held, unlimited = np.ones(n, dtype=np.uint8), np.full(n, np.inf)
        kept = state[InterfaceArrays]
        pressure = kept.pressure[self.places]
        return self._call(state, shear, kept.slip, x, x, held, pressure, np.zeros(n), unlimited, tangent=False)

    def _call(
        self, state: State, shear: FloatArray, slip: FloatArray, x_n: FloatArray, x: FloatArray, held: MaskArray,
        believed: FloatArray, stiffness: FloatArray, shear_limit: FloatArray, *, tangent: bool = True,
    ) -> _core.FaceInterfaceResult:  # fmt: skip
        law = self.contact.contact
        return _core.evaluate_face_interface(
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
            with_tangent=tangent,
        )

    def show(self, result: _core.FaceInterfaceResult, pressure: FloatArray, shear: FloatArray) -> None:
        """Write pressure and the size of the shear [MPa] at the nodes of both surfaces into fields (n_points,)."""
        area = np.asarray(result.area)
        pushed = np.asarray(result.push) > 0
        safe = np.where(area > 1e-9 * area.max(initial=0.0), area, np.inf)
        pressure[pushed] = (np.asarray(result.push) / safe)[pushed]
        shear[pushed] = (np.linalg.norm(result.drag, axis=1) / safe)[pushed]
        own = np.asarray(result.pressure)
        pushes = own > 0
        pressure[self.nodes[pushes]] = own[pushes]
        shear[self.nodes[pushes]] = np.linalg.norm(result.shear, axis=1)[pushes]

    def find_held(self, result: _core.FaceInterfaceResult) -> tuple[FloatArray, FloatArray]:
        """Return places (n, 3) where the surfaces touch, and directions (n, 3) in which they hold each other there."""
        near = np.asarray(result.gap) <= 10 * TOUCHING * self.mean_edge
        places, normals = self._model.mesh.points[self.nodes[near]], np.asarray(result.normal)[near]
        if self.contact.contact == "frictionless":
            return places, normals
        return np.repeat(places, 3, axis=0), np.tile(np.eye(3), (len(places), 1))


def _measure_edges(points: FloatArray, faces: IntArray) -> FloatArray:
    """Return the lengths of all sides of faces [mm]."""
    return np.asarray(np.linalg.norm(points[np.roll(faces, -1, axis=1)] - points[faces], axis=2).ravel())


def _find_cells(model: Model, faces: IntArray) -> list[tuple[int, IntArray, IntArray]]:
    """Return, for each block, its number, the places of the faces in it, and their cells."""
    found = []
    keys = np.sort(faces, axis=1)
    for number, block in enumerate(model.mesh.blocks):
        own = np.sort(list_cell_faces(block.connectivity), axis=1)
        both, index = np.unique(np.concatenate([own, keys]), axis=0, return_inverse=True)
        cell_of = np.full(len(both), -1, dtype=np.int32)
        cell_of[index.ravel()[: len(own)]] = np.arange(len(own)) // (len(own) // len(block.connectivity))
        cells = cell_of[index.ravel()[len(own) :]]
        places = np.flatnonzero(cells >= 0).astype(np.int32)
        found.append((number, places, cells[places]))
    return found


def _measure_heights(
    model: Model, points: FloatArray, faces: IntArray, cells: list[tuple[int, IntArray, IntArray]]
) -> FloatArray:
    """Return the height of the cell behind each face [mm]: twice, of tetrahedra four times that of its middle."""
    height, quads = np.zeros(len(faces)), faces.shape[1] == 4
    for number, places, cell in cells:
        x = points[model.mesh.blocks[number].connectivity[cell]]
        middle, own = x.mean(axis=1), points[faces[places]]
        out = np.cross(own[:, 2 if quads else 1] - own[:, 0], own[:, -1] - own[:, 1 if quads else 0])
        out /= np.linalg.norm(out, axis=1)[:, None]
        rise = np.einsum("ni,ni->n", own.mean(axis=1) - middle, out)
        height[places] = (2.0 if quads else 4.0) * np.abs(rise)
    return height
