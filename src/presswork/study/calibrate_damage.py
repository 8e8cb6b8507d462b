# SPDX-License-Identifier: Apache-2.0
"""The critical damage of a material, from the stroke at which a test of it cracked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.api import run
from presswork.case import CaseError, read_case
from presswork.case.errors import Problem, suggest
from presswork.model import FloatArray
from presswork.results import Result

PREFIX, MEAN = "damage_", "_mean_max"
STROKE = ".stroke"


@dataclass(frozen=True)
class CriticalDamage:
    """Critical damage from a test."""

    criterion: str
    value: float
    stroke: float
    """Stroke of the first crack [mm]."""
    tool: str
    place: tuple[float, ...]
    """Where it was taken [mm]: at the crack, or where the damage is largest in the step saved nearest to the stroke."""
    folder: Path


def calibrate_damage(
    test: Path,
    stroke: float,
    *,
    tool: str = "",
    criterion: str = "cockcroft_latham",
    at: Sequence[float] = (),
    folder: Path | None = None,
    settings: Sequence[str] = (),
) -> CriticalDamage:
    """Return the damage that a test had when it cracked.

    test: a case file, which is run, or the folder of a run. stroke: of the tool at the first crack [mm]; tool: its
    name, which is needed where several move. at: place of the crack in the formed part (2 | 3) [mm]; without it the
    largest mean over a neighbourhood counts. folder: for the run of a case. Raises CaseError where the test does not
    determine it.
    """
    if not test.is_dir():
        folder = folder or test.with_name(f"{test.stem}_damage")
        run(read_case(test, settings), folder, overwrite=True)
        test = folder
    result = Result(test)
    name = f"{PREFIX}{criterion}"
    column = f"{name}{MEAN}"
    found = [
        key.removeprefix(PREFIX).removesuffix(MEAN)
        for key in result.history
        if key.startswith(PREFIX) and key.endswith(MEAN)
    ]
    if column not in result.history:
        remedy = suggest(criterion, found, "criteria of this run") if found else "give the material a `damage`"
        raise CaseError([Problem("--criterion", "the run has no such damage", remedy, criterion)])
    tool = tool or _find_tool(result)
    strokes = _strokes(result, tool)
    if not 0.0 < stroke <= strokes[-1] * (1 + 1e-9):
        fault = f"the tool {tool} has gone {strokes[-1]:.4g} mm at the end of the run"
        raise CaseError([Problem("--stroke", fault, "give a stroke within the run, or compute more of it", stroke)])
    of_steps = np.interp(result.times, [0.0, *result.history["time"]], [0.0, *strokes])
    if not len(at):
        value = float(np.interp(stroke, [0.0, *strokes], [0.0, *result.history[column]]))
        step = int(np.argmin(np.abs(of_steps - stroke)))
        centres, damage = _centres(result, step), result.field(name, step=step)
        place = tuple(float(x) for x in centres[int(np.nanargmax(damage))])
        return CriticalDamage(criterion, value, stroke, tool, place, test)
    after = min(int(np.searchsorted(of_steps, stroke * (1 - 1e-9))), len(of_steps) - 1)
    cell = int(np.argmin(np.linalg.norm(_centres(result, after)[:, : len(at)] - np.asarray(at), axis=1)))
    fields = [result.field(name, step=step) for step in (max(after - 1, 0), after)]
    if len(fields[0]) != len(fields[1]):
        remedy = "leave --at out, or save more steps (output.steps)"
        raise CaseError([Problem("--at", "the part has a new mesh between the saved steps", remedy)])
    value = float(np.interp(stroke, of_steps[[max(after - 1, 0), after]], [field[cell] for field in fields]))
    return CriticalDamage(criterion, value, stroke, tool, tuple(float(x) for x in at), test)


def _find_tool(result: Result) -> str:
    """Return the only tool that moves."""
    tools = [key.removesuffix(STROKE) for key in result.history if key.endswith(STROKE)]
    moving = [tool for tool in tools if np.any(result.history[f"{tool}{STROKE}"])]
    if len(moving) != 1:
        named = ", ".join(moving) or "none"
        raise CaseError([Problem("--tool", f"tools that move: {named}", "name the one whose stroke is meant")])
    return moving[0]


def _strokes(result: Result, tool: str) -> FloatArray:
    column = f"{tool}{STROKE}"
    if column not in result.history:
        tools = [key.removesuffix(STROKE) for key in result.history if key.endswith(STROKE)]
        raise CaseError([Problem("--tool", "the run has no such tool", suggest(tool, tools, "tools"), tool)])
    return np.asarray(result.history[column], dtype=float)


def _centres(result: Result, step: int) -> FloatArray:
    """Return where the centres of the cells are (n_cells, 3) [mm]."""
    points = result.points(step)
    blocks = result.mesh_at(step).blocks
    return np.concatenate([points[block.connectivity].mean(axis=1) for block in blocks])
