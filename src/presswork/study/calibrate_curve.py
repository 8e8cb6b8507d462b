# SPDX-License-Identifier: Apache-2.0
"""Numbers of a case from a measured curve, by the derivatives of its runs (Gauss and Newton, damped)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.api import run
from presswork.case import read_case
from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.gradients import find_number
from presswork.case.table_file import read_table_lines
from presswork.model import FloatArray
from presswork.results import Result, write_summary
from presswork.results.folder import find_members
from presswork.results.history import name_derivative
from presswork.study.vary import format_override

MOST_RUNS = 8
FARTHEST = 2.0
"""Largest factor by which a number grows or falls from one run to the next."""
ENOUGH = 1e-4
"""Change of the numbers, over themselves, below which the fit is found."""
UNDETERMINED = 1e-6
"""Least singular value of the derivatives over the largest, below which the curve does not determine the numbers one by
one."""


@dataclass(frozen=True)
class CurveFit:
    """What fits a measured curve best."""

    values: Mapping[str, float]
    """Values by the keys of the case, in mm, s, N, MPa."""
    interval: Mapping[str, float]
    """Half of the 95 % interval of each, from the scatter of the points."""
    misfit: float
    """Root of the mean square of measured less computed, over the largest measured value."""
    runs: int
    folder: Path
    warnings: tuple[str, ...] = ()


def calibrate_curve(
    measured: Path | str,
    case_file: Path | str,
    folder: Path | str,
    *,
    keys: Sequence[str],
    settings: Sequence[str] = (),
    most_runs: int = MOST_RUNS,
    overwrite: bool = False,
    on_run: Callable[[int, Mapping[str, float], float], None] | None = None,
) -> CurveFit:
    """Fit numbers of a case to a measured curve, and write calibration.json and a folder for each run.

    measured: CSV of two columns, named as columns of history.csv, e.g. punch.stroke and punch.force. The case's own
    numbers are the first guess. on_run: called with the number, values and misfit of every run. Raises CaseError for
    what the curve or the case does not have, and where the curve does not determine the numbers one by one.
    """
    case_file, folder = Path(case_file), Path(folder)
    (along, of), points = _read_curve(Path(measured))
    case = read_case(case_file, settings)
    best = np.array([find_number(case, key) for key in keys])
    if len(points) < len(keys):
        text = f"{len(points)} points cannot determine {len(keys)} numbers"
        raise CaseError([Problem("", text, "give more points, or fewer keys")], measured)
    scale, numbers, cost, damping = float(np.abs(points[:, 1]).max()), best, np.inf, 1e-6
    folder.mkdir(exist_ok=True)
    find_members(folder, "run_*")
    count = 0
    while count < most_runs:
        count += 1
        values = [format_override(key, float(value)) for key, value in zip(keys, numbers, strict=True)]
        asked = format_override("gradients", {"by": list(keys), "of": [along, of]})
        outcome = run(read_case(case_file, [*settings, *values, asked]), folder / f"run_{count}", overwrite=overwrite)
        if outcome.status != "completed":
            text = f"run {count} ({', '.join(values)}) ended early: {outcome.reason}"
            raise CaseError([Problem("", text, "begin with other numbers, or fit fewer")], case_file)
        computed, slopes = _compare(outcome.result, along, of, keys, points[:, 0])
        residual = (points[:, 1] - computed) / scale
        now = float(residual @ residual)
        if on_run:
            on_run(count, dict(zip(keys, numbers.tolist(), strict=True)), float(np.sqrt(now / len(points))))
        if now < cost:
            best, cost, damping = numbers, now, 0.1 * damping
            matrix, gone = slopes * best / scale, residual
        else:
            damping = max(1e3 * damping, 1e-3)
        _check_determined(matrix, keys, measured)
        normal = matrix.T @ matrix
        step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), matrix.T @ gone)
        numbers = best * np.clip(1.0 + step, 1.0 / FARTHEST, FARTHEST)
        if float(np.abs(step).max()) < ENOUGH:
            break
    spread = np.sqrt(np.diag(np.linalg.inv(normal)) * cost / max(len(points) - len(keys), 1))
    late = () if float(np.abs(step).max()) < ENOUGH else (f"the numbers still change after {count} runs",)
    found, interval = (dict(zip(keys, x.tolist(), strict=True)) for x in (best, 1.96 * spread * np.abs(best)))
    fit = CurveFit(found, interval, float(np.sqrt(cost / len(points))), count, folder, late)
    _write_fit(fit)
    return fit


def _write_fit(fit: CurveFit) -> None:
    """Write calibration.json."""
    found = {"values": dict(fit.values), "interval_95_percent": dict(fit.interval), "misfit": fit.misfit}
    write_summary(fit.folder / "calibration.json", {**found, "runs": fit.runs, "warnings": fit.warnings})


def _check_determined(matrix: FloatArray, keys: Sequence[str], measured: Path | str) -> None:
    """Raise CaseError where the curve does not determine the numbers one by one."""
    singular = np.linalg.svd(matrix, compute_uv=False)
    if singular[-1] < UNDETERMINED * singular[0]:
        text = f"the curve does not determine {', '.join(keys)} one by one"
        raise CaseError([Problem("", text, "give fewer keys, or a curve that all of them shape")], measured)


def _read_curve(path: Path) -> tuple[tuple[str, str], FloatArray]:
    """Return the names of both columns and the points (n, 2)."""
    (_, head), *lines = read_table_lines(path, least=2)
    names = [name.strip() for name in head]
    if len(names) != 2:
        fault = f"expected two columns, not {len(names)}"
        raise CaseError([Problem("", fault, "name them as history.csv does, e.g. punch.stroke,punch.force")], path)
    points, problems = [], []
    for number, cells in lines:
        try:
            x, y = (float(cell) for cell in cells)
            points.append((x, y))
        except ValueError:
            problems.append(Problem(f"line {number}", "expected two numbers", "decimals with a point", cells))
    if problems:
        raise CaseError(problems, path)
    return (names[0], names[1]), np.array(sorted(points))


def _compare(
    result: Result, along: str, of: str, keys: Sequence[str], places: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the computed curve at places (n,), and its derivatives there by the numbers (n, n_keys)."""
    history = result.history
    for name in (along, of):
        if name not in history:
            own = [column for column in history if not column.startswith("d(")]
            raise CaseError([Problem("", f"the history has no column `{name}`", suggest(name, own, "columns"))])
    x, y = np.asarray(history[along]), np.asarray(history[of])
    if places[0] < 0.0 or places[-1] > x[-1] * (1.0 + 1e-9):
        text = f"points from {places[0]:g} to {places[-1]:g} lie beyond the {x[-1]:g} that the case computes"
        raise CaseError([Problem(along, text, "make the case go as far as the curve")])
    rise = np.gradient(y, x)
    found = []
    for key in keys:
        moved, changed = (np.asarray(history[name_derivative(name, key)]) for name in (along, of))
        if np.isnan(changed).any():
            text = f"the derivative by {key} was not found during the run"
            remedy = "begin with other numbers, or set solver.force_tolerance lower"
            raise CaseError([Problem("", text, remedy)])
        found.append(np.interp(places, x, changed - rise * moved))
    return np.interp(places, x, y), np.column_stack(found)
