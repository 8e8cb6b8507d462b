# SPDX-License-Identifier: Apache-2.0
"""Drawbeads on a shell in the implicit procedure: a restraining force per length across a line, with its tangent.

A point of the line holds the material beneath it, T = T_n - k s shortened to f w, s being the slip of the material
across the line in the increment, f the force per length and w the length that the point stands for; k = f w/s_0, so
that the sheet slips by s_0, a hundredth of its thickness, before it is held with all of f. T acts along d, the normal
of the line in the plan, laid into the sheet.

Which material is beneath, and d, are those of the begin of the increment: they do not change while it is iterated, and
the tangent k d d^T is exact. The line so lags behind by half of what the sheet flows in an increment.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.interaction.coulomb import return_to_limit
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import BoolArray, Drawbead, FloatArray, IndexArray, IntArray, Model, take_corners
from presswork.state import Arrays, State

SLIP = 0.01
"""Slip at which the whole force is reached, over the sheet's thickness."""


@dataclass
class BeadArrays(Arrays):
    """What drawbeads keep at the points of their lines."""

    owner = "drawbeads"
    force: FloatArray
    """Force on the sheet across the line (n_bead_points,) [N]."""
    cell: IntArray
    """The cell found beneath it last; -1: none yet (n_bead_points,)."""


@dataclass(frozen=True)
class BeadForces:
    """Forces of all beads on the nodes."""

    force: FloatArray
    """(n_points, 3) [N]"""
    pairs: IntArray
    """Node pairs (n, 2) of the stiffness."""
    blocks: FloatArray
    """d(-force)/dx (n, 3, 3) [N/mm]."""
    tension: FloatArray
    """T of each point of the lines (n_bead_points,) [N]."""


