# SPDX-License-Identifier: Apache-2.0
"""The contract by which recorder.py records, stops and resumes a procedure, implicit or explicit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from presswork.formability import Info
from presswork.model import FloatArray, IntArray, Mesh
from presswork.observe.contract import Observed, Row
from presswork.timing import Timing

Meta = dict[str, float | int | str]


class Report(Protocol):
    """One step forward, after which there is something to record."""

    @property
    def number(self) -> int:
        """Counted from 1."""

    @property
    def is_save_point(self) -> bool:
        """Whether fields are saved here."""


@dataclass(frozen=True)
class Snapshot:
    """What is saved of an instant, in the form of results.append_step."""

    time: float
    """[s]"""
    point_data: Mapping[str, FloatArray]
    cell_data: Mapping[str, FloatArray]
    info: Info
    tools: Mapping[str, FloatArray] = field(default_factory=dict)
    tool_centre: Mapping[str, FloatArray] = field(default_factory=dict)
    tool_displacement: Mapping[str, FloatArray] = field(default_factory=dict)
    tool_angle: Mapping[str, float] = field(default_factory=dict)
    tool_rotation: Mapping[str, FloatArray] = field(default_factory=dict)
    surfaces: Mapping[str, tuple[FloatArray, IntArray]] = field(default_factory=dict)
    dies: Mapping[str, tuple[FloatArray, IntArray, FloatArray]] = field(default_factory=dict)
    """Points (n, 2) [mm] as they are in the tool's profile, cells (m, k) and temperatures (n,) [degrees C] of tools."""


class Run(Protocol):
    """A procedure at work on one model."""

    timing: Timing

    @property
    def title(self) -> str:
        """What the case shows."""

    @property
    def mesh(self) -> Mesh:
        """The undeformed mesh."""

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""

    @property
    def checkpoint_every(self) -> int:
        """Reports between checkpoints."""

    @property
    def number(self) -> int:
        """Reports so far."""

    def advance(self) -> Iterator[Report]:
        """Go on from the present state; a state can be recorded at each yield. Raises GaveUpError."""

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed; 0 at its end."""

    def files(self) -> dict[str, str]:
        """Return the names and texts of further files to be written now."""

    def begin_log(self) -> str:
        """Return the line that begins the log."""

    def log_lines(self, report: Any) -> list[str]:
        """Return the log's lines on a report."""

    def progress_text(self, report: Any) -> str:
        """Return a line for who waits."""

    def row(self, report: Any) -> Row:
        """Return the row of the history."""

    def at_work(self) -> Observed | None:
        """Return the run that forms at present, as observers see it; None where nothing is formed."""

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state."""

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array that the next report depends on."""

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Go back to the state of these arrays. Raises ValueError if they belong to another model."""

    def meta(self) -> Meta:
        """Return the numbers that a checkpoint keeps beside the arrays."""

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up what meta gave."""

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the contents of summary.json beyond status and wall time; "warnings" lists what a user should know."""
