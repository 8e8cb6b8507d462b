# SPDX-License-Identifier: Apache-2.0
"""The contract of an interaction: all that acts on nodes beside their own cells.

Newton's method makes the same calls to every interaction of a run, in this order, and knows none of them by name:

    find_places       the run begins, or goes on with another mesh; nodes are found here
    begin_stage       a stage begins; what stands elsewhere from now on is put there
    begin_increment   the increment begins; what is taken from the converged state is taken here
    evaluate          forces on the nodes at a guess, with their derivative, or why the guess is bad
    update            hold and release nodes: changes of an active set at a guess
    constrain         what is prescribed of the nodes, in frames of their own
    resist            forces that follow from the reactions of what is held, such as friction
    tune              near equilibrium: what a law leaves open, such as a friction between none and all
    border            freedoms of its own, one equation each, such as a tool that a force pushes
    find_travel       where its own freedoms are
    augment           in equilibrium: whether multipliers are taken over and the iteration goes on
    find_fault        in equilibrium: why it is none
    end_increment     the increment has converged; what the next one needs goes into the trial state
    commit, work      the trial state becomes the converged one; work done in the increment [N mm]
    stop              the stage ends before its travel is complete
    stored            energy that is stored in it [N mm]

What it does in a neighbour of a run, by which derivatives are found, is another contract (led.py).

An interaction overrides what it needs and inherits the rest, which does nothing. Whatever persists lies in the State,
in Arrays that the interaction declares and returns from at_rest(): `state[InertiaArrays].velocity`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
import scipy

from presswork.model import FloatArray, IndexArray, IntArray, MaskArray, Mesh
from presswork.outcome import BadGuess, Step
from presswork.state import Arrays, State


@dataclass(frozen=True)
class Guess:
    """A guess at the nodes' displacement in an increment."""

    step: Step
    dt: float
    """Time of the increment [s]."""
    increment: FloatArray
    """(n_points, freedoms) [mm, rad]."""
    displacement: FloatArray
    """Since the start, in the same form."""


@dataclass(frozen=True)
class Forces:
    """Forces of one interaction on the nodes at a guess."""

    force: FloatArray
    """(n_points, d) [N, N mm], d at most the freedoms of a node."""
    pairs: IntArray
    """Node pairs (n, 2) of the derivative."""
    blocks: FloatArray
    """d(-force)/d(displacement) of each pair (n, d, d), d as in `force` or more."""
    dyads: Sequence[tuple[FloatArray, FloatArray]] = field(default=(), kw_only=True)
    """Parts c r^T of the same derivative that couple all nodes: c and r (n_points, freedoms)."""


@dataclass(frozen=True)
class Point:
    """All forces at one guess."""

    guess: Guess
    internal: FloatArray
    """Internal forces of the cells (n_points, freedoms) [N, N mm]."""
    forces: tuple[Forces | None, ...]
    """Forces of each interaction; None of one that exerts none by itself."""
    reaction: FloatArray
    """What holds the nodes: internal force less the forces of all interactions."""


@dataclass
class Constraints:
    """What the linear system must respect; freedoms are in the nodes' own frames."""

    mask: MaskArray  # (n_points, freedoms): prescribed
    value: FloatArray  # (n_points, freedoms): the correction still to be made [mm, rad]
    turned: MaskArray  # (n_points,): has a frame of its own
    frames: FloatArray  # (n_points, d, d): rows are the local axes of a node's displacement, of a shell's rotation


class Matrix(Protocol):
    """An assembler, to which interactions add stiffness."""

    @property
    def indptr(self) -> IntArray:
        """Where the rows of its values begin."""

    def add_blocks(
        self, pairs: IntArray, blocks: FloatArray, turned: MaskArray, frames: FloatArray, data: FloatArray
    ) -> None:
        """Add blocks (n, d, d) at pairs of nodes (n, 2)."""