class SheetBeads:
    """The drawbeads of one run; what persists lies in the State."""

    def __init__(self, model: Model) -> None:
        self._model = model
        beads = model.beads
        self._place = np.concatenate([np.zeros((0, 2)), *(b.place for b in beads)])
        self._across = np.concatenate([np.zeros((0, 2)), *(b.across for b in beads)])
        self._limit = np.concatenate([np.zeros(0), *(b.force * b.length for b in beads)])
        self._of = np.repeat(np.arange(len(beads)), [len(b.place) for b in beads])
        names = [t.name for t in model.space_tools]
        self._tool = [names.index(b.tool) if b.tool is not None else -1 for b in beads]
        blocks = [take_corners(b.connectivity) for b in model.mesh.blocks]
        self._sheet = _core.SheetUnder([np.ascontiguousarray(b, dtype=np.int32) for b in blocks])
        thinnest = [float(b.thickness.min()) for b in model.mesh.blocks if b.section is not None]
        self._slip = SLIP * min(thinnest, default=1.0)
        n = len(self._place)
        self._cell: IntArray = np.full(n, -1, dtype=np.int32)
        self._inside: BoolArray = np.zeros(n, dtype=bool)
        self._nodes: IntArray = np.zeros((n, 4), dtype=np.int32)
        self._weight, self._direction = np.zeros((n, 4)), np.zeros((n, 3))

    def at_rest(self) -> BeadArrays:
        """Return the arrays of beads that hold nothing."""
        return BeadArrays(np.zeros(len(self._place)), np.full(len(self._place), -1, dtype=np.int32))

    def begin_increment(self, state_n: State) -> None:
        """Look what lies beneath when the increment begins."""
        if not len(self._place):
            return
        x = np.ascontiguousarray(self._model.mesh.points + state_n.nodes.displacement[:, :3])
        self._cell, inside, self._nodes, self._weight, normal = self._sheet.find(
            self._place, x, state_n[BeadArrays].cell
        )
        self._inside = inside.astype(bool)
        normal[~self._inside] = (0.0, 0.0, 1.0)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        d = np.column_stack([self._across, np.zeros(len(normal))])
        d -= np.einsum("ni,ni->n", d, normal)[:, None] * normal
        self._direction = d / np.linalg.norm(d, axis=1, keepdims=True)

    def evaluate(self, state_n: State, trial: State, displacement: FloatArray, share: FloatArray) -> BeadForces:
        """Return the forces of the beads at a guess; share (n_beads,): of their force."""
        n = len(displacement)
        slip = self._slips(state_n, trial, displacement[:, :3] - state_n.nodes.displacement[:, :3])
        stiffness = self._limit / self._slip
        pulled = state_n[BeadArrays].force - stiffness * slip
        limit = self._limit * share[self._of]
        tension = np.where(self._inside, return_to_limit(pulled, limit).force, 0.0)
        sticks = self._inside & (np.abs(pulled) < limit)
        force = np.zeros((n, 3))
        on_nodes = (self._weight * tension[:, None])[:, :, None] * self._direction[:, None, :]
        np.add.at(force, self._nodes[self._inside], on_nodes[self._inside])
        nodes, weight, d = self._nodes[sticks], self._weight[sticks], self._direction[sticks]
        pairs = np.stack([np.repeat(nodes, 4, axis=1), np.tile(nodes, (1, 4))], axis=2).reshape(-1, 2)
        blocks = np.einsum("n,na,nb,ni,nj->nabij", stiffness[sticks], weight, weight, d, d).reshape(-1, 3, 3)
        return BeadForces(force, pairs.astype(np.int32), blocks, tension)

    def _slips(self, state_n: State, trial: State, moved: FloatArray) -> FloatArray:
        """Return the slip of the material across the lines in the increment (n_bead_points,) [mm]."""
        slip = np.einsum("na,nai->ni", self._weight, moved[self._nodes]) - self._carried(state_n, trial)
        return np.asarray(np.einsum("ni,ni->n", self._direction, slip), dtype=np.float64)

    def _carried(self, state_n: State, trial: State) -> FloatArray:
        """Return how far tools have carried the lines in the increment (n_bead_points, 3) [mm]."""
        of_tool = np.vstack(
            [trial[SpaceToolArrays].displacement - state_n[SpaceToolArrays].displacement, np.zeros((1, 3))]
        )  # last: none
        return np.asarray(of_tool[np.array(self._tool, dtype=int)][self._of], dtype=np.float64)

    def share(self, stage: int, fraction: float) -> FloatArray:
        """Return the share of their force with which the beads hold at a fraction of a stage (n_beads,)."""
        tables = self._model.stages[stage].bead_share
        return np.array([np.interp(fraction, *tables[b.name].T) if b.name in tables else 1.0 for b in self._beads])

    @property
    def _beads(self) -> tuple[Drawbead, ...]:
        return self._model.beads

    def held_directions(self) -> tuple[IndexArray, FloatArray]:
        """Return nodes (n,) and unit vectors (n, 3) along which the beads hold them."""
        nodes = self._nodes[self._inside]
        return nodes.reshape(-1).astype(np.intp), np.repeat(self._direction[self._inside], 4, axis=0)

    def end_increment(self, trial: State, found: BeadForces) -> None:
        """Keep what an increment has found."""
        kept = trial[BeadArrays]
        kept.force, kept.cell = found.tension, self._cell

    def work(self, state_n: State, trial: State) -> tuple[float, float]:
        """Return the work of the tools that carry the beads in an increment, and what the beads take [N mm]."""
        slip = self._slips(state_n, trial, trial.nodes.increment[:, :3])
        tension = 0.5 * (state_n[BeadArrays].force + trial[BeadArrays].force)
        along = np.einsum("ni,ni->n", self._direction, self._carried(state_n, trial))
        return float(tension @ along), -float(tension @ slip)

    def restraints(self, state: State) -> list[float]:
        """Return the restraining force of each bead, summed along its line [N], of what is modelled."""
        sums = np.bincount(self._of, np.abs(state[BeadArrays].force), minlength=len(self._beads))
        return [float(s) for s in sums[: len(self._beads)]]
