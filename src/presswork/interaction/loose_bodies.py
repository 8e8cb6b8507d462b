# SPDX-License-Identifier: Apache-2.0
"""A body that nothing holds rests where it is.

Each body hangs on a spring that feels the rigid part of an increment alone. With phi the rigid motions about the middle
of the body that no support prevents, orthonormal by the nodes' shares w of its volume (sum w phi_i phi_j = 1 if i = j,
else 0),

    f = -k w phi (sum w phi . du),   k = SOFT E / L^2

L is the size of the body, so that the whole spring is SOFT times as stiff as the body's own extension. The forces of
cells are in balance by themselves. So where nothing else acts along a rigid motion, equilibrium asks for du without
that motion, and the spring carries no force. Where tools, bodies or friction hold the body, the force of the spring is
about SOFT of theirs. The tangent has k w on the diagonal, which is the same on rigid motions and next to nothing on all
others.

In the first stage the springs act once a body has been found loose: a run begins only with bodies that something holds.

Equilibrium along a rigid motion is as good as its tolerance: a body would go on with the guess, so this begins without
the motions that nothing pushed or held before (`steady`).

Where loads push a body that nothing holds, only this spring would carry them: such an increment fails.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.interaction.inertia import share_volume
from presswork.interaction.rigid_motions import (
    about_points,
    find_free,
    hold_by_supports,
    name_body,
    name_motions,
    spread,
)
from presswork.interaction.supports import Supports
from presswork.model import FloatArray, Model, list_bodies
from presswork.outcome import Step
from presswork.state import RUN, Arrays, OnNewMesh, State

SOFT = 1e-8
"""Stiffness of the spring over that of the body's extension."""
CARRIES = 0.5
"""Part of the loads along a rigid motion beyond which nothing but the spring carries them."""
NO_LOAD = 1e-2
"""Resultant of the loads, over the largest nodal force so far, that counts as none: forces out of balance add to it."""


@dataclass
class LooseArrays(Arrays):
    """What nothing has held."""

    owner = "loose"
    on_new_mesh: ClassVar[dict[str, OnNewMesh]] = {"stage": RUN, "free": RUN}
    stage: NDArray[np.int64]
    """The first stage in which nothing held a body along a rigid motion, -1: none (n_bodies, n_motions)."""
    free: FloatArray
    """Projector onto the rigid motions of all bodies that nothing pushes or holds (n_bodies n_motions, the same)."""


@dataclass(frozen=True)
class _Spring:
    """Spring of one body in an increment."""

    points: slice
    motions: FloatArray
    """Moves of the nodes in the motions that no support prevents, orthonormal by the weight (n, d, k)."""
    weight: FloatArray
    """k w of each node (n,) [N/mm]."""
    name: str
    """Name of the body."""


