# SPDX-License-Identifier: Apache-2.0
"""Friction from a measured ring test: the case run at a handful of friction values, and the value that fits best.

The bore is interpolated over height reduction and then over friction, both monotonically (PCHIP). The fit is least
squares in the bore ratio; its interval is that of one parameter with normal scatter: Student's t times the scatter over
the slope of the bore. It knows only the scatter of the points, not what the case gets wrong in all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import least_squares
from scipy.stats import t as student_t

from presswork.case import Case, CaseError, build_model
from presswork.case.errors import Problem
from presswork.case.reader import apply_overrides, read_toml
from presswork.model import FloatArray
from presswork.results import Result, write_summary
from presswork.study.cluster.connection import Cluster
from presswork.study.measured import MeasuredRings, read_measured
from presswork.study.ring import measure_ring
from presswork.study.sweep import SweepProgress, SweepResult, run_members
from presswork.study.vary import format_override, make_members

FrictionLaw = Literal["shear", "coulomb"]
BorePlace = Literal["mean", "mid"]
SYMBOLS: dict[FrictionLaw, str] = {"shear": "m", "coulomb": "mu"}
VALUES: dict[FrictionLaw, tuple[float, ...]] = {
    "shear": (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0),
    "coulomb": (0.0, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.55),
}
FEW = 4
"""Number of points below which their own scatter is unknown."""


@dataclass(frozen=True)
class CalibrationCurves:
    """Bore ratio against height reduction at some friction values, all from no reduction to the same one."""

    friction: FloatArray
    """Shape (n_curves,), increasing."""
    height_reduction: FloatArray
    """Shape (n_steps,), increasing from 0."""
    bore_ratio: FloatArray
    """Shape (n_curves, n_steps)."""

    def interpolate(self, reductions: FloatArray) -> PchipInterpolator:
        """Return bore(friction), shape (n,) for one friction value, at these height reductions (n,)."""
        at = PchipInterpolator(self.height_reduction, self.bore_ratio, axis=1)(reductions)
        return PchipInterpolator(self.friction, at, axis=0)


@dataclass(frozen=True)
class FrictionFit:
    """The friction that fits the measured points best."""

    friction: float
    interval: tuple[float, float]
    """95 % confidence, within the range of the curves; NaN for a single point."""
    scatter: float
    """Standard deviation of the bore ratio about the curve; NaN for a single point."""
    residuals: FloatArray
    """Measured less fitted bore ratio, shape (n_points,)."""
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Calibration:
    """A fit with what it rests on."""

    law: FrictionLaw
    fit: FrictionFit
    curves: CalibrationCurves
    measured: MeasuredRings
    folder: Path


def fit_friction(curves: CalibrationCurves, measured: MeasuredRings) -> FrictionFit:
    """Fit one friction value to measured points. Raises CaseError for points beyond the curves' reduction."""
    largest = float(curves.height_reduction[-1])
    beyond = float(measured.height_reduction.max())
    if beyond > largest * (1 + 1e-6):
        text = f"a point at {100 * beyond:.1f} % reduction lies beyond the {100 * largest:.1f} % that the case computes"
        raise CaseError([Problem("height_reduction", text, "press further in the case (the platen's stroke)")])
    bore = curves.interpolate(np.minimum(measured.height_reduction, largest))
    low, high = float(curves.friction[0]), float(curves.friction[-1])

    def misfit(friction: FloatArray) -> FloatArray:
        return np.asarray(bore(friction[0]) - measured.bore_ratio, dtype=np.float64)

    trials = np.linspace(low, high, 401)
    start = trials[np.argmin([np.sum(misfit(np.array([x])) ** 2) for x in trials])]
    found = least_squares(
        misfit,
        [min(max(start, low + 1e-9), high - 1e-9)],
        jac=lambda friction: np.asarray(bore(friction[0], 1))[:, None],
        bounds=(low, high),
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
    )
    friction, residuals = float(found.x[0]), -np.asarray(found.fun, dtype=np.float64)
    slope, count = np.asarray(bore(friction, 1)), len(residuals)
    scatter, half = np.nan, np.nan
    if count > 1:
        scatter = float(np.sqrt(residuals @ residuals / (count - 1)))
        half = float(student_t.ppf(0.975, count - 1)) * scatter / max(float(np.linalg.norm(slope)), 1e-300)
    interval = (max(friction - half, low), min(friction + half, high)) if count > 1 else (np.nan, np.nan)
    return FrictionFit(friction, interval, scatter, residuals, tuple(_warn(friction, half, low, high, count)))


def _warn(friction: float, half: float, low: float, high: float, count: int) -> list[str]:
    """Return warnings of a doubtful fit."""
    warnings = []
    near = 1e-3 * (high - low)
    if friction - low < near or high - friction < near:
        end, side = (low, "below") if friction - low < near else (high, "above")
        warnings.append(
            f"the fit runs against the end of the range, {end:g}: the points ask for friction {side} it, or the case "
            "(height, diameters, material) is not what was measured"
        )
    elif friction - half < low or friction + half > high:
        warnings.append(f"the interval reaches over the end of the range, {low:g} to {high:g}, and is cut there")
    if count < FEW:
        none = "a single point has no scatter: there is no interval"
        few = f"{count} points are few: the interval rests on {count - 1} degree{'s' * (count > 2)} of freedom"
        warnings.append(none if count == 1 else few)
    return warnings


