# SPDX-License-Identifier: Apache-2.0
"""What the contact of two surfaces of deformable bodies is in the plane and in space: slots, laws, the kernel's call.

body_interface.py has its edges, space_interface.py its faces.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from presswork import _core
from presswork.model import BodyContact, FloatArray, IndexArray, IntArray, MaskArray, Model
from presswork.state import ANEW, SURFACE, Arrays, OnNewMesh, State

STIFFNESS = 100.0
"""Stiffness of the contact over Young's modulus of the softer body divided by the length of the slave edges."""
STICKING_PART = 0.4
"""Stiffness against slip over that against penetration, for bodies that stick."""
FRICTION_PART = 0.01
"""The same for laws by which they may slide: about as stiff as the bodies themselves, or Newton's method hunts."""
STEEPEST = {"frictionless": 0.0, "shear": 1.0, "sticking": 10.0}
"""Most shear over pressure that a law without mu of its own allows: where bodies part, shear goes as pressure does."""
COVERED = 0.01
"""Least part of the surface of a slot over which means are taken; a sliver of contact beside an edge would otherwise
have any pressure.
"""
MARGIN = 1.5
"""Edges nearer than this times the mean edge are candidates for contact."""
REACH = 0.25
"""A gap wider than this times the mean edge counts as none."""
TOUCHING = 1e-6
"""Gaps below this times the mean edge count as contact in the tangent."""
CREDIBLE = 0.05
"""Largest pressure, over Young's modulus, with which a slot is taken hold of that a guess has pushed in."""

CellsOfSides = list[tuple[int, IndexArray, IntArray]]
"""For each block its number, the places of the edges or faces in it, and their cells."""


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
    """Pressure between bodies, per slave node of each contact (n_slots,) [MPa]."""
    shear: FloatArray
    """Shear along the slave edge (n_slots,), in space a vector on the slave (n_slots, 3) [MPa]."""
    slip: FloatArray
    """Elastic slip of nodes that stick, still to be undone, in the same form [mm]."""
    force: FloatArray
    """Force of the bodies on each other, at the nodes (n_points, 2 | 3) [N]."""
    friction: FloatArray
    """The part of it that friction makes, in the same form."""
    search_displacement: FloatArray
    """Displacement at which edges or faces that may touch were last looked for (n_points, 2 | 3) [mm]."""


Result = TypeVar("Result", _core.InterfaceResult, _core.FaceInterfaceResult)


