# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies with each other, or of one with itself, in explicit dynamics of solids.

The kernel is cpp/explicit/contact/body_contact.hpp; docs/theory/explicit_contact.md has the formulas.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.integer[Any]]


@dataclass(frozen=True)
class TouchingSurfaces:
    """The two surfaces of a contact: faces in space, edges in the plane, by the mesh's numbers of nodes."""

    slave: Ints
    """(n, k): pressure is computed on its nodes."""
    master: Ints
    slave_cells: Ints
    """The cell behind each face (n, nodes)."""
    master_cells: Ints
    by_itself: bool
    """Whether a body touches itself: both lists are the same."""
    edge: float
    """Mean length of the edges of both [mm]."""
    thickness: float = 0.0
    """Normal to the plane [mm]; 0 of rings, and in space."""


def list_known(touching: Sequence[TouchingSurfaces]) -> npt.NDArray[np.int32]:
    """Return the nodes whose motion every rank must know, of surfaces that may touch and the cells behind them (n,)."""
    cells = [of.ravel() for each in touching for of in (each.slave_cells, each.master_cells)]
    return np.unique(np.concatenate([np.zeros(0, dtype=np.int32), *cells])).astype(np.int32)


class BodyContactOfRun:
    """A contact of bodies in an explicit run."""

    def __init__(
        self,
        loop: _core.SpaceLoop | _core.PlaneLoop,
        number: int,
        name: str,
        surfaces: TouchingSurfaces,
        nodes: npt.NDArray[np.intp],
        *,
        mu: float,
        reach: float,
        margin: float,
    ) -> None:
        """Add it to a loop whose nodes have these numbers in the mesh.

        mu: most of friction over pressure; reach, margin: parts of the mean edge, beyond which a gap counts as none and
        to which faces are looked for.
        """
        if not (0 <= mu <= 10):
            raise ExplicitError(f"mu of contact {name} = {mu}: it must lie between 0 and 10")
        self.name, self._loop, self._number, self._nodes = name, loop, number, nodes
        self.edge, self.mu = surfaces.edge, mu
        place = np.empty(len(nodes), dtype=np.int32)
        place[nodes] = np.arange(len(nodes))
        sides = (surfaces.slave, surfaces.master, surfaces.slave_cells, surfaces.master_cells)
        loop.add_contact(
            *(np.ascontiguousarray(place[side]) for side in sides),
            by_itself=surfaces.by_itself,
            edge=surfaces.edge,
            thickness=surfaces.thickness,
            mu=mu,
            reach=reach,
            margin=margin,
        )

    def set_step(self, dt: float) -> None:
        """Let the springs be stable with a step [s]."""
        self._loop.set_contact_step(self._number, dt)

    def limit_friction(self, limit: Array) -> None:
        """Let shear be no larger at the nodes of the mesh (n_nodes,) [MPa] from now on."""
        self._loop.limit_contact_friction(self._number, np.ascontiguousarray(limit[self.slots]))

    def check(self) -> None:
        """Raise ExplicitError where the bodies have gone through each other."""
        if self._loop.contact_passed(self._number):
            raise ExplicitError(
                f"contact {self.name}: surfaces have gone through each other: refine their meshes, or make the motion "
                "slower"
            )

    @property
    def slots(self) -> npt.NDArray[np.intp]:
        """Nodes of the slave, as the mesh has them (n_slots,)."""
        return self._nodes[self._loop.contact_slots(self._number)]

    @property
    def nodes(self) -> npt.NDArray[np.intp]:
        """Nodes of both surfaces, as the mesh has them (n,)."""
        return self._nodes[self._loop.contact_nodes(self._number)]

    def find_stiffness(self) -> Array:
        """Return the stiffness of the slots' springs as the next cycle has them (n_slots,) [MPa/mm]; 0: face nothing.

        The step must have been set. Surfaces are cut where they are, so a run in its cycles must not be asked.
        """
        return self._loop.find_contact_stiffness(self._number)

    @property
    def pressure(self) -> Array:
        """Return the pressure of the slots (n_slots,) [MPa]."""
        return self._loop.contact_pressure(self._number)

    @property
    def shear(self) -> Array:
        """Return the shear of the slots, on the slave (n_slots, 3) [MPa]."""
        return self._loop.contact_shear(self._number)

    @property
    def impulse(self) -> Array:
        """Impulse that the slave has given to the master since the start (3,) [N s]; none of a body with itself."""
        return self._loop.contact_impulse(self._number)

    @property
    def lost(self) -> float:
        """Work that friction has taken since the start [N mm]."""
        return float(self._loop.contact_work(self._number)[1])

    @property
    def push(self) -> Array:
        """Forces of the pressure on the nodes of the mesh in the last cycle (n_nodes, 3) [N]."""
        return self._by_node(self._loop.contact_push(self._number))

    @property
    def friction_force(self) -> Array:
        """Forces of friction on them (n_nodes, 3) [N]."""
        return self._by_node(self._loop.contact_rub(self._number))

    @property
    def area(self) -> Array:
        """Share of each node of the mesh in the surface that faces the other (n_nodes,) [mm2]."""
        return self._by_node(self._loop.contact_area(self._number)[:, None])[:, 0]

    def _by_node(self, values: Array) -> Array:
        out = np.zeros((len(self._nodes), values.shape[1]))
        out[self.nodes] = values
        return out


class TouchingBodies:
    """What a run of solids does with the contacts of its bodies."""

    _loop: Any
    _nodes: npt.NDArray[np.intp]
    contacts: Sequence[BodyContactOfRun] = ()

    def add_contact(
        self, name: str, surfaces: TouchingSurfaces, *, mu: float, reach: float, margin: float
    ) -> BodyContactOfRun:
        """Let two bodies, or a body and itself, hold each other off; all as BodyContactOfRun has it."""
        number = len(self.contacts)
        added = BodyContactOfRun(self._loop, number, name, surfaces, self._nodes, mu=mu, reach=reach, margin=margin)
        self.contacts = (*self.contacts, added)
        return added

    def _prepare_contacts(self, step: float) -> None:
        """Let springs be stable with a step [s]."""
        for contact in self.contacts:
            contact.set_step(step)

    def _check_contacts(self) -> None:
        """Raise ExplicitError where bodies have gone through each other."""
        for contact in self.contacts:
            contact.check()
