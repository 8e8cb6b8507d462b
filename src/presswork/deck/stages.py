# SPDX-License-Identifier: Apache-2.0
"""Stages out of curves: where tools begin and end to move, and how far they go in between."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from presswork.model import FloatArray

_STILL = 1e-4
"""Length that counts as standing still, over the longest travel of all tools."""
_SHORTEST = 2e-3
"""Shortest stage over the whole time: shorter ones are joined to their neighbours."""
_REST = 0.05
"""Shortest rest of all tools over the whole time: shorter ones are joined to their neighbours."""
_SAMPLES = 4001


def find_displacement(
    kind: str, curve: FloatArray, scale: float, begin: float, end: float, times: FloatArray
) -> FloatArray:
    """Return the displacement at times (n,) by a curve (m, 2) of velocity, acceleration or displacement."""
    values = scale * np.interp(times - begin, curve[:, 0], curve[:, 1])
    is_on = (times >= begin) & (times <= end)
    if kind == "displacement":
        held = np.where(is_on, values, 0.0)
        held[times > end] = held[is_on][-1] if is_on.any() else 0.0
        return np.asarray(held - held[0])
    speed = np.where(is_on, values, 0.0)
    if kind == "acceleration":
        speed = _integrate(times, speed)
    return _integrate(times, speed)


def sample_times(end: float, curves: Sequence[FloatArray]) -> FloatArray:
    """Return times from 0 to the end, those of the curves among them."""
    own = np.concatenate([np.linspace(0.0, end, _SAMPLES), *(curve[:, 0] for curve in curves)])
    return np.unique(own[(own >= 0.0) & (own <= end)])


def find_breaks(times: FloatArray, displacements: Sequence[FloatArray], own: Sequence[float] = ()) -> list[float]:
    """Return where stages begin and end: where a tool starts, stops, or turns back, and at the deck's own breaks."""
    whole = float(times[-1])
    longest = max((float(np.ptp(displacement)) for displacement in displacements), default=0.0)
    breaks = {0.0, whole, *own}
    for displacement in displacements:
        speed = np.diff(displacement) / np.diff(times)
        limit = _STILL * longest / whole
        sense = np.where(np.abs(speed) <= limit, 0, np.sign(speed))
        changed = np.flatnonzero(np.diff(sense)) + 1
        breaks |= {float(times[i]) for i in changed}
    kept = [0.0]
    for at in sorted(breaks)[1:]:
        if at - kept[-1] >= _SHORTEST * whole:
            kept.append(at)
    if len(kept) == 1:
        kept.append(whole)
    kept[-1] = whole
    return _join_rests(kept, times, displacements, _STILL * longest)


def _join_rests(
    breaks: list[float], times: FloatArray, displacements: Sequence[FloatArray], still: float
) -> list[float]:
    """Return breaks without those of short rests: one at the beginning goes on, others end what was before."""
    joined = list(breaks)
    for begin, end in itertools.pairwise(breaks):
        gone = max(
            (
                abs(np.interp(end, times, displacement) - np.interp(begin, times, displacement))
                for displacement in displacements
            ),
            default=0.0,
        )
        if gone <= still and end - begin < _REST * breaks[-1] and len(joined) > 2:
            joined.remove(end if begin == 0.0 else begin)
    return joined


def _integrate(times: FloatArray, values: FloatArray) -> FloatArray:
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(times)
    return np.concatenate([[0.0], np.cumsum(steps)])
