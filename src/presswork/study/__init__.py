# SPDX-License-Identifier: Apache-2.0
"""Families of cases: sweeps in parallel processes, friction from a ring test, and the shape of a blank."""

from presswork.study.avitzur import integrate_ring
from presswork.study.blank_shape import BlankShape, Draw, find_blank_shape, surround_opening
from presswork.study.calibrate import Calibration, CalibrationCurves, FrictionFit, calibrate_ring, fit_friction
from presswork.study.measured import MeasuredRings, read_measured
from presswork.study.ring import RingMeasures, measure_ring
from presswork.study.sweep import MemberResult, SweepProgress, SweepResult, run_sweep
from presswork.study.vary import parse_variation

__all__ = [
    "BlankShape",
    "Calibration",
    "CalibrationCurves",
    "Draw",
    "FrictionFit",
    "MeasuredRings",
    "MemberResult",
    "RingMeasures",
    "SweepProgress",
    "SweepResult",
    "calibrate_ring",
    "find_blank_shape",
    "fit_friction",
    "integrate_ring",
    "measure_ring",
    "parse_variation",
    "read_measured",
    "run_sweep",
    "surround_opening",
]
