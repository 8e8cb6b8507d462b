# SPDX-License-Identifier: Apache-2.0
"""Shells of an explicit run that touch shells (cpp/explicit/contact/shell_contact.hpp)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError, check_points

Array = npt.NDArray[np.float64]
MOST_PENALTY, MOST_DAMPING = 0.1, 0.5
DEEPEST_START = 0.5
"""Part of the thickness by which shells may overlap when they start: a part that was pressed together in an operation
before does so a little."""


class ShellContactOfRun:
    """What an explicit run does with shells that touch shells."""

    _loop: _core.SpaceLoop | _core.SpaceLoopSingle
    _nodes: npt.NDArray[np.intp]
    _elements: npt.NDArray[np.intp]
    _reference: tuple[float, float] | None
    _contact_step: float
    start: Array

    def _start_shell_contact(self) -> None:
        self.touches_itself = False

    def touch_itself(
        self, *, mu: float = 0.0, undeformed: npt.ArrayLike | None = None, penalty: float = 0.05, damping: float = 0.1
    ) -> None:
        """Let shells touch shells from now on, of one sheet or of several, on both faces and with their thickness.

        mu: Coulomb's coefficient. undeformed: positions (n_nodes, 3) [mm] of the flat sheet, by which shells too near
        along it to be touched are left out; without it: those that the run began with. penalty: stiffness over
        mass/dt^2. damping: over critical. Raises ExplicitError.
        """
        if self.touches_itself:
            raise ExplicitError("shells touch each other already: call touch_itself once")
        if not 0 <= mu < np.inf:
            raise ExplicitError(f"mu = {mu:g}: Coulomb's coefficient is not negative")
        if not 0 < penalty <= MOST_PENALTY:
            raise ExplicitError(f"penalty = {penalty:g}: take above 0 and at most {MOST_PENALTY:g}, for a stable step")
        if not 0 <= damping <= MOST_DAMPING:
            raise ExplicitError(f"damping = {damping:g}: take 0 to {MOST_DAMPING:g} of critical, for a stable step")
        flat = self.start if undeformed is None else np.array(undeformed, dtype=float)
        check_points(flat, 3)
        if flat.shape != self.start.shape:
            raise ExplicitError(f"undeformed: {len(flat)} positions for {len(self.start)} nodes")
        try:
            self._loop.add_shell_contact(flat[self._nodes], friction=mu, penalty=penalty, damping=damping)
        except ValueError as error:
            raise ExplicitError(str(error)) from None
        self.touches_itself, self._contact_step, self._reference = True, 0.0, None
        depth, node, shell = self.find_overlap()
        if depth > DEEPEST_START * float(self._loop.thickness(0).min()):
            raise ExplicitError(
                f"the sheet starts in itself: node {node} is {depth:.4g} mm deep in shell {shell}, half the thickness "
                "of both counted; move the parts off each other by that"
            )

    @property
    def shell_contact_force(self) -> Array:
        """Forces of shells that touch shells on the nodes (n_nodes, 3) [N]."""
        inside = self._loop.shell_contact_force()
        out = np.empty_like(inside)
        out[self._nodes] = inside
        return out

    def find_overlap(self) -> tuple[float, int, int]:
        """Return by how much two shells overlap most [mm], the node that lies deepest and the shell that it lies in.

        Where none overlap, 0, -1, -1.
        """
        if not self.touches_itself:
            return 0.0, -1, -1
        depth, node, shell = self._loop.deepest_in_shell()
        return depth, int(self._nodes[node]) if node >= 0 else -1, int(self._elements[shell]) if shell >= 0 else -1