def calibrate_ring(
    measured_file: Path | str,
    case_file: Path | str,
    folder: Path | str,
    *,
    law: FrictionLaw = "shear",
    values: Sequence[float] = (),
    bore: BorePlace = "mean",
    settings: Sequence[str] = (),
    jobs: int = 0,
    cluster: Cluster | str | None = None,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> Calibration | None:
    """Run a ring compression at the friction values and fit friction to the measured points.

    All tools of the case get the law and the value. bore: the measured bore is that averaged over the height, or at
    mid-height. Writes into the folder what a sweep does, calibration.json and calibration.png. None if it was
    interrupted. jobs, cluster, member_timeout: as of run_sweep. Raises CaseError, OutputError and ClusterError.
    """
    from presswork.study.calibrate_plot import draw_calibration

    case = Case.from_toml(case_file, overrides=settings)
    symbol = SYMBOLS[law]
    friction = _check_values(values or VALUES[law], symbol)
    combinations = [({symbol: value}, _set_friction(case_file, settings, law, value)) for value in friction]
    members = make_members(case_file, combinations, settings)
    measured = read_measured(measured_file, _initial_bore(case))
    sweep = run_members(
        members, folder, jobs=jobs, cluster=cluster, member_timeout=member_timeout, resume=resume, overwrite=overwrite,
        on_progress=on_progress,
    )  # fmt: skip
    if sweep.interrupted:
        return None
    curves, lost = collect_curves(sweep, symbol, bore)
    fit = fit_friction(curves, measured)
    warnings = (*fit.warnings, *lost)
    fit = FrictionFit(fit.friction, fit.interval, fit.scatter, fit.residuals, warnings)
    calibration = Calibration(law, fit, curves, measured, sweep.folder)
    _write(calibration, symbol, bore)
    draw_calibration(calibration)
    return calibration


def collect_curves(sweep: SweepResult, symbol: str, bore: BorePlace) -> tuple[CalibrationCurves, list[str]]:
    """Return the curves of the members that completed, and notes on the others. Raises CaseError below 3."""
    good = sorted((m for m in sweep.members if m.status == "completed"), key=lambda m: float(m.values[symbol]))
    lost = [
        f"no curve at {symbol} = {m.values[symbol]:g}: {m.status.replace('_', ' ')}, {m.reason}"
        for m in sweep.members
        if m.status != "completed"
    ]
    if len(good) < 3:
        raise CaseError([Problem("", f"only {len(good)} of {len(sweep.members)} runs completed", "; ".join(lost))])
    rings = [measure_ring(Result(member.folder)) for member in good]
    end = min(float(ring.height_reduction[-1]) for ring in rings)
    if end <= 0:
        raise CaseError([Problem("", "the case does not press the ring", "give its platen a stroke")])
    steps = np.linspace(0.0, end, max(len(ring.height_reduction) for ring in rings))
    tables = [
        PchipInterpolator(ring.height_reduction, ring.bore_mean if bore == "mean" else ring.bore_mid)(steps)
        for ring in rings
    ]
    friction = np.array([float(member.values[symbol]) for member in good])
    return CalibrationCurves(friction, steps, np.array(tables)), lost


def _check_values(values: Sequence[float], symbol: str) -> list[float]:
    """Return the friction values in order. Raises CaseError."""
    ordered = sorted(float(value) for value in values)
    if len(set(ordered)) != len(ordered) or len(ordered) < 3:
        raise CaseError([Problem(symbol, "expected three or more different friction values", value=list(values))])
    return ordered


def _set_friction(case_file: Path | str, settings: Sequence[str], law: FrictionLaw, value: float) -> list[str]:
    """Return overrides that give every tool this friction in the place of its own."""
    path = Path(case_file)
    data, _ = read_toml(path)
    apply_overrides(data, settings, path)
    overrides = []
    for name, tool in data.get("tools", {}).items():
        kept = {key: entry for key, entry in tool.items() if key not in ("contact", "m", "mu")}
        overrides.append(format_override(f"tools.{name}", {**kept, "contact": law, SYMBOLS[law]: value}))
    return overrides


def _initial_bore(case: Case) -> float:
    """Return the bore's diameter [mm] before anything is run. Raises CaseError if there is none."""
    radius = float(build_model(case).mesh.points[:, 0].min())
    if case.analysis != "axisymmetric" or radius <= 0:
        raise CaseError([Problem("", "no ring", "an axisymmetric workpiece with a bore is needed")], case.source)
    return 2 * radius


def _write(calibration: Calibration, symbol: str, bore: BorePlace) -> None:
    """Write calibration.json."""
    fit, curves, measured = calibration.fit, calibration.curves, calibration.measured
    write_summary(
        calibration.folder / "calibration.json",
        {
            "law": calibration.law,
            symbol: fit.friction,
            "confidence_95_percent": fit.interval,
            "scatter_of_bore_ratio": fit.scatter,
            "warnings": fit.warnings,
            "bore": bore,
            "measured": {
                "height_reduction": measured.height_reduction,
                "bore_ratio": measured.bore_ratio,
                "residual": fit.residuals,
            },
            "curves": {
                symbol: curves.friction,
                "height_reduction": curves.height_reduction,
                "bore_ratio": curves.bore_ratio,
            },
        },
    )
