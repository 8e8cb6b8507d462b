# SPDX-License-Identifier: Apache-2.0
"""How deep the workpiece has been in tools: its nodes, and the edges between them, which may cut a tool's corner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.mesh.edges import edge_shape_functions
from presswork.model import FloatArray, Model
from presswork.procedure.contact import Contact
from presswork.state import State

_BETWEEN = np.linspace(-1.0, 1.0, 10)[1:-1]
"""Where edges are looked at."""


@dataclass
class Penetration:
    """The largest penetrations of the converged states so far [mm]."""

    node: float = 0.0
    edge: float = 0.0

    def note(self, model: Model, contact: Contact, state: State) -> None:
        """Look at a converged state."""
        if not model.tools:
            return
        points = model.mesh.points + state.displacement
        self.node = max(self.node, _depth(contact, state, points[contact.nodes]))
        edges = model.mesh.boundary_edges
        along = [np.einsum("a,eai->ei", edge_shape_functions(edges.shape[1], s)[0], points[edges]) for s in _BETWEEN]
        self.edge = max(self.edge, self.node, _depth(contact, state, np.concatenate(along)))


def _depth(contact: Contact, state: State, points: FloatArray) -> float:
    """Return how deep the deepest of the points is inside a tool."""
    return max(0.0, -float(contact.find_gaps(state, points).min(initial=0.0)))
