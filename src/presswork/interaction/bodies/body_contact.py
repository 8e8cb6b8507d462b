# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies with each other and with themselves: mortar, penalty with augmented Lagrange.

Each end of a slave edge is a slot. Its pressure follows from the mean gap of the edges beside it, weighted by the
slot's shape function, and from the multiplier that the converged increment before has left:

    p = max(0, multiplier - stiffness gap)

so what an increment leaves of penetration is what its change of pressure takes. An increment that leaves more than
PENETRATION of an edge takes over the multipliers and iterates on. Shear follows from the slip alike, by return mapping.
The kernels are in cpp/contact; docs/theory/contact.md has the formulas.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from presswork.body.contract import Cells
from presswork.fields.contact_stress import BodyTraction
from presswork.interaction.bodies.body_interface import Interface
from presswork.interaction.bodies.body_surfaces import MARGIN, REACH, InterfaceArrays
from presswork.interaction.bodies.space_interface import SpaceInterface
from presswork.interaction.contract import Forces, Guess, Interaction, Point
from presswork.interaction.led import Led
from presswork.model import BodyContact, FloatArray, IntArray, MaskArray, Model
from presswork.outcome import PassedThrough, Step
from presswork.state import Arrays, State

PENETRATION = 1e-3
"""Penetration over the slave edge's length above which nodes that push or stick take another iteration."""
MAX_CHANGES = 4
"""Changes after which a slot keeps contact until the increment ends."""
RELEASE = 1e-3
"""A slot that may change no more may pull with no more than this part of the largest pressure."""
BY_GAP, KEEPS_HOLD, RELEASED = 0, 1, 2
"""What the iteration has decided of a slot (SlotHold in cpp/contact/interface.hpp)."""
STICKS = 1
"""Status of a slot that sticks."""


@dataclass(frozen=True)
class BodyForces(Forces):
    """Forces of bodies on each other: at nodes (n_points, d) [N], stiffness as node pairs (n, 2), blocks (n, d, d)."""

    pressure: FloatArray
    """(n_slots,) [MPa]."""
    shear: FloatArray
    gap: FloatArray
    slip: FloatArray
    status: MaskArray
    covered: FloatArray
    """Part in contact of the surface that each slot stands for (n_slots,)."""
    details: tuple[Any, ...]
    """Details of each interface: what its kernel returns."""


