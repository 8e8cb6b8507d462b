# SPDX-License-Identifier: Apache-2.0
"""A body that nothing holds rests where it is, in explicit runs that form.

Forming is slow. A part that springs off its tool does so at a speed of the elastic rebound, and nothing but its weight
and its tools would ever stop it. So where a row ends and nothing holds a body along a rigid motion, this motion is
taken off the velocities. Nothing acts along it until a tool or another body touches, so it stays zero.

With phi the rigid motions that are free, orthonormal by the masses m of the nodes, the velocity loses

    phi (sum m phi . v).

Bodies with an initial velocity are meant to fly: a run that has one keeps all its motions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.explicit.dynamics import Dynamics
from presswork.interaction.loose_bodies import list_loose, make_orthonormal
from presswork.interaction.rigid_motions import (
    Held,
    RigidMotions,
    about_points,
    find_free,
    find_named,
    hold_along,
    hold_by_supports,
    name_motions,
    spread,
    spread_contact,
)
from presswork.interaction.supports import Supports
from presswork.model import FloatArray, Model, list_bodies
from presswork.process.explicit.contacts import ContactsOfRun

SMALL = 1e-4
"""Way in the stage, over the size of the bodies, below which a motion may stay."""
ONE_SIDED = 0.5
"""Resultant of forces, over the sum of their sizes, from which they push one way."""
STOPPED, SINCE, HELD, DISTANCE = "loose_stopped", "loose_since", "loose_held", "loose_way"
"""Names in a checkpoint."""


class LooseRows:
    """The motions that nothing holds at the ends of rows."""

    def __init__(self, model: Model) -> None:
        shape = len(list_bodies(model)), len(name_motions(model))
        self._stopped = np.zeros(shape, dtype=bool)
        """Motions that were stopped and that nothing has held since (n_bodies, n_motions)."""
        self._since = np.full(shape, -1)
        """The first stage in which a motion was stopped for longer than a row, -1: none (n_bodies, n_motions)."""
        self._held = np.zeros(shape, dtype=bool)
        """Motions that something held again when that stage ended (n_bodies, n_motions).

        A part that one tool pushes to another bounces off it and rests until the tool follows: nothing to warn of."""
        self._distance = np.zeros(shape[0])
        """The longest displacement that a body would have in a stage (n_bodies,) [mm]."""

    def end_row(
        self, model: Model, stage: int, run: Dynamics, mass: FloatArray, tools: Sequence[Held] = (),
        contacts: ContactsOfRun | None = None, *, pressed: bool = False,
    ) -> None:  # fmt: skip
        """Stop what moves as a rigid body and nothing holds when a row of a stage ends.

        mass: of the nodes (n_points,) [t]. tools: nodes (n,) that each touches, and unit vectors (n, d) along which it
        holds them. pressed: whether tools press the bodies between them.
        """
        position, velocity, bodies, d = run.position, run.velocity, list_bodies(model), model.dimension
        motions = about_points(model, position)
        free = find_free(_find_holds(model, stage, motions, position, tools, contacts))
        loose = find_named(free)
        self._end_row(loose, stage, pressed=pressed)
        if not free.shape[2]:
            return
        moves = np.zeros((*velocity.shape, free.shape[2]))
        for body, own in zip(bodies, free, strict=True):
            points = slice(body.points.start, body.points.stop)
            moves[points] = motions.move(position[points])[:, : velocity.shape[1]] @ own
        moves = make_orthonormal(moves, mass, d)
        rigid = moves @ np.einsum("nik,n,ni->k", moves[:, :d], mass, velocity[:, :d])
        distance = np.linalg.norm(rigid[:, :d], axis=1) * model.stages[stage].duration
        if distance.max() <= SMALL * float(np.ptp(position, axis=0).max()):
            return
        run.take_off(rigid)
        for number, body in enumerate(bodies):
            gone = float(distance[body.points.start : body.points.stop].max())
            if gone > SMALL * float(np.ptp(position, axis=0).max()):
                self._stopped[number] |= loose[number]
                self._distance[number] = max(self._distance[number], gone)

    def hold(self, stage: int, *, pressed: bool) -> None:
        """Note that all bodies are held where a row of a stage ends; pressed: between tools."""
        self._end_row(np.zeros_like(self._stopped), stage, pressed=pressed)

    def _end_row(self, loose: NDArray[np.bool_], stage: int, *, pressed: bool) -> None:
        """Note the motions that nothing holds where a row of a stage ends."""
        forgotten = self._held & (self._since != stage)
        self._since[forgotten] = -1
        self._stopped &= loose
        self._since[self._stopped & (self._since < 0)] = stage
        self._held = np.where(self._since == stage, ~loose & pressed, self._held & ~forgotten)

    def warn(self, model: Model) -> list[str]:
        """Return what a user should know of bodies that were stopped."""
        return [
            f"{text}: it came off its tools at a speed that takes it {self._distance[number]:.3g} mm in the stage, and "
            "was stopped. Add a [boundary] entry, or let a tool hold it"
            for number, text in list_loose(model, np.where(self._held, -1, self._since))
        ]

    def to_arrays(self) -> dict[str, NDArray[Any]]:
        """Return what a checkpoint keeps."""
        kept = {STOPPED: self._stopped, SINCE: self._since, HELD: self._held, DISTANCE: self._distance}
        return {name: array.copy() for name, array in kept.items()}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what to_arrays gave."""
        self._stopped, self._since, self._held, self._distance = (
            np.array(arrays[name]) for name in (STOPPED, SINCE, HELD, DISTANCE)
        )


def is_pressed(forces: FloatArray) -> bool:
    """Whether forces (n, d) on a workpiece push against one another; a part that flies touches one tool at most."""
    return bool(np.linalg.norm(forces.sum(axis=0)) < ONE_SIDED * np.linalg.norm(forces, axis=1).sum())


def find_held_by_wall(force: FloatArray, mu: float) -> Held:
    """Return the nodes (n,) that a tool touches and unit vectors (n, d) along which it holds them.

    force: of the tool on the nodes (n_points, d) [N]; mu: of its friction.
    """
    size = np.linalg.norm(force, axis=1)
    nodes = np.flatnonzero(size > 0.0)
    if mu == 0.0:
        return nodes, force[nodes] / size[nodes, None]
    d = force.shape[1]
    return np.repeat(nodes, d), np.tile(np.eye(d), (len(nodes), 1))


def _find_holds(
    model: Model, stage: int, motions: RigidMotions, position: FloatArray, tools: Sequence[Held],
    contacts: ContactsOfRun | None,
) -> FloatArray:  # fmt: skip
    """Return what all that holds bodies feels of their rigid motions (n, n_bodies, n_motions)."""
    supports, bodies = Supports(model), list_bodies(model)
    rows = hold_by_supports(motions, position, supports.fixed(stage), supports.slanted(stage))
    rows += [hold_along(motions, position, held) for held in tools]
    found = [spread(bodies, rows, len(name_motions(model)))]
    for contact, added in zip(model.contacts, contacts.added if contacts else (), strict=True):
        push = added.push[added.slots][:, : model.dimension]
        own, along = find_held_by_wall(push, added.mu)
        places = position[added.slots][own]
        found.append(spread_contact(motions, len(bodies), contact, places, along))
    return np.concatenate(found)