class Resistance(Protocol):
    """Forces on the nodes that follow from the reactions of what is held."""

    def vector(self, n_points: int) -> FloatArray:
        """Return the nodal forces (n_points, freedoms) [N]."""

    def add_stiffness(
        self,
        assembler: Matrix,
        constraints: Constraints,
        data: FloatArray,
        *,
        symmetric: bool,
    ) -> None:
        """Add their derivative to the matrix."""


class Border(Protocol):
    """Freedoms of an interaction at a guess, as many equations as there are."""

    @property
    def missing(self) -> FloatArray:
        """What each equation lacks (n,) [N]."""

    @property
    def demand(self) -> FloatArray:
        """What each equation asks for, without its sign (n,) [N]."""

    @property
    def is_open(self) -> bool:
        """Whether there is any freedom to solve for."""


class Factors(Protocol):
    """The factorised system of the nodes, for the interaction that adds freedoms to it."""

    @property
    def constraints(self) -> Constraints:
        """What is prescribed of the nodes."""

    @property
    def responses(self) -> Sequence[FloatArray]:
        """The nodes' answers to the forces of find_columns, in the global frame (n_points, freedoms)."""

    def respond_in_frames(self, value: FloatArray, force: FloatArray) -> FloatArray:
        """Return the answer to prescribed values and forces, all in the nodes' own frames."""

    def matrix(self) -> scipy.sparse.csr_matrix:
        """Return the matrix before constraints, in the nodes' own frames, both its halves."""


