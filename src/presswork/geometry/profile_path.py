# SPDX-License-Identifier: Apache-2.0
"""A profile of lines and arcs by the distance along it: nearest places, places at a distance, corners, radii."""

from __future__ import annotations

import numpy as np

from presswork.geometry.segments import CENTRE, TURN, X0, X1
from presswork.model import FloatArray

CORNER = np.radians(10.0)
"""Turn between two segments from which on their meeting is a corner."""


class ProfilePath:
    """A directed profile (n_segments, 7), as model.Profile has it; closed where it ends at its beginning."""

    def __init__(self, segments: FloatArray) -> None:
        self._segments = segments
        self._is_arc = segments[:, TURN] != 0.0
        start, end = segments[:, X0] - segments[:, CENTRE], segments[:, X1] - segments[:, CENTRE]
        self._first = np.arctan2(start[:, 1], start[:, 0])
        sweep = segments[:, TURN] * (np.arctan2(end[:, 1], end[:, 0]) - self._first) % (2.0 * np.pi)
        self._sweep = np.where(sweep > 0.0, sweep, 2.0 * np.pi)
        chord = np.linalg.norm(segments[:, X1] - segments[:, X0], axis=1)
        self.radius = np.where(self._is_arc, np.linalg.norm(start, axis=1), np.inf)
        """Radius of each segment [mm]; infinite for a line."""
        length = np.where(self._is_arc, np.where(self._is_arc, self.radius, 0.0) * self._sweep, chord)
        self.begin = np.concatenate([[0.0], np.cumsum(length)])
        """Way at which each segment begins, and that of the end (n_segments + 1,) [mm]."""
        self.length = float(self.begin[-1])
        self.is_closed = bool(np.allclose(segments[0, X0], segments[-1, X1], rtol=0.0, atol=1e-9))

    def find(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the distance along the profile to the place nearest to points (n, 2), and their gap (n,) [mm]."""
        best, place = np.full(len(points), np.inf), np.zeros(len(points))
        for i, segment in enumerate(self._segments):
            part = self._nearest_part(i, segment, points)
            distance = np.linalg.norm(points - self._on_segment(i, part), axis=1)
            nearer = distance < best
            best = np.where(nearer, distance, best)
            place = np.where(nearer, self.begin[i] + part * (self.begin[i + 1] - self.begin[i]), place)
        return place, best

    def _nearest_part(self, i: int, segment: FloatArray, points: FloatArray) -> FloatArray:
        """Return which part of a segment lies before its nearest place (n,), 0 to 1."""
        if not self._is_arc[i]:
            along = segment[X1] - segment[X0]
            return np.asarray(np.clip((points - segment[X0]) @ along / (along @ along), 0.0, 1.0))
        away = points - segment[CENTRE]
        angle = segment[TURN] * (np.arctan2(away[:, 1], away[:, 0]) - self._first[i]) % (2.0 * np.pi)
        beyond = angle - self._sweep[i]
        nearer_start = 2.0 * np.pi - angle < beyond
        return np.asarray(np.where(beyond <= 0.0, angle / self._sweep[i], np.where(nearer_start, 0.0, 1.0)))

    def _on_segment(self, i: int, part: FloatArray) -> FloatArray:
        segment = self._segments[i]
        if not self._is_arc[i]:
            return np.asarray(segment[X0] + part[:, None] * (segment[X1] - segment[X0]))
        angle = self._first[i] + segment[TURN] * self._sweep[i] * part
        return np.asarray(segment[CENTRE] + self.radius[i] * np.column_stack([np.cos(angle), np.sin(angle)]))

    def at(self, place: FloatArray) -> FloatArray:
        """Return the places at a distance along the profile (n, 2) [mm]."""
        place = np.mod(place, self.length) if self.is_closed else place
        which = np.clip(np.searchsorted(self.begin, place, side="right") - 1, 0, len(self._segments) - 1)
        places = np.empty((len(place), 2))
        for i in np.unique(which):
            own = which == i
            part = (place[own] - self.begin[i]) / (self.begin[i + 1] - self.begin[i])
            places[own] = self._on_segment(int(i), part)
        return places

    def corners(self) -> tuple[FloatArray, FloatArray]:
        """Return the distance along the profile to corners (n,) [mm] and their turns, left positive (n,) [rad]."""
        out, into = self._directions(0), self._directions(1)
        before, after = (into, np.roll(out, -1, axis=0)) if self.is_closed else (into[:-1], out[1:])
        turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1))
        sharp = np.abs(turn) > CORNER
        return self.begin[1 : len(turn) + 1][sharp], turn[sharp]

    def _directions(self, end: int) -> FloatArray:
        """Return the direction of each segment at its beginning (0) or end (1) (n_segments, 2)."""
        away = self._segments[:, (X0, X1)[end]] - self._segments[:, CENTRE]
        turned = self._segments[:, TURN, None] * np.column_stack([-away[:, 1], away[:, 0]])
        along = np.where(self._is_arc[:, None], turned, self._segments[:, X1] - self._segments[:, X0])
        return np.asarray(along / np.linalg.norm(along, axis=1, keepdims=True))