class BodyContacts(Led, Interaction):
    """All contacts between bodies of one run; what persists lies in the State."""

    def __init__(self, model: Model, cells: Cells) -> None:
        self._model = model
        self._cells = cells
        self.interfaces: list[Interface | SpaceInterface] = []
        self.n_slots = 0
        for contact in model.contacts:
            self.interfaces.append(
                (SpaceInterface if model.dimension == 3 else Interface)(model, contact, self.n_slots)
            )
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
        self.n_undecided = 0
        """Slots that may change no more in this increment, and pull."""

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of bodies that do not push each other."""
        along = (self.n_slots, 3) if self._model.dimension == 3 else self.n_slots
        slots = [np.zeros(self.n_slots), np.zeros(along), np.zeros(along)]
        return (InterfaceArrays(*slots, *(np.zeros(self._model.mesh.points.shape) for _ in range(3))),)

    def surface_nodes(self) -> list[IntArray]:
        """Return the slave nodes of each contact."""
        return [interface.nodes for interface in self.interfaces]

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Take contact and shear flow stress [MPa] as they are at the start of the increment."""
        kept_n = state_n[InterfaceArrays]
        self.n_undecided = 0
        self._held = np.where(kept_n.pressure > 0, KEEPS_HOLD, BY_GAP).astype(np.uint8)
        self._believed = kept_n.pressure.copy()
        self._changes = np.zeros(self.n_slots, dtype=np.int64)
        if any(i.contact.contact in ("shear", "coulomb_capped") for i in self.interfaces):
            self._shear_flow = self._cells.nodal_flow_stress(state_n) / np.sqrt(3.0)

    def _follow(self, trial: State, displacement: FloatArray) -> None:
        """Look for candidates again where nodes have moved too far since; they depend on trial alone."""
        kept = trial[InterfaceArrays]
        moved = np.abs(displacement[self._nodes] - kept.search_displacement[self._nodes]).max(initial=0.0)
        if moved > self._budget:
            kept.search_displacement = displacement.copy()
        if self._searched_at is not None and np.array_equal(self._searched_at, kept.search_displacement):
            return
        self._searched_at = kept.search_displacement.copy()
        points = np.ascontiguousarray(self._model.mesh.points + kept.search_displacement)
        couplings = np.concatenate([interface.search(points) for interface in self.interfaces])
        self._cells.couple(np.ascontiguousarray(np.unique(couplings, axis=0), dtype=np.int32))

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> BodyForces | PassedThrough:
        """Return the forces of the bodies on each other at a guess."""
        return self.at(state_n, trial, guess.displacement[:, : self._model.dimension])

    def at(self, state_n: State, trial: State, displacement: FloatArray) -> BodyForces | PassedThrough:
        """Return the forces of the bodies on each other with the nodes displaced by `displacement` (n_points, d)."""
        self._follow(trial, displacement)
        points = self._model.mesh.points
        x, x_n = points + displacement, points + self._moved(state_n)
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
            covered=np.concatenate([i.find_covered(r) for i, r in zip(self.interfaces, results, strict=True)]),
            details=tuple(results),
        )

    def _moved(self, state: State) -> FloatArray:
        return state.nodes.displacement[:, : self._model.dimension]

    def predict(self, found: Any, change: FloatArray) -> None:
        """Take the pressures that a change of the nodes (n_points, freedoms) leads to where all goes by the tangent.

        They are what the iteration believes in: the penalty makes of the curvature that a change has passed by, a
        micrometre or so, pressures beyond all bounds, and a tangent or a friction made of those leads nowhere.
        """
        for interface, result in zip(self.interfaces, found.details, strict=True):
            slot, node = np.asarray(result.slope_places).T
            rise = np.zeros(len(interface.nodes))
            slopes = np.asarray(result.pressure_slopes)
            np.add.at(rise, slot, (slopes * change[node, : slopes.shape[1]]).sum(axis=1))
            self._believed[interface.places] = np.asarray(result.pressure) + rise

    def update(self, trial: State, point: Point, own: Any, *, near: bool, pull: float) -> int:
        """Hold slots that penetrate and, near equilibrium, release those that pull; return the changes."""
        before = self._held.copy()
        fresh = (own.pressure > 0) & (before != KEEPS_HOLD)
        self._believed[fresh] = np.minimum(own.pressure, self._credible)[fresh]
        self._held[own.pressure > 0] = KEEPS_HOLD
        self._held[(own.pressure == 0) & (before == KEEPS_HOLD)] = BY_GAP
        opens = (before == BY_GAP) & (own.pressure == 0) & (self._believed < 0)  # the tangent has held it shut
        self._held[opens & (self._changes < MAX_CHANGES)] = RELEASED
        if near:
            pulls = own.pressure < 0
            self._held[pulls & (self._changes < MAX_CHANGES)] = RELEASED
            strongly = own.pressure < -RELEASE * own.pressure.max(initial=0.0)
            self.n_undecided = int((strongly & (self._changes >= MAX_CHANGES)).sum())
        changed = before != self._held
        self._changes[changed] += 1
        return int(changed.sum())

    def hold_like(self, other: Self, trial: State, held: State, displacement: FloatArray) -> None:
        """Let the slots push that push in another run, by their gap, and no others."""
        self._held = np.where(held[InterfaceArrays].pressure > 0, BY_GAP, RELEASED).astype(np.uint8)

    def augment_like(self, trial: State, own: Any) -> None:
        """Take over the multipliers, as another run has done."""
        kept = trial[InterfaceArrays]
        kept.pressure, kept.shear = own.pressure, own.shear

    def touching(self, state: State) -> list[tuple[BodyContact, FloatArray, FloatArray]]:
        """Return each contact with the places (n, d) where its surfaces touch, and directions (n, d) in which they hold
        each other there.
        """
        if not self.interfaces:
            return []
        found = self.at(state, state, self._moved(state))
        assert isinstance(found, BodyForces)  # nothing has moved
        details = zip(self.interfaces, found.details, strict=True)
        return [(interface.contact, *interface.find_held(result)) for interface, result in details]

    def _at_rest(self, state: State) -> tuple[Any, ...]:
        """Return what a converged state's multipliers do, gaps and slips left out."""
        if not self.interfaces:
            return ()
        moved = self._moved(state)
        self._follow(state, moved)
        return tuple(interface.apply(state, self._model.mesh.points + moved) for interface in self.interfaces)

    def total_forces(self, state: State) -> dict[str, FloatArray]:
        """Return the force of the first body of each contact on the second (2 | 3,) [N]."""
        forces = {}
        for interface, result in zip(self.interfaces, self._at_rest(state), strict=True):
            contact = interface.contact
            forces[contact.name] = np.array(result.master_force) * (1 if contact.slave == contact.between[0] else -1)
        return forces

    def traction(self, state: State) -> BodyTraction | None:
        """Return pressure, shear and force at the nodes, as those of tools; None if no bodies may touch."""
        if not self.interfaces:
            return None
        n = len(self._model.mesh.points)
        pressure, shear = np.zeros(n), np.zeros(n)
        for interface, result in zip(self.interfaces, self._at_rest(state), strict=True):
            interface.show(result, pressure, shear)
        return BodyTraction(pressure, shear, state[InterfaceArrays].force)

    def augment(self, trial: State, own: Any) -> bool:
        """Take over the multipliers if bodies penetrate, or slip where they stick, by more than is allowed.

        Slots of which only a sliver is in contact, as beside a corner, count in proportion to it: what they would need
        of pressure is nearly no force.
        """
        part = own.covered / self._edge
        pushes, sticks = own.pressure > 0, own.status == STICKS
        excess = max(
            float(np.abs(own.gap[pushes] * part[pushes]).max(initial=0.0)),
            float((_lengths(own.slip[sticks]) * part[sticks]).max(initial=0.0)),
        )
        if excess <= PENETRATION:
            return False
        self.augment_like(trial, own)
        return True

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep what the next increment starts from."""
        kept = trial[InterfaceArrays]
        kept.pressure, kept.shear = own.pressure, own.shear
        sticks = own.status == STICKS
        kept.slip = np.where(sticks if own.slip.ndim == 1 else sticks[:, None], own.slip, 0.0)
        kept.force = own.force
        if any(i.contact.contact != "frictionless" for i in self.interfaces):
            points = self._model.mesh.points + self._moved(trial)
            kept.friction = own.force - sum(i.push(trial, points) for i in self.interfaces)

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return what friction between the bodies takes [N mm]."""
        friction = state_n[InterfaceArrays].friction + trial[InterfaceArrays].friction
        return {"friction_work": -0.5 * float((friction * trial.nodes.increment[:, : friction.shape[1]]).sum())}


def _lengths(vectors: FloatArray) -> FloatArray:
    """Return the lengths of vectors (n, d), or of scalars (n,)."""
    return np.asarray(np.abs(vectors) if vectors.ndim == 1 else np.linalg.norm(vectors, axis=1))
