# SPDX-License-Identifier: Apache-2.0
"""The way of a crack through a section: along the ridge of the mean damage, as far as it is beyond its critical value.

A crack steps by half of the length over which damage is averaged, each time towards where the mean ahead is largest.
It begins at the surface nearest to the largest mean, or inside where no surface is near. Where less than the length is
left ahead of it to another surface no mean can be taken any more: there it goes through.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from presswork.geometry.polygon import contains
from presswork.model import BoolArray, FloatArray

STEP = 0.5
"""Step of a crack over the length."""
TURN, FIRST_TURN = np.radians(45.0), np.radians(60.0)
"""Largest turn of a step, and of the first one off the normal of the surface."""
AHEAD = np.array([0.5, 1.0, 1.5, 2.0])
"""Distances over the step at which the damage ahead is looked at."""
STRAIGHT = 0.05
"""How much of the damage ahead a turn to the side by TURN must be worth."""
CONE = np.cos(np.radians(50.0))
"""Cosine of the half angle within which a surface lies ahead."""
AWAY = 2.0
"""Least distance of a new crack from others, over the length."""
CHIP = 2.0
"""Least distance between the mouths of a crack that goes through, over the length."""
FIRST_STEPS = 2
"""Least steps of a crack that begins at a surface."""
ACTIVE = 0.02
"""Least growth of the mean ahead of a crack, over the largest one that a row has had."""
_DIRECTIONS, _NEAREST, _MOST_STEPS, _ROUNDS = 31, 4, 400, 2


@dataclass(frozen=True)
class CrackPath:
    """Where a crack grows."""

    points: FloatArray
    """From its beginning on (n, 2) [mm]."""
    begins_inside: bool = False
    """Whether it begins inside the metal."""
    ends_outside: bool = False
    """Whether its end lies on another surface."""
    met: int | None = None
    """Number of the tip of another crack at which it ends."""


class DamagedSection:
    """The mean damage of a section over its critical value, and the sides that a crack may begin or end at."""

    def __init__(self, middles: FloatArray, ratio: FloatArray, gains: FloatArray, length: float, most: float) -> None:
        """middles: of the cells (n, 2) [mm]; ratio: mean damage over the critical one (n,); gains: by what the mean has
        grown in the last row (n,), in any unit; length: over which it is taken [mm]; most: largest growth in any row.
        """
        self._middles, self._ratio, self._gains = middles, ratio, gains
        self._least = ACTIVE * most
        self._length, self._step = length, STEP * length
        self._tree = scipy.spatial.cKDTree(middles)

    def see(self, sides: FloatArray, is_open: BoolArray, tips: Mapping[int, FloatArray]) -> None:
        """Take an outline as it is now.

        sides: of the outline, the metal on their left (k, 2, 2) [mm]; is_open: those that are no plane of symmetry
        (k,); tips: places of the tips of cracks (2,) [mm] by their numbers.
        """
        self._sides, self._open, self._tips = sides, sides[is_open], dict(tips)

    def find_new(self, cracks: FloatArray) -> CrackPath | None:
        """Return a new crack where the mean is largest and critical, away from others; None: nowhere.

        cracks: places on the faces of others (m, 2) [mm].
        """
        ratio = self._ratio
        if len(cracks):
            distance, _ = scipy.spatial.cKDTree(cracks).query(self._middles)
            ratio = np.where(distance < AWAY * self._length, 0.0, ratio)
        while (worst := int(np.argmax(ratio))) >= 0 and ratio[worst] >= 1.0:
            place = self._middles[worst]
            path = self._begin(place)
            if path is not None:
                return path
            away = np.linalg.norm(self._middles - place, axis=1)
            ratio = np.where(away < 0.5 * self._length, 0.0, ratio)
        return None

    def _begin(self, place: FloatArray) -> CrackPath | None:
        """Return a crack that begins at the surface nearest to a place (2,), or there where none is near."""
        at, normal = self._find_surface(place)
        if np.linalg.norm(at - place) > self._length:
            return self._grow_inside(place)
        inwards = place - at if np.linalg.norm(place - at) > 0.1 * self._step else normal
        path = self.grow(at, inwards / np.linalg.norm(inwards), turn=float(FIRST_TURN))
        return path if path is not None and len(path.points) > FIRST_STEPS else None

    def grow(self, start: FloatArray, heading: FloatArray, *, turn: float = float(TURN)) -> CrackPath | None:
        """Return how a crack goes on from a place (2,) in a direction (2,); None: not at all.

        turn: largest turn of the first step [rad].
        """
        path = [start]
        for _ in range(_MOST_STEPS):
            met = self._find_tip(path[-1], heading)
            if met is not None:
                return CrackPath(_smooth(np.array([*path, self._tips[met]])), ends_outside=True, met=met)
            end = self._find_ahead(path[-1], heading)
            far = end is not None and np.linalg.norm(end - path[0]) > CHIP * self._length
            if end is not None and (len(path) > 1 or turn == TURN) and far:
                return CrackPath(_smooth(np.array([*path, end])), ends_outside=True)
            step = self._choose_step(path[-1], heading, turn)
            if step is None:
                break
            path.append(path[-1] + self._step * step)
            heading, turn = step, float(TURN)
        return CrackPath(_smooth(np.array(path))) if len(path) > 1 else None

    def _grow_inside(self, place: FloatArray) -> CrackPath | None:
        """Return a crack that grows from a place inside in two opposite directions."""
        first = self._choose_step(place, np.array([1.0, 0.0]), float(np.pi))
        forth = None if first is None else self.grow(place, first)
        if forth is None:
            return None
        heading = place - forth.points[1]
        back = self.grow(place, heading / np.linalg.norm(heading))
        if back is None:
            return CrackPath(forth.points, True, forth.ends_outside, forth.met)
        if not back.ends_outside:
            return CrackPath(np.concatenate([back.points[:0:-1], forth.points]), True, forth.ends_outside, forth.met)
        if forth.ends_outside:  # one end at a time: the other one grows before the next row
            return CrackPath(forth.points, True, True, forth.met)
        return CrackPath(np.concatenate([forth.points[:0:-1], back.points]), True, True, back.met)

    def _choose_step(self, place: FloatArray, heading: FloatArray, turn: float) -> FloatArray | None:
        """Return the direction of the next step; None: the metal ahead is sound."""
        angles = np.linspace(-turn, turn, _DIRECTIONS)
        cos, sin = np.cos(angles), np.sin(angles)
        directions = np.column_stack([cos * heading[0] - sin * heading[1], sin * heading[0] + cos * heading[1]])
        ahead = place + self._step * AHEAD[:, None, None] * directions
        found, gains = (self._at(ahead.reshape(-1, 2), of).reshape(len(AHEAD), -1) for of in (self._ratio, self._gains))
        inside = contains(self._sides, ahead[1])
        score = np.where(inside, gains.mean(axis=0) * (1.0 - STRAIGHT * (angles / TURN) ** 2), -np.inf)
        best = int(np.argmax(score))
        goes = inside[best] and found[:2, best].mean() >= 1.0 and gains[:, best].mean() >= self._least
        return directions[best] if goes else None

    def _at(self, places: FloatArray, values: FloatArray) -> FloatArray:
        """Return values of the cells (n_cells,) at places (n, 2) (n,)."""
        distance, near = self._tree.query(places, k=_NEAREST)
        weight = 1.0 / (distance**2 + 1e-4 * self._step**2)
        return np.asarray((weight * values[near]).sum(axis=1) / weight.sum(axis=1))

    def _find_ahead(self, place: FloatArray, heading: FloatArray) -> FloatArray | None:
        """Return the place on a surface (2,) less than the length ahead; None: there is none."""
        start, along = self._open[:, 0], self._open[:, 1] - self._open[:, 0]
        part = np.linspace(0.0, 1.0, 9)[:, None, None]
        places = (start + part * along).reshape(-1, 2)
        away = places - place
        distance = np.linalg.norm(away, axis=1)
        ahead = (distance > 1e-9) & (distance < self._length) & (away @ heading > CONE * distance)
        if not ahead.any():
            return None
        return np.asarray(places[int(np.argmin(np.where(ahead, distance, np.inf)))])

    def _find_tip(self, place: FloatArray, heading: FloatArray) -> int | None:
        """Return the tip of another crack less than the length ahead; None: there is none."""
        for number, tip in self._tips.items():
            away = tip - place
            distance = float(np.linalg.norm(away))
            if 1e-9 < distance < self._length and away @ heading > 0.0:
                return number
        return None

    def _find_surface(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the nearest place on the surface, and the normal there into the metal (2,)."""
        start, along = self._open[:, 0], self._open[:, 1] - self._open[:, 0]
        length = np.maximum(np.linalg.norm(along, axis=1), 1e-300)
        part = np.clip(((place - start) * along).sum(axis=1) / length**2, 0.0, 1.0)
        at = start + part[:, None] * along
        side = int(np.argmin(np.linalg.norm(at - place, axis=1)))
        return at[side], np.array([-along[side, 1], along[side, 0]]) / length[side]


def _smooth(path: FloatArray) -> FloatArray:
    """Return a path (n, 2) whose inner points have moved to the middle of their neighbours, its ends where they are."""
    path = path.copy()
    for _ in range(_ROUNDS):
        path[1:-1] = 0.5 * path[1:-1] + 0.25 * (path[:-2] + path[2:])
    return path
