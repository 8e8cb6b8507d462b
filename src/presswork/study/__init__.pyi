# SPDX-License-Identifier: Apache-2.0
from .avitzur import integrate_ring
from .blank_shape import BlankShape, Draw, find_blank_shape, surround_opening
from .calibrate import Calibration, CalibrationCurves, FrictionFit, calibrate_ring, fit_friction
from .calibrate_curve import CurveFit, calibrate_curve
from .cluster.connection import Cluster, ClusterError
from .compensate import Compensation, Loop, compensate_springback
from .measured import MeasuredRings, read_measured
from .optimum.optimise import Optimum, optimise
from .ring import RingMeasures, measure_ring
from .scatter.robust import Robustness, robust
from .sweep import MemberResult, SweepProgress, SweepResult, run_sweep
from .vary import parse_variation

__all__ = [
    "BlankShape",
    "Calibration",
    "CalibrationCurves",
    "Cluster",
    "ClusterError",
    "Compensation",
    "CurveFit",
    "Draw",
    "FrictionFit",
    "Loop",
    "MeasuredRings",
    "MemberResult",
    "Optimum",
    "RingMeasures",
    "Robustness",
    "SweepProgress",
    "SweepResult",
    "calibrate_curve",
    "calibrate_ring",
    "compensate_springback",
    "find_blank_shape",
    "fit_friction",
    "integrate_ring",
    "measure_ring",
    "optimise",
    "parse_variation",
    "read_measured",
    "robust",
    "run_sweep",
    "surround_opening",
]
