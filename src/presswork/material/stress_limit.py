# SPDX-License-Identifier: Apache-2.0
"""The forming limit in stresses: for strain paths that change (Arrieux 1982; Stoughton & Yoon 2012).

A forming limit measured on proportional paths becomes a limit of equivalent plastic strain by the ratio of principal
stresses. With isotropic hardening stresses and p are one, and neither depends on the strain path.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.case.material.forming_limit.proportional import ProportionalPath, find_stress
from presswork.formability import FormingLimitCurve
from presswork.model import FloatArray


@dataclass(frozen=True)
class StressLimit:
    """Limit of the equivalent plastic strain and of the stress, by proportional path, shape (m,)."""

    path: ProportionalPath
    """Stress over the flow stress, and strain rates, of each path."""
    p: FloatArray
    """Equivalent plastic strain at the limit."""
    flow: FloatArray
    """Flow stress there [MPa]."""

    def stresses(self) -> FloatArray:
        """Return the principal stresses at the limit [MPa], shape (m, 2): major, minor."""
        return np.asarray(self.flow[:, None] * self.path.stress[:, :2])

    def limit_of_p(self, stress: FloatArray) -> FloatArray:
        """Return the limit of the equivalent plastic strain at principal stresses (n, 2): major, minor."""
        stress = np.asarray(stress, dtype=float)
        own = self.path.stress[:, 1] / self.path.stress[:, 0]
        order = np.argsort(own)
        return np.interp(stress[:, 1] / stress[:, 0], own[order], self.p[order])

    def curve_after(self, prestrain: float, minor: float, major: float) -> FormingLimitCurve:
        """Return the limit in strains of proportional paths that follow a prestrain.

        prestrain: its equivalent plastic strain; minor, major: its strains along the axes of the later paths. Limits at
        or below the prestrain are the prestrain itself.
        """
        rest = np.maximum(self.p - prestrain, 0.0)
        strain = rest[:, None] * self.path.rate + np.array([major, minor])
        order = np.argsort(strain[:, 1], kind="stable")
        ordered = strain[order]
        distinct = np.concatenate([[True], np.diff(ordered[:, 1]) > 1e-9])
        return FormingLimitCurve(ordered[distinct, 1], ordered[distinct, 0], "after a change of path")


def find_stress_limit(
    curve: FormingLimitCurve,
    function: _core.YieldFunction,
    law: _core.SheetLaw,
    ratios: FloatArray | None = None,
    angle: float = 0.0,
) -> StressLimit:
    """Turn a forming limit curve of proportional paths into stresses.

    ratios: minor over major strain of the paths; angle: of the major strain from the rolling direction [degrees].
    """
    ratios = np.linspace(-0.45, 1.0, 59) if ratios is None else np.asarray(ratios, dtype=float)
    path = find_stress(function, ratios, angle)
    low, high = np.zeros(len(ratios)), np.full(len(ratios), 3.0)
    for _ in range(60):  # the major strain where the path meets the curve
        middle = 0.5 * (low + high)
        below = middle < _limit_beside(curve, ratios * middle)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    p = high / path.rate[:, 0]
    return StressLimit(path, p, law.flow_stress(p)[0])


def _limit_beside(curve: FormingLimitCurve, minor: FloatArray) -> FloatArray:
    """Return the curve without its bound major >= minor, level beyond its ends."""
    return np.interp(minor, curve.minor, curve.major)