class Interaction:
    """Acts on nodes; by itself it does nothing."""

    is_driving: ClassVar[bool] = False
    """Whether residuals are measured against its forces too."""
    softness: float = 1.0
    """How many times softer than they are its springs are taken, during the iteration to equilibrium."""
    n_undecided: int = 0
    """Nodes that may change no more in this increment, and pull."""

    @property
    def can_soften(self) -> bool:
        """Whether an increment that fails is worth another attempt with soft springs."""
        return False

    @property
    def has_consistent_tangent(self) -> bool:
        """Whether Newton's method may be expected to converge quadratically."""
        return True

    def find_places(self, mesh: Mesh) -> None:
        """Find the nodes that it acts on, when a run begins and whenever its mesh has changed."""

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return what it owns in the State, before the first increment."""
        return ()

    def surface_nodes(self) -> list[IntArray] | None:
        """Return the nodes that the rows of its surface arrays stand for (state.OnNewMesh), group after group.

        None: their rows are all nodes of the mesh.
        """
        return None

    def begin_stage(self, state: State, stage: int) -> bool:
        """Prepare a copy of the converged state for a stage that begins; return whether it releases what it held."""
        return False

    def place(self, state_n: State, trial: State, step: Step, ratio: float) -> None:
        """Put what moves by itself to where an increment leads; `ratio` of it to the increment before."""

    def lead(self, state_n: State, trial: State, guess: FloatArray) -> FloatArray:
        """Return a first guess (n_points, freedoms) [mm, rad] with its nodes where it expects them."""
        return guess

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Take note of an increment that begins."""

    def discard_guess(self, state_n: State, trial: State) -> None:
        """Take back what place() has guessed: the guess is bad."""

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces | BadGuess | None:
        """Return the forces on the nodes at a guess."""
        return None

    def predict(self, found: Forces, change: FloatArray) -> None:
        """Take note of a change of the nodes (n_points, freedoms) [mm] that is about to be evaluated."""

    def update(self, trial: State, point: Point, own: Forces | None, *, near: bool, pull: float) -> int:
        """Hold and release nodes; return the changes.

        near: equilibrium is near enough for reactions to be believed. pull: force below which a pull counts as none
        [N].
        """
        return 0

    def constrain(self, state_n: State, trial: State, point: Point, held: Constraints) -> Constraints:
        """Return what is prescribed, together with what others hold already."""
        return held

    def find_travel(self, state_n: State, trial: State, step: Step) -> FloatArray:
        """Return how far its own freedoms have gone in an increment (n,)."""
        return np.zeros(0)

    def resist(self, state_n: State, trial: State, point: Point, constraints: Constraints) -> Resistance | None:
        """Return the forces that follow from the reactions."""
        return None

    def tune(self, trial: State, point: Point, *, pull: float, credible: float) -> int:
        """Improve what its law leaves open at a guess; return how many nodes are not right yet.

        pull: as in update() [N]. credible: forces below it count as zero, since the residual is as large [N].
        """
        return 0

    def border(
        self, trial: State, point: Point, own: Forces | None, resistance: Resistance | None, *, near: bool
    ) -> tuple[Border | None, int]:
        """Return its own freedoms at a guess, and how many have come or gone."""
        return None, 0

    def find_columns(self, border: Any, own: Any) -> Sequence[FloatArray]:
        """Return forces on the nodes, global frame (n_points, freedoms), whose answers `correct` asks the factors for.

        They are found along with the correction, in one substitution. Without any `correct` may ask for
        respond_in_frames() and matrix().
        """
        return ()

    def correct(
        self, border: Any, own: Any, resistance: Any, solution: FloatArray, factors: Factors
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction of the nodes with its own freedoms in it, in the nodes' own frames, and these (n,).

        solution: the nodes' correction with its freedoms held (n_points, freedoms).
        """
        raise NotImplementedError

    def move(self, trial: State, border: Any, travel: FloatArray) -> None:
        """Move its freedoms by `travel` (n,)."""

    def augment(self, trial: State, own: Forces | None) -> bool:
        """Take multipliers over in equilibrium if they are not good enough yet."""
        return False

    def find_fault(self, own: Forces | None, loads: FloatArray, peak: float) -> str:
        """Explain why an equilibrium that was found is not valid; empty: it is.

        loads: on the nodes (n_points, d) [N]. peak: largest nodal force up to now [N].
        """
        return ""

    def end_increment(self, state_n: State, trial: State, own: Forces | None, constraints: Constraints) -> None:
        """Keep what an increment in equilibrium has found."""

    def commit(self, state_n: State, trial: State, step: Step) -> None:
        """Complete the trial state, whose nodes are where the increment ends."""

    def stop(self, state: State, stage: int, fraction: float) -> None:
        """Keep what a stage moves where it is: the stage ends at a fraction of its travel."""

    def end_stage(self, state: State, next_stage: int) -> None:
        """Prepare a converged state for the next stage."""

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return the work done in an increment by the names of energy.balance [N mm]."""
        return {}

    def stored(self, state: State) -> float:
        """Return the energy that a converged state stores in it [N mm]: contact_energy of energy.balance."""
        return 0.0


def turn(constraints: Constraints, vector: FloatArray) -> FloatArray:
    """Take a nodal vector into the nodes' own frames."""
    result = vector.copy()
    nodes, own = _find_turned(constraints), _in_frame(constraints, vector)
    result[nodes, own] = np.einsum("nij,nj->ni", constraints.frames[nodes], vector[nodes, own])
    return result


def turn_back(constraints: Constraints, vector: FloatArray) -> FloatArray:
    """Take a nodal vector from the nodes' own frames into the global one, in place."""
    nodes, own = _find_turned(constraints), _in_frame(constraints, vector)
    vector[nodes, own] = np.einsum("nji,nj->ni", constraints.frames[nodes], vector[nodes, own])
    return vector


def _find_turned(constraints: Constraints) -> IndexArray | slice:
    """Return the nodes that have frames of their own; a slice, which is faster, where all have, as in shells."""
    return slice(None) if constraints.turned.all() else np.nonzero(constraints.turned)[0]


def _in_frame(constraints: Constraints, vector: FloatArray) -> slice:
    """Return which freedoms of a nodal vector are taken in the nodes' frames."""
    first = 3 if vector.shape[1] == 6 else 0
    return slice(first, first + constraints.frames.shape[-1])
