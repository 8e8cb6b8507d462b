# SPDX-License-Identifier: Apache-2.0
"""The pieces of a drawing, joined end to end into one chain."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from presswork.geometry.biarc import reverse_segment
from presswork.model import FloatArray, IndexArray

logger = logging.getLogger(__name__)


class ProfileFileError(Exception):
    """A file that holds no profile: what is wrong, and the remedy."""

    def __init__(self, fault: str, remedy: str) -> None:
        self.fault = fault
        self.remedy = remedy
        super().__init__(f"{fault}; {remedy}")

    def __reduce__(self) -> tuple[type[ProfileFileError], tuple[str, str]]:
        """Let an error pass from process to process."""
        return ProfileFileError, (self.fault, self.remedy)


@dataclass(frozen=True)
class Piece:
    """One line, arc or curve of a drawing."""

    kind: str
    """Its name in the drawing, e.g. ARC."""
    segments: tuple[FloatArray, ...]
    """Consecutive lines and arcs, each (7,), in the form of model.Tool [mm]."""

    @property
    def start(self) -> FloatArray:
        """Start point (2,) [mm]."""
        return self.segments[0][0:2]

    @property
    def end(self) -> FloatArray:
        """End point (2,) [mm]."""
        return self.segments[-1][2:4]

    def __str__(self) -> str:
        return f"the {self.kind} from {_place(self.start)} to {_place(self.end)}"

    def reversed(self) -> Piece:
        """Return it in the opposite direction."""
        return Piece(self.kind, tuple(reverse_segment(segment) for segment in self.segments[::-1]))


@dataclass(frozen=True)
class Chain:
    """Pieces joined end to end."""

    segments: FloatArray
    """Shape (n_segments, 7), in the form of model.Tool [mm]."""
    pieces: tuple[str, ...]
    """Name of the piece that each segment belongs to."""


def join_pieces(pieces: Sequence[Piece], tolerance: float) -> Chain:
    """Return the one chain that pieces form whose ends lie within `tolerance` [mm] of each other.

    Lines are drawn out to the arcs that they meet. Raises ProfileFileError when there are branches or several chains.
    """
    kept = _drop_doubles([piece for piece in pieces if _is_long(piece, tolerance)], tolerance)
    if not kept:
        raise ProfileFileError(
            f"all that is drawn is shorter than the tolerance of {tolerance:.3g} mm", "check unit and tolerance"
        )
    ends = _find_meeting_ends(kept, tolerance)
    order = _walk(kept, ends, tolerance)
    runs = [kept[index].reversed() if backwards else kept[index] for index, backwards in order]
    rows: list[FloatArray] = []
    names: list[str] = []
    for run in runs:
        rows += [segment.copy() for segment in run.segments]
        names += [str(run)] * len(run.segments)
    for before, after in pairwise(rows):
        _close_gap(before, after)
    if len(rows) > 1 and np.linalg.norm(rows[-1][2:4] - rows[0][0:2]) <= tolerance:
        _close_gap(rows[-1], rows[0])
    return Chain(np.array(rows), tuple(names))


def _place(point: FloatArray) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"


def _is_long(piece: Piece, tolerance: float) -> bool:
    """Return whether a piece is more than a dot: the ends apart, or a closed curve."""
    if len(piece.segments) > 1:
        return True
    reach = [np.linalg.norm(point - piece.start) for point in (piece.end, _middle(piece))]
    return float(max(reach)) > tolerance


def _middle(piece: Piece) -> FloatArray:
    """Return a point in the middle of a piece, the same for both directions."""
    n_segments = len(piece.segments)
    if n_segments % 2 == 0:
        return piece.segments[n_segments // 2][0:2]
    segment = piece.segments[n_segments // 2]
    start, end, centre = segment[0:2], segment[2:4], segment[4:6]
    if segment[6] == 0.0:
        return np.asarray(0.5 * (start + end))
    first, last = start - centre, end - centre
    turned = segment[6] * np.arctan2(first[0] * last[1] - first[1] * last[0], first @ last)
    half = 0.5 * segment[6] * (turned if turned > 0.0 else turned + 2.0 * np.pi)
    cosine, sine = np.cos(half), np.sin(half)
    return np.asarray(centre + np.array([[cosine, -sine], [sine, cosine]]) @ first)


def _drop_doubles(pieces: Sequence[Piece], tolerance: float) -> list[Piece]:
    """Leave out pieces that lie on an earlier one from end to end."""
    kept: list[Piece] = []
    for piece in pieces:
        for other in kept:
            ends = (np.linalg.norm(a - b) for a, b in ((piece.start, other.start), (piece.end, other.end)))
            crossed = (np.linalg.norm(a - b) for a, b in ((piece.start, other.end), (piece.end, other.start)))
            same_ends = max(ends) <= tolerance or max(crossed) <= tolerance
            if same_ends and np.linalg.norm(_middle(piece) - _middle(other)) <= tolerance:
                logger.warning("%s is drawn twice; one is left out", piece)
                break
        else:
            kept.append(piece)
    return kept


def _find_meeting_ends(pieces: Sequence[Piece], tolerance: float) -> IndexArray:
    """Number the places where ends meet: the place of each piece's start and end, shape (n_pieces, 2)."""
    points = np.array([point for piece in pieces for point in (piece.start, piece.end)])
    place = np.arange(len(points))
    for first, second in sorted(scipy.spatial.cKDTree(points).query_pairs(tolerance)):
        place[place == place[second]] = place[first]
    return np.unique(place, return_inverse=True)[1].reshape(-1, 2)