class LooseBodies(Interaction):
    """The springs of one model's bodies."""

    def __init__(self, model: Model, supports: Supports) -> None:
        self._model, self._supports = model, supports
        self._bodies = list_bodies(model)
        self._weights = []
        for body in self._bodies:
            blocks = [model.mesh.blocks[b] for b in body.blocks]
            volume = np.sum([share_volume(model, block) for block in blocks], axis=0)
            own = slice(body.points.start, body.points.stop)
            young = max(model.materials[block.material].young for block in blocks)
            size = float(np.ptp(model.mesh.points[own], axis=0).max())
            self._weights.append(SOFT * young / size**2 * volume[own])
        self._springs: list[_Spring] = []

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return that everything has been held."""
        shape = len(self._bodies), len(name_motions(self._model))
        return (LooseArrays(np.full(shape, -1), np.zeros(2 * (shape[0] * shape[1],))),)

    def steady(self, state_n: State, guess: FloatArray) -> FloatArray:
        """Return a guess of the increment after a converged state without rigid motions that nothing pushes or holds.

        Equilibrium is as good anywhere along these, so a body would go on with the guess.
        """
        free, model = state_n[LooseArrays].free, self._model
        if not free.any():
            return guess
        points, d = model.mesh.points + state_n.nodes.moved, model.dimension
        motions, parts = about_points(model, points), []
        for body, weight in zip(self._bodies, self._weights, strict=True):
            own = slice(body.points.start, body.points.stop)
            moves = motions.move(points[own])[:, : guess.shape[1]]
            root = np.sqrt(weight)[:, None]
            rows = (root[:, :, None] * moves[:, :d]).reshape(-1, moves.shape[2])
            parts.append((own, moves, np.linalg.lstsq(rows, (root * guess[own, :d]).ravel(), rcond=None)[0]))
        rigid = (free @ np.concatenate([part for _, _, part in parts])).reshape(len(parts), -1)
        steadied = guess.copy()
        for (own, moves, _), taken in zip(parts, rigid, strict=True):
            steadied[own, : moves.shape[1]] -= moves @ taken
        return steadied

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Find the motions that the supports of the stage leave free, and their moves where the nodes are."""
        model, supports = self._model, self._supports
        self._springs = []
        is_first = step.stage == 0 and (state_n[LooseArrays].stage < 0).all()
        if is_first:
            return
        points = model.mesh.points + state_n.nodes.moved
        motions = about_points(model, points)
        rows = hold_by_supports(motions, points, supports.fixed(step.stage), supports.slanted(step.stage))
        d, n_motions = model.dimension, len(name_motions(model))
        for body, weight in zip(self._bodies, self._weights, strict=True):
            free = find_free(spread([body], rows, n_motions))[0]
            if free.shape[1]:
                own = slice(body.points.start, body.points.stop)
                moves = np.einsum("nij,jk->nik", motions.move(points[own])[:, :d], free)
                self._springs.append(_Spring(own, make_orthonormal(moves, weight, d), weight, name_body(model, body)))

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces | None:
        """Return the forces of the springs at a guess."""
        if not self._springs:
            return None
        d = self._model.dimension
        force, nodes, blocks = np.zeros((len(guess.increment), d)), [], []
        for spring in self._springs:
            moved = guess.increment[spring.points, :d] * spring.weight[:, None]
            along = np.einsum("nik,ni->k", spring.motions, moved)
            force[spring.points] = -spring.weight[:, None] * (spring.motions @ along)
            nodes.append(np.arange(spring.points.start, spring.points.stop, dtype=np.int32))
            blocks.append(spring.weight[:, None, None] * np.eye(d))
        own = np.concatenate(nodes)
        return Forces(force, np.column_stack([own, own]), np.concatenate(blocks))

    def find_fault(self, own: Forces | None, loads: FloatArray, peak: float) -> str:
        """Explain where loads push a body that nothing holds; empty where there is none."""
        if own is None:
            return ""
        d = self._model.dimension
        for spring in self._springs:
            load, force = loads[spring.points, :d], own.force[spring.points]
            pushed, borne = (np.einsum("nik,ni->k", spring.motions, of) for of in (load, force))
            resultant = float(np.linalg.norm(pushed) * np.sqrt(spring.weight.sum()))
            if np.linalg.norm(borne) > CARRIES * np.linalg.norm(pushed) and resultant > NO_LOAD * peak:
                return f"loads push {spring.name}, and nothing holds it"
        return ""


def warn_of_loose(model: Model, state: State) -> list[str]:
    """Return what a user should know of bodies that nothing has held."""
    if LooseArrays not in state:
        return []
    rests = "it rests where it is. Add a [boundary] entry, or let a tool hold it"
    return [f"{text}: {rests}" for _, text in list_loose(model, state[LooseArrays].stage)]


def list_loose(model: Model, first_stage: NDArray[np.int64]) -> Iterator[tuple[int, str]]:
    """Yield the number of each body that nothing has held, and a text that names it, its motions and the stage.

    first_stage: as in LooseArrays (n_bodies, n_motions).
    """
    names = name_motions(model)
    for number, (body, first) in enumerate(zip(list_bodies(model), first_stage, strict=True)):
        for stage in np.unique(first[first >= 0]):
            free = " and ".join(name for name, since in zip(names, first, strict=True) if since == stage)
            yield (
                number,
                f"nothing holds {name_body(model, body)} in {free} in stage {model.stages[stage].name!r}",
            )


def make_orthonormal(moves: FloatArray, weight: FloatArray, d: int) -> FloatArray:
    """Return motions (n, freedoms, k) as combinations of which the products are one or zero.

    Products are of the first d freedoms, weighted by (n,).
    """
    product = np.einsum("nik,n,nil->kl", moves[:, :d], weight, moves[:, :d])
    return np.asarray(moves @ np.linalg.inv(np.linalg.cholesky(product)).T)
