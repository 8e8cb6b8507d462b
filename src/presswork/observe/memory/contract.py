# SPDX-License-Identifier: Apache-2.0
"""The contract of a memory of a recording: its methods, and what it sees."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Protocol

from presswork.model import FloatArray, Mesh
from presswork.observe.contract import History, Observed

STROKE = ".stroke"


class Saved(Protocol):
    """A saved step."""

    @property
    def time(self) -> float:
        """[s]"""

    @property
    def point_data(self) -> Mapping[str, FloatArray]:
        """Fields of nodes."""

    @property
    def cell_data(self) -> Mapping[str, FloatArray]:
        """Fields of cells."""


class Memory:
    """Remembers something of a whole recording. A subclass overrides what it has."""

    name: ClassVar[str]
    """Name in a checkpoint."""

    def look(self, run: Observed | None, row: Mapping[str, Any]) -> str | None:
        """Look at a converged state; return why the recording must stop, if it must.

        run: None where nothing is formed, as in a released part. row: of the history, which holds the time.
        """
        return None

    def reached(self) -> str:
        """Return why the recording is complete before its end; empty where it is not."""
        return ""

    def note_step(self, number: int, mesh: Mesh, step: Saved) -> None:
        """Look at a saved step, counted from 0."""

    def news(self) -> list[str]:
        """Return what the log should warn of since it was last asked."""
        return []

    def warnings(self) -> list[str]:
        """Return what a user should know at the end."""
        return []

    def summary(self, history: History) -> dict[str, Any]:
        """Return its entries of summary.json."""
        return {}

    def to_data(self) -> Any:
        """Return what it remembers, as JSON has it, for a checkpoint."""
        return None

    def load_data(self, data: Any) -> None:
        """Take up what to_data gave."""


class Memories:
    """The memories of a recording, in the order of their warnings."""

    def __init__(self, memories: Sequence[Memory]) -> None:
        self._memories = memories

    def look(self, run: Observed | None, row: Mapping[str, Any]) -> str | None:
        """Let all look at a converged state; return why the recording must stop, if it must."""
        reasons = [memory.look(run, row) for memory in self._memories]
        return next((reason for reason in reasons if reason is not None), None)

    def reached(self) -> str:
        """Return why the recording is complete before its end; empty where it is not."""
        return next(filter(None, (memory.reached() for memory in self._memories)), "")

    def note_step(self, number: int, mesh: Mesh, step: Saved) -> None:
        """Let all look at a saved step, counted from 0."""
        for memory in self._memories:
            memory.note_step(number, mesh, step)

    def news(self) -> list[str]:
        """Return what the log should warn of since it was last asked."""
        return [line for memory in self._memories for line in memory.news()]

    def warnings(self) -> list[str]:
        """Return the warnings of all."""
        return [text for memory in self._memories for text in memory.warnings()]

    def summary(self, history: History) -> dict[str, Any]:
        """Return the entries of all."""
        found: dict[str, Any] = {}
        for memory in self._memories:
            found |= memory.summary(history)
        return found

    def to_text(self) -> str:
        """Return all that is remembered, for a checkpoint."""
        return json.dumps({memory.name: memory.to_data() for memory in self._memories})

    def load_text(self, text: str) -> None:
        """Take up what to_text gave."""
        found = json.loads(text)
        for memory in self._memories:
            memory.load_data(found[memory.name])


def describe_instant(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return time [s], stage and strokes [mm] of the tools that have moved, of a row of the history.

    >>> describe_instant({"time": 0.5, "stage": "draw", "punch.stroke": 12.0, "punch.force": 8.0, "die.stroke": 0.0})
    {'time_s': 0.5, 'stage': 'draw', 'strokes_mm': {'punch': 12.0}}
    """
    strokes = {name.removesuffix(STROKE): float(row[name]) for name in row if name.endswith(STROKE)}
    return {
        "time_s": float(row.get("time", 0.0)),
        "stage": str(row.get("stage", "")),
        "strokes_mm": {tool: stroke for tool, stroke in strokes.items() if stroke},
    }


def begin_sentence(instant: Mapping[str, Any]) -> str:
    """Return the beginning of a sentence on what describe_instant describes.

    >>> begin_sentence({"time_s": 0.5, "stage": "draw", "strokes_mm": {"punch": 12.0}})
    "stage 'draw', punch at 12 mm: "
    """
    stage = f"stage {instant['stage']!r}"
    strokes = (f"{tool} at {stroke:.4g} mm" for tool, stroke in instant["strokes_mm"].items())
    return f"{', '.join([stage, *strokes])}: "