def _walk(pieces: Sequence[Piece], ends: IndexArray, tolerance: float) -> list[tuple[int, bool]]:
    """Return the pieces in their order along the chain, each with whether it is walked backwards."""
    count = np.bincount(ends.ravel())
    if (count > 2).any():
        index, side = np.argwhere(ends == np.argmax(count > 2))[0]
        point = pieces[index].end if side else pieces[index].start
        raise ProfileFileError(
            f"{int(count.max())} pieces meet at {_place(point)}, where a profile has two",
            "leave one chain in the drawing, or name its layer",
        )
    loose = np.argwhere(count[ends] == 1)
    index, side = (int(loose[0, 0]), int(loose[0, 1])) if len(loose) else (0, 0)
    order = [(index, side == 1)]
    left = set(range(len(pieces))) - {index}
    place = ends[index, 1 - side]
    while len(found := [i for i in left if place in ends[i]]) > 0:
        index = found[0]
        backwards = bool(ends[index, 0] != place)
        order.append((index, backwards))
        left.remove(index)
        place = ends[index, 0 if backwards else 1]
    if left:
        raise _name_gap(pieces, ends, {index for index, _ in order}, tolerance)
    return order


def _name_gap(pieces: Sequence[Piece], ends: IndexArray, chain: set[int], tolerance: float) -> ProfileFileError:
    """Describe the gap in a drawing that falls apart: the loose ends of one chain that are nearest to another's."""
    places: tuple[list[FloatArray], list[FloatArray]] = ([], [])
    for i, side in np.argwhere(np.bincount(ends.ravel())[ends] == 1).tolist():
        places[i not in chain].append(pieces[i].end if side else pieces[i].start)
    fault = f"the drawing is not one chain: {len(chain)} of {len(pieces)} pieces are connected"
    remedy = "leave one chain in the drawing, or name its layer"
    if not places[0] or not places[1]:
        return ProfileFileError(fault, remedy)
    distance, nearest = scipy.spatial.cKDTree(places[1]).query(places[0])
    first = int(np.argmin(distance))
    a, b = places[0][first], places[1][int(nearest[first])]
    return ProfileFileError(
        f"{fault}; the gap between {_place(a)} and {_place(b)} is {float(distance[first]):.3g} mm wide",
        f"close it, or set tolerance (now {tolerance:.3g} mm), or {remedy}",
    )


def _close_gap(before: FloatArray, after: FloatArray) -> None:
    """Make one segment end where the next one starts, in place; if one is an arc, the line is changed."""
    if (before[2:4] == after[0:2]).all():
        return
    if before[6] == 0.0:
        before[2:4] = after[0:2]
        return
    after[0:2] = before[2:4]
    if after[6] != 0.0:  # the centre moves onto the new chord's bisector
        chord = after[2:4] - after[0:2]
        square = float(chord @ chord)
        after[4:6] -= chord * float((after[4:6] - 0.5 * (after[0:2] + after[2:4])) @ chord) / square