class BodySurfaces(ABC, Generic[Result]):
    """The two surfaces of one contact, and the sides of them that may touch: edges in the plane, faces in space."""

    def __init__(self, model: Model, contact: BodyContact, first_slot: int) -> None:
        self.contact = contact
        self._model = model
        self.is_self = contact.slave == contact.master
        self.slave = self._surface(contact.slave)
        self.master = self.slave if self.is_self else self._surface(contact.master)
        corners = self._corners(self.slave)
        self.nodes, slots = np.unique(corners, return_inverse=True)
        self.slots = np.ascontiguousarray(slots.reshape(corners.shape), dtype=np.int32)
        self.places = slice(first_slot, first_slot + len(self.nodes))
        lengths = [self._measure_edges(sides) for sides in (self.slave, self.master)]
        self.mean_edge = float(np.concatenate(lengths).mean())
        self.edge = float(lengths[0].mean())
        young = _find_softest(model, contact)
        # the same at all slots: then a uniform pressure makes a uniform penetration, and passes the patch test
        self.stiffness = np.full(len(self.nodes), STIFFNESS * young / self.edge)
        self.credible = CREDIBLE * young
        self._whole = self._measure_slots()
        self._least_weight: FloatArray = COVERED * self._whole
        self.cells_behind = [self._find_cells(sides) for sides in (self.slave, self.master)]
        self.pairs: IntArray = np.zeros((0, 2), dtype=np.int32)
        # how deep the other body may reach behind each side before the two count as apart: half a cell
        self._depth: tuple[FloatArray, FloatArray] = (np.zeros(len(self.slave)), np.zeros(len(self.master)))

    # --- what the plane and space answer each ------------------------------------------------------------------------

    @abstractmethod
    def _surface(self, body: int) -> IntArray:
        """Return the sides of a body's boundary that may touch (n_sides, k)."""

    @abstractmethod
    def _corners(self, sides: IntArray) -> IntArray:
        """Return the nodes of sides that have slots (n_sides, 2 | 3 | 4)."""

    @abstractmethod
    def _measure_edges(self, sides: IntArray) -> FloatArray:
        """Return the lengths of the edges of sides [mm]."""

    @abstractmethod
    def _measure_slots(self) -> FloatArray:
        """Return the surface that each slot stands for where all of it is in contact (n_slots,) [mm2]."""

    @abstractmethod
    def _find_cells(self, sides: IntArray) -> CellsOfSides:
        """Return the cells behind sides."""

    @abstractmethod
    def _measure_heights(self, points: FloatArray, sides: IntArray, cells: CellsOfSides) -> FloatArray:
        """Return the height of the cell behind each side (n_sides,) [mm]."""

    @abstractmethod
    def _find_pairs(self, points: FloatArray) -> IntArray:
        """Return the pairs of slave and master side that may touch (n, 2)."""

    @abstractmethod
    def _couple(self) -> IntArray:
        """Return the node pairs (n, 2) that the matrix must hold for the present pairs."""

    @abstractmethod
    def _evaluate(self, x: FloatArray, x_n: FloatArray, **values: Any) -> Result:
        """Call the kernel."""

    # --- what they share ---------------------------------------------------------------------------------------------

    def search(self, points: FloatArray) -> IntArray:
        """Look for the sides that may touch; return the node pairs (n, 2) that the matrix must hold."""
        self.pairs = self._find_pairs(points)
        slave, master = (
            0.5 * self._measure_heights(points, sides, cells)
            for sides, cells in zip((self.slave, self.master), self.cells_behind, strict=True)
        )
        self._depth = (slave, master)
        return self._couple()

    def evaluate(
        self, state_n: State, trial: State, x_n: FloatArray, x: FloatArray, shear_flow: FloatArray, held: MaskArray,
        believed: FloatArray,
    ) -> Result:  # fmt: skip
        """Return the forces of the interface with its nodes at x (n_points, 2 | 3), with their tangent."""
        with_shear = self.contact.contact in ("shear", "coulomb_capped")
        limit = self.contact.m * shear_flow[self.nodes] if with_shear else np.full(len(self.nodes), np.inf)
        shear, slip = trial[InterfaceArrays].shear, state_n[InterfaceArrays].slip
        return self._call(trial, shear, slip, x_n, x, held[self.places], believed[self.places], self.stiffness, limit)

    def apply(self, state: State, x: FloatArray) -> Result:
        """Return the forces of a converged state's pressure and shear, as they are."""
        return self._apply(state, x, state[InterfaceArrays].shear)

    def push(self, state: State, x: FloatArray) -> FloatArray:
        """Return the part of these forces that the pressure alone makes (n_points, 2 | 3) [N]."""
        return np.asarray(self._apply(state, x, np.zeros_like(state[InterfaceArrays].shear)).force)

    def find_covered(self, result: Any) -> FloatArray:
        """Return the part in contact of the surface that each slot stands for, at most 1 (n_slots,)."""
        return np.minimum(np.asarray(result.weight) / self._whole, 1.0)

    def _apply(self, state: State, x: FloatArray, shear: FloatArray) -> Result:
        n = len(self.nodes)
        held, unlimited = np.ones(n, dtype=np.uint8), np.full(n, np.inf)
        kept = state[InterfaceArrays]
        pressure = kept.pressure[self.places]
        return self._call(state, shear, kept.slip, x, x, held, pressure, np.zeros(n), unlimited, tangent=False)

    def _call(
        self, state: State, shear: FloatArray, slip: FloatArray, x_n: FloatArray, x: FloatArray, held: MaskArray,
        believed: FloatArray, stiffness: FloatArray, shear_limit: FloatArray, *, tangent: bool = True,
    ) -> Result:  # fmt: skip
        law = self.contact.contact
        return self._evaluate(
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


def _find_softest(model: Model, contact: BodyContact) -> float:
    """Return Young's modulus of the softest material of the bodies of a contact [MPa]."""
    blocks = [model.mesh.blocks[i] for body in contact.between for i in model.bodies[body].blocks]
    return min(model.materials[block.material].young for block in blocks)
