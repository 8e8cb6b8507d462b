# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies with each other and with themselves: mortar, penalty with augmented Lagrange.

Each end of a slave edge is a slot. Its pressure follows from the mean gap of the edges beside it, weighted by the
slot's shape function, and from the multiplier that the converged increment before has left:

    p = max(0, multiplier - stiffness gap)

so what an increment leaves of penetration is what its change of pressure takes. An increment that leaves more than
PENETRATION of an edge takes over the multipliers and iterates on. Shear follows in the same way from the slip, by
return mapping. The kernels are in cpp/contact; docs/theory/contact.md has the formulas.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.mesh.topology import chain_edges, count_corners, edge_keys, list_cell_edges
from presswork.model import BodyContact, FloatArray, IndexArray, IntArray, MaskArray, Model
from presswork.procedure.mechanics import Mechanics, PassedThrough
from presswork.procedure.shell_mechanics import ShellMechanics
from presswork.state import FRICTION, State

STIFFNESS = 100.0
"""Of the contact: times Young's modulus of the softer body over the length of the slave edges."""
STICKING_PART = 0.4
"""Stiffness against slip over that against penetration, for bodies that stick."""
FRICTION_PART = 0.01
"""The same for laws by which they may slide: about as stiff as the bodies themselves, or Newton's method hunts."""
PENETRATION = 1e-3
"""Of the slave edge's length: more than that of gap or slip at nodes that push or stick takes another iteration."""
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
MAX_CHANGES = 4
"""Changes after which a slot keeps contact until the increment ends."""
CREDIBLE = 0.05
"""Largest pressure, over Young's modulus, with which a slot is taken hold of that a guess has pushed in."""
RELEASE = 1e-3
"""A slot that may change no more may pull with no more than this part of the largest pressure."""
STICKS = 1
"""Status of a slot that sticks."""


@dataclass(frozen=True)
class BodyForces:
    """Of the bodies on each other: nodal force (n_points, 2) [N], stiffness as node pairs (n, 2), blocks (n, 2, 2)."""

    force: FloatArray
    pairs: IntArray
    blocks: FloatArray
    pressure: FloatArray
    """(n_slots,) [MPa]."""
    shear: FloatArray
    gap: FloatArray
    slip: FloatArray
    status: MaskArray
    details: tuple[_core.InterfaceResult, ...]

    @staticmethod
    def none(shape: tuple[int, ...]) -> BodyForces:
        """Return no forces at all, of the shape of the displacement, for a model without contact of bodies."""
        empty = np.zeros(0)
        return BodyForces(
            np.zeros(shape), np.zeros((0, 2), dtype=np.int32), np.zeros((0, 2, 2)),
            empty, empty, empty, empty, np.zeros(0, dtype=np.uint8), (),
        )  # fmt: skip


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
        young = min(model.materials[i].young for b in contact.between for i in self._materials(b))
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

    def _materials(self, body: int) -> list[int]:
        return [self._model.mesh.blocks[i].material for i in self._model.bodies[body].blocks]

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
        shear, slip = trial.interface_shear, state_n.interface_slip
        return self._call(trial, shear, slip, x_n, x, held[self.places], believed[self.places], self.stiffness, limit)

    def apply(self, state: State, x: FloatArray) -> _core.InterfaceResult:
        """Return the forces of a converged state's pressure and shear, as they are."""
        return self._apply(state, x, state.interface_shear)

    def push(self, state: State, x: FloatArray) -> FloatArray:
        """Return the part of these forces that the pressure alone makes (n_points, 2) [N]."""
        return np.asarray(self._apply(state, x, np.zeros_like(state.interface_shear)).force)

    def _apply(self, state: State, x: FloatArray, shear: FloatArray) -> _core.InterfaceResult:
        n = len(self.nodes)
        held, unlimited = np.ones(n, dtype=np.uint8), np.full(n, np.inf)
        pressure = state.interface_pressure[self.places]
        slip = state.interface_slip
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
            pressure=state.interface_pressure[self.places],
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


