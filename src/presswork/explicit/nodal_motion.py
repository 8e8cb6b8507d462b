# SPDX-License-Identifier: Apache-2.0
"""Nodes of an explicit loop: how they move, which forces they have, and what is prescribed of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork.explicit.input_checks import ExplicitError, check_nodal

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.intp]


class NodalMotion:
    """The nodes of a loop.

    Elements and nodes may be renumbered inside for the sake of the cache; every array here is in the order given.
    """

    FREEDOMS = ""
    """Letters of a node's freedoms."""

    def __init__(
        self,
        loop: Any,
        nodes: Numbers,
        elements: Numbers,
        node_sets: Mapping[str, npt.NDArray[np.integer[Any]]] | None,
        fastest: float,
    ) -> None:
        """Begin with a loop as Dynamics does."""
        self._loop = loop
        self._nodes, self._elements = nodes, elements
        self._in_order = bool((nodes == np.arange(len(nodes))).all())
        self._node_sets, self._fastest = dict(node_sets or {}), fastest
        self._fixed = np.zeros((len(nodes), len(self.FREEDOMS)), dtype=np.uint8)
        self._prescribed = np.zeros(self._fixed.shape)
        self._reference: tuple[float, float] | None = None
        """Energy at the start and the largest so far [N mm]; None before the first cycle, and after new velocities."""

    def _by_node(self, inside: Array) -> Array:
        if self._in_order:
            return inside
        out = np.empty_like(inside)
        out[self._nodes] = inside
        return out

    def _by_element(self, inside: Array) -> Array:
        out = np.empty_like(inside)
        out[self._elements] = inside
        return out

    @property
    def position(self) -> Array:
        """Positions (n_nodes, dimension) [mm]."""
        return self._by_node(self._loop.position)

    @property
    def velocity(self) -> Array:
        """Velocities of the freedoms (n_nodes, freedoms) [mm/s, 1/s], half a step back."""
        return self._by_node(self._loop.velocity)

    @velocity.setter
    def velocity(self, value: npt.ArrayLike) -> None:
        given = self._shaped(value, "velocity")
        self._check_speed(given)
        self._loop.velocity = given[self._nodes]
        self._reference = None

    @property
    def force(self) -> Array:
        """Nodal forces and moments from outside (n_nodes, freedoms) [N, N mm]; of the whole ring in axisymmetry."""
        return self._by_node(self._loop.force)

    @force.setter
    def force(self, value: npt.ArrayLike) -> None:
        self._loop.force = self._shaped(value, "force")[self._nodes]

    @property
    def internal_force(self) -> Array:
        """Internal forces and moments (n_nodes, freedoms) [N, N mm], less the forces of tools."""
        return self._by_node(self._loop.internal_force)

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms since reset_reaction (n_nodes, freedoms) [N s, N mm s]."""
        return self._by_node(self._loop.reaction_impulse)

    def reset_reaction(self) -> None:
        """Begin a new sum of reaction_impulse."""
        self._loop.reaction_impulse = np.zeros(self._fixed.shape)

    def _shaped(self, value: npt.ArrayLike, name: str) -> Array:
        return check_nodal(value, name, self._fixed.shape)

    def _check_speed(self, velocity: Array) -> None:
        speed = float(np.abs(velocity).max(initial=0.0))
        if speed > self._fastest:
            raise ExplicitError(
                f"a velocity of {speed:g} mm/s is beyond the material's sound, {self._fastest:.3g} mm/s: velocities "
                "are in mm/s, 1 m/s is 1000"
            )

    def nodes_of(self, nodes: str | npt.ArrayLike) -> Numbers:
        """Give node numbers: those of a node set of the mesh by its name, or the numbers given."""
        if isinstance(nodes, str):
            if nodes not in self._node_sets:
                known = ", ".join(sorted(self._node_sets)) or "none"
                raise ExplicitError(f"there is no node set {nodes!r}; the mesh has: {known}")
            return np.asarray(self._node_sets[nodes], dtype=np.intp)
        given = np.asarray(nodes)
        numbers = np.flatnonzero(given) if given.dtype == bool else np.atleast_1d(given.astype(np.intp))
        outside = (numbers < 0) | (numbers >= len(self._fixed))
        if outside.any():
            raise ExplicitError(f"there is no node {numbers[outside][0]}: they are 0 to {len(self._fixed) - 1}")
        return numbers

    def fix(self, nodes: str | npt.ArrayLike, freedoms: str, velocity: npt.ArrayLike = 0.0) -> None:
        """Prescribe the velocity [mm/s or 1/s], one or one for each node, of freedoms: letters of FREEDOMS."""
        if not freedoms or set(freedoms) - set(self.FREEDOMS):
            raise ExplicitError(f"freedoms = {freedoms!r}: give letters of {self.FREEDOMS!r}")
        numbers, value = self.nodes_of(nodes), np.asarray(velocity, dtype=float)
        self._check_speed(value)
        for letter in freedoms:
            self._fixed[numbers, self.FREEDOMS.index(letter)] = 1
            self._prescribed[numbers, self.FREEDOMS.index(letter)] = value
        self._loop.prescribe(self._fixed[self._nodes], self._prescribed[self._nodes])

    def release(self) -> None:
        """Let every freedom go that fix has prescribed."""
        self._fixed[:] = 0
        self._prescribed[:] = 0.0
        self._loop.prescribe(self._fixed, self._prescribed)
