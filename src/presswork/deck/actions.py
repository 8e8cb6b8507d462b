# SPDX-License-Identifier: Apache-2.0
"""Stages of a case: strokes and forces of tools between the times at which they start, stop or turn back."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from presswork.deck.blank_and_tools import BlankAndTools
from presswork.deck.contents import Motion, Push
from presswork.deck.stages import find_breaks
from presswork.model import BoolArray, FloatArray

_STEADY = 0.01
"""Part by which a force may change in a stage and yet be one number."""
_ROWS = 9
"""Number of rows for a force that changes with the stroke."""
_STILL = 1e-6
"""Length below which a stroke counts as none [mm]."""


def describe_stages(reader: BlankAndTools, names: dict[int, str], kinds: dict[int, str]) -> list[dict[str, Any]]:
    """Return the stages. A tool that is moved follows its motion while that lasts, and is pushed before and after."""
    notes = reader.notes
    pushes: dict[int, list[Push]] = {}
    for push in reader.deck.pushes:
        if push.part in names:
            pushes.setdefault(push.part, []).append(push)
    motions = {part: [m for m in reader.deck.motions if m.part == part] for part in names}
    breaks = _find_breaks(reader, pushes, motions)
    is_pushed = dict.fromkeys(pushes, False)
    stages = []
    for number, (begin, end) in enumerate(itertools.pairwise(breaks), start=1):
        inside = (reader.times >= begin - 1e-12) & (reader.times <= end + 1e-12)
        free = {part for part in pushes if not _is_moved(motions[part], begin, end, reader.units.time)}
        tools: dict[str, Any] = {}
        for part, displacement in reader.displacements.items():
            gone = float(displacement[inside][-1] - displacement[inside][0])
            if part not in free and abs(gone) > _STILL:
                tools[names[part]] = {"stroke": round(_sense(kinds[part]) * gone, 6)}
        for part in sorted(free):
            force = _sense(kinds[part]) * np.sum([reader.force(push, reader.times[inside]) for push in pushes[part]], 0)
            if force.min() < -1e-6 * max(1.0, np.abs(force).max()):
                first = pushes[part][0]
                text = f"pulls the {kinds[part]} {names[part]} off the sheet, by up to {-force.min():g} N"
                notes.refuse(first.place, first.keyword, text, "a tool pushes: turn the force round")
            if is_pushed[part] or np.abs(force).max() > 0.0:  # one that is not yet pushed stands still
                is_pushed[part] = True
                tools[names[part]] = {"force": _describe_force(force, _stroke(reader, free, inside))}
        stages.append({"name": f"stage_{number}", "tools": tools, "duration": float(end - begin)})
    for part, own in motions.items():
        for motion in own:
            text = f"{names[part]}: strokes of the stages; within each it starts and stops smoothly"
            if part not in pushes and _is_freed(motion, own, float(reader.times[-1]) / reader.units.time):
                text += f"; after {motion.end:g}, when its motion ends and the deck frees it, it stands still"
            notes.change(motion.place, motion.keyword, text)
    _note_pushes(reader, names, pushes, is_pushed)
    return stages


def _sense(kind: str) -> float:
    """Return the sign of z along which a tool works."""
    return 1.0 if kind == "die" else -1.0


def _is_moved(motions: list[Motion], begin: float, end: float, unit: float) -> bool:
    """Return whether a motion lasts through a stage; times [s], unit: unit of time in the deck."""
    tiny = 1e-6 * (end - begin)
    return any(unit * m.begin <= begin + tiny and unit * m.end >= end - tiny for m in motions)


def _is_freed(motion: Motion, motions: list[Motion], last: float) -> bool:
    """Return whether a motion ends before the run does, and no other goes on; last: the end, in the deck's time."""
    tiny = 1e-6 * last
    return motion.end < last - tiny and not any(
        other.begin <= motion.end + tiny and other.end > motion.end + tiny for other in motions if other is not motion
    )


def _find_breaks(reader: BlankAndTools, pushes: dict[int, list[Push]], motions: dict[int, list[Motion]]) -> list[float]:
    """Return where stages begin and end [s], those of motions of tools that are pushed, too, among them."""
    own = [*reader.deck.breaks]
    for part in pushes:
        own += [time for motion in motions[part] for time in (motion.begin, motion.end)]
    last = float(reader.times[-1])
    inside = [reader.units.time * each for each in own if 0.0 < reader.units.time * each < last]
    return find_breaks(reader.times, list(reader.displacements.values()), inside)


def _stroke(reader: BlankAndTools, free: set[int], inside: BoolArray) -> FloatArray:
    """Return how far the tool with the longest travel has gone in a stage (n,) [mm]."""
    strokes = (w for p, w in reader.displacements.items() if p not in free)
    longest = max(strokes, key=np.ptp, default=np.zeros(len(reader.times)))
    return np.asarray(np.abs(longest[inside] - longest[inside][0]))


def _describe_force(force: FloatArray, stroke: FloatArray) -> float | list[list[float]]:
    """Return one force, or rows of the punch's stroke in the stage and the force."""
    last_tenth = force[len(force) // 10 :]
    last = float(last_tenth[-1])
    if np.abs(last_tenth - last).max() <= _STEADY * max(abs(last), 1e-9) or np.ptp(stroke) <= 0.0:
        return round(last, 6)
    order = np.unique(stroke, return_index=True)[1]
    at = np.linspace(0.0, stroke.max(), _ROWS)
    return [
        [round(float(s), 6), round(float(f), 6)]
        for s, f in zip(at, np.interp(at, stroke[order], force[order]), strict=True)
    ]


def _note_pushes(
    reader: BlankAndTools, names: dict[int, str], pushes: dict[int, list[Push]], is_pushed: dict[int, bool]
) -> None:
    """Note what became of forces."""
    notes, whole = reader.notes, 2 ** len(reader.symmetry)
    of_whole = f", of the whole part ({whole} times the deck's)" if reader.symmetry else ""
    for part, own in pushes.items():
        for push in own:
            if is_pushed[part]:
                more = f", the sum of {len(own)}" if len(own) > 1 else ""
                notes.keep(push.place, push.keyword, f"{names[part]}: force{more}{of_whole}")
            else:
                text = f"{names[part]}: a motion moves it all the time, or the force is zero"
                notes.drop(push.place, push.keyword, text)