class BodyContacts:
    """All contacts between bodies of one run; what persists lies in the State."""

    def __init__(self, model: Model, mechanics: Mechanics | ShellMechanics) -> None:
        self._model = model
        self._mechanics = mechanics
        self.interfaces: list[Interface] = []
        self.n_slots = 0
        for contact in model.contacts:
            self.interfaces.append(Interface(model, contact, self.n_slots))
            self.n_slots += len(self.interfaces[-1].nodes)
        self._edge = np.concatenate([np.zeros(0), *(np.full(len(i.nodes), i.edge) for i in self.interfaces)])
        self._budget = 0.5 * (MARGIN - REACH) * min((i.mean_edge for i in self.interfaces), default=0.0)
        self._nodes = np.unique(np.concatenate([np.zeros((0,), dtype=np.int32), *(
            np.concatenate([i.slave.ravel(), i.master.ravel()]) for i in self.interfaces)]))  # fmt: skip
        self._searched_at: FloatArray | None = None
        self._shear_flow = np.zeros(len(model.mesh.points))
        self._held = np.zeros(self.n_slots, dtype=np.uint8)
        self._believed = np.zeros(self.n_slots)
        self._credible = np.concatenate([np.zeros(0), *(np.full(len(i.nodes), i.credible) for i in self.interfaces)])
        self._changes = np.zeros(self.n_slots, dtype=np.int64)
        self.n_unsettled = 0
        """Slots that may change no more in this increment, and pull."""

    def begin_increment(self, state_n: State) -> None:
        """Take contact and shear flow stress [MPa] as they are at the start of the increment."""
        self.n_unsettled = 0
        self._held = (state_n.interface_pressure > 0).astype(np.uint8)
        self._believed = state_n.interface_pressure.copy()
        self._changes = np.zeros(self.n_slots, dtype=np.int64)
        if any(i.contact.contact in ("shear", "coulomb_capped") for i in self.interfaces):
            self._shear_flow = self._mechanics.nodal_flow_stress(state_n) / np.sqrt(3.0)

    def _follow(self, trial: State, displacement: FloatArray) -> None:
        """Look for candidates again where nodes have moved too far since; they depend on trial alone."""
        moved = np.abs(displacement[self._nodes] - trial.search_displacement[self._nodes]).max(initial=0.0)
        if moved > self._budget:
            trial.search_displacement = displacement.copy()
        if self._searched_at is not None and np.array_equal(self._searched_at, trial.search_displacement):
            return
        self._searched_at = trial.search_displacement.copy()
        points = np.ascontiguousarray(self._model.mesh.points + trial.search_displacement)
        couplings = np.concatenate([interface.search(points) for interface in self.interfaces])
        assert isinstance(self._mechanics, Mechanics), "bodies in contact are solids"
        self._mechanics.couple(np.ascontiguousarray(np.unique(couplings, axis=0), dtype=np.int32))

    def evaluate(self, state_n: State, trial: State, displacement: FloatArray) -> BodyForces | PassedThrough:
        """Return the forces of the bodies on each other at a guess."""
        if not self.interfaces:
            return BodyForces.none(displacement.shape)
        self._follow(trial, displacement)
        points = self._model.mesh.points
        x, x_n = points + displacement, points + state_n.displacement
        results = []
        for interface in self.interfaces:
            found = interface.evaluate(state_n, trial, x_n, x, self._shear_flow, self._held, self._believed)
            if found.too_deep:
                return PassedThrough(interface.contact.name)
            results.append(found)
        return BodyForces(
            force=np.sum([r.force for r in results], axis=0),
            pairs=np.concatenate([r.pairs for r in results]),
            blocks=np.concatenate([r.blocks for r in results]),
            pressure=np.concatenate([r.pressure for r in results]),
            shear=np.concatenate([r.shear for r in results]),
            gap=np.concatenate([r.gap for r in results]),
            slip=np.concatenate([r.slip for r in results]),
            status=np.concatenate([r.status for r in results]),
            details=tuple(results),
        )

    def predict(self, found: BodyForces, change: FloatArray) -> None:
        """Take the pressures that a change of the nodes (n_points, 2) [mm] leads to where all goes by the tangent.

        They are what the iteration believes in: the penalty makes of the curvature that a change has passed by, a
        micrometre or so, pressures beyond all bounds, and a tangent or a friction made of those leads nowhere.
        """
        for interface, result in zip(self.interfaces, found.details, strict=True):
            slot, node = np.asarray(result.slope_places).T
            rise = np.zeros(len(interface.nodes))
            np.add.at(rise, slot, (np.asarray(result.pressure_slopes) * change[node]).sum(axis=1))
            self._believed[interface.places] = np.asarray(result.pressure) + rise

    def update(self, found: BodyForces, *, near: bool) -> int:
        """Take hold of slots that penetrate and, near equilibrium, let go of those that pull; return the changes."""
        before = self._held.copy()
        fresh = (found.pressure > 0) & (before == 0)
        self._believed[fresh] = np.minimum(found.pressure, self._credible)[fresh]
        self._held[found.pressure > 0] = 1
        self._held[found.pressure == 0] = 0
        if near:
            pulls = found.pressure < 0
            self._held[pulls & (self._changes < MAX_CHANGES)] = 0
            strongly = found.pressure < -RELEASE * found.pressure.max(initial=0.0)
            self.n_unsettled = int((strongly & (self._changes >= MAX_CHANGES)).sum())
        changed = before != self._held
        self._changes[changed] += 1
        return int(changed.sum())

    def touching(self, state: State) -> list[tuple[BodyContact, FloatArray]]:
        """Return each contact whose surfaces touch, with the directions (n, 2) in which they hold each other."""
        found = self.evaluate(state, state, state.displacement)
        assert isinstance(found, BodyForces)  # nothing has moved
        held = []
        for interface, result in zip(self.interfaces, found.details, strict=True):
            near = np.asarray(result.gap) <= 10 * TOUCHING * interface.mean_edge
            edges = interface.slave[near[interface.slots].all(axis=1)]
            along = self._model.mesh.points[edges[:, 1]] - self._model.mesh.points[edges[:, 0]]
            along /= np.linalg.norm(along, axis=1)[:, None]
            normal = np.column_stack([along[:, 1], -along[:, 0]])
            rubs = interface.contact.contact != "frictionless"
            held.append((interface.contact, np.concatenate([normal, along]) if rubs else normal))
        return held

    def _at_rest(self, state: State) -> tuple[_core.InterfaceResult, ...]:
        """Return what a converged state's multipliers do, gaps and slips left out."""
        if not self.interfaces:
            return ()
        points = self._model.mesh.points + state.displacement
        self._follow(state, state.displacement)
        return tuple(interface.apply(state, points) for interface in self.interfaces)

    def total_forces(self, state: State) -> dict[str, FloatArray]:
        """Return the force of the first body of each contact on the second (2,) [N]."""
        forces = {}
        for interface, result in zip(self.interfaces, self._at_rest(state), strict=True):
            contact = interface.contact
            forces[contact.name] = np.array(result.master_force) * (1 if contact.slave == contact.between[0] else -1)
        return forces

    def nodal_stress(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return pressure and shear (n_points,) [MPa], as those of tools: shear along the boundary, body on the right.

        At the ends of slave edges they are those of the slots, at their mid-sides the mean of the ends; at the master's
        nodes the nodal force over the node's share of the surface in contact.
        """
        n = len(self._model.mesh.points)
        pressure, shear = np.zeros(n), np.zeros(n)
        for interface, result in zip(self.interfaces, self._at_rest(state), strict=True):
            area = np.asarray(result.area)
            touched = np.asarray(result.push) > 0
            safe = np.where(area > 1e-9 * area.max(initial=0.0), area, np.inf)
            pressure[touched] = (np.asarray(result.push) / safe)[touched]
            shear[touched] = -(np.asarray(result.drag) / safe)[touched]
            own, own_shear = state.interface_pressure[interface.places], state.interface_shear[interface.places]
            pushes = own > 0
            pressure[interface.nodes[pushes]], shear[interface.nodes[pushes]] = own[pushes], -own_shear[pushes]
            if interface.slave.shape[1] == 3:
                middle = interface.slave[:, 2]
                both = pushes[interface.slots].any(axis=1)
                pressure[middle[both]] = own[interface.slots].mean(axis=1)[both]
                shear[middle[both]] = -own_shear[interface.slots].mean(axis=1)[both]
        return pressure, shear

    def augment(self, trial: State, found: BodyForces) -> bool:
        """Take over the multipliers if bodies penetrate, or slip where they stick, by more than is allowed."""
        pushes, sticks = found.pressure > 0, found.status == STICKS
        excess = max(
            float(np.abs(found.gap[pushes] / self._edge[pushes]).max(initial=0.0)),
            float(np.abs(found.slip[sticks] / self._edge[sticks]).max(initial=0.0)),
        )
        if excess <= PENETRATION:
            return False
        trial.interface_pressure, trial.interface_shear = found.pressure, found.shear
        return True

    def settle(self, state_n: State, trial: State, found: BodyForces) -> None:
        """Keep what the next increment starts from, and add the work that friction has taken."""
        if not self.interfaces:
            return
        trial.interface_pressure, trial.interface_shear = found.pressure, found.shear
        trial.interface_slip = np.where(found.status == STICKS, found.slip, 0.0)
        trial.interface_force = found.force
        if any(i.contact.contact != "frictionless" for i in self.interfaces):
            points = self._model.mesh.points + trial.displacement
            trial.interface_friction = found.force - sum(i.push(trial, points) for i in self.interfaces)
            friction = state_n.interface_friction + trial.interface_friction
            trial.work[FRICTION] -= 0.5 * float((friction * trial.increment).sum())
