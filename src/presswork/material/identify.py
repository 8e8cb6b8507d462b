# SPDX-License-Identifier: Apache-2.0
"""Identification from tensile tests: hardening laws, r-values, yield stress by direction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.case.errors import CaseError, Problem
from presswork.material.tensile import TensileTest
from presswork.model import FloatArray

FIRST_PLASTIC_STRAIN = 0.002
"""Where the fit starts; below lies the bend from elastic to plastic, that of the machine as much as of the metal."""
_FIRST_WIDTH_STRAIN = 0.02


@dataclass(frozen=True)
class _Law:
    """A hardening law as the fit sees it: the keys of the case, first values and bounds by the measured stress."""

    keys: tuple[str, ...]
    start: Callable[[float, float], list[float]]
    low: Callable[[float, float], list[float]]
    high: Callable[[float, float], list[float]]


_LAWS = {  # s, t: yield stress and highest stress measured
    "swift": _Law(
        ("K", "e0", "n"),
        lambda s, t: [1.5 * t, 0.01, 0.2],
        lambda s, t: [0.1 * t, 1e-6, 1e-3],
        lambda s, t: [20 * t, 0.5, 1.0],
    ),
    "ludwik": _Law(
        ("yield_stress", "K", "n"),
        lambda s, t: [0.9 * s, t, 0.4],
        lambda s, t: [1e-3 * s, 1e-3 * t, 0.02],
        lambda s, t: [1.2 * s, 20 * t, 1.0],
    ),
    "voce": _Law(
        ("yield_stress", "saturation_stress", "rate"),
        lambda s, t: [s, 1.1 * t, 10.0],
        lambda s, t: [0.1 * s, 0.9 * t, 0.1],
        lambda s, t: [1.2 * s, 5 * t, 200.0],
    ),
    "linear_voce": _Law(
        ("yield_stress", "saturation_stress", "rate", "modulus"),
        lambda s, t: [s, 0.9 * t, 10.0, 0.2 * t],
        lambda s, t: [0.1 * s, 0.5 * s, 0.1, 0.0],
        lambda s, t: [1.2 * s, 5 * t, 200.0, 20 * t],
    ),
    "hockett_sherby": _Law(
        ("yield_stress", "saturation_stress", "rate", "exponent"),
        lambda s, t: [s, 1.2 * t, 5.0, 0.7],
        lambda s, t: [0.1 * s, 0.9 * t, 0.05, 0.1],
        lambda s, t: [1.2 * s, 5 * t, 100.0, 2.0],
    ),
    "swift_voce": _Law(
        ("voce_share", "K", "e0", "n", "yield_stress", "saturation_stress", "rate"),
        lambda s, t: [0.5, 1.5 * t, 0.01, 0.2, s, 1.1 * t, 10.0],
        lambda s, t: [0.0, 0.1 * t, 1e-6, 1e-3, 0.1 * s, 0.9 * t, 0.1],
        lambda s, t: [1.0, 20 * t, 0.5, 1.0, 1.2 * s, 5 * t, 200.0],
    ),
}
LAWS = tuple(_LAWS)
"""Laws that can be fitted."""


@dataclass(frozen=True)
class HardeningFit:
    """A hardening law fitted to a test."""

    law: str
    parameters: dict[str, float]
    """Parameters by the keys of a case."""
    scatter: float
    """Root mean square of measured less fitted stress [MPa]."""
    relative: float
    """The same over the measured stress."""
    criterion: float
    """Schwarz's criterion n ln(scatter²) + k ln n of n points and k parameters; of two laws the smaller is better."""
    largest_strain: float
    """Plastic strain to which there were points; beyond it the law is an extrapolation."""

    def stress(self, plastic_strain: FloatArray) -> FloatArray:
        """Return the fitted flow stress [MPa]."""
        return _flow(self.law, list(self.parameters.values()), plastic_strain)


def fit_hardening(test: TensileTest, law: str, young: float) -> HardeningFit:
    """Fit a hardening law to a test by least squares, from a plastic strain of 0.002 to the uniform elongation.

    young: Young's modulus [MPa]. Raises CaseError if there are too few points, or too large a plastic part is negative.
    """
    from scipy.optimize import least_squares  # slow to import

    p = test.plastic_strain(young)
    used = p >= FIRST_PLASTIC_STRAIN
    kind = _LAWS[law]
    if used.sum() < len(kind.keys) + 2:
        text = f"{int(used.sum())} points beyond a plastic strain of {FIRST_PLASTIC_STRAIN:g}, too few for {law}"
        remedy = "measure more points, take a law of fewer parameters, or check Young's modulus"
        raise CaseError([Problem(f"the test at {test.angle:g} degrees", text, remedy)], "fit")
    p, stress = p[used], test.stress[used]
    first, top = float(stress[0]), float(stress.max())
    low, high = np.array(kind.low(first, top)), np.array(kind.high(first, top))
    start = np.clip(kind.start(first, top), low * 1.001 + 1e-12, high * 0.999)
    fit = least_squares(
        lambda x: (_flow(law, list(x), p) - stress) / top, start, bounds=(low, high), x_scale=start, max_nfev=5000,
        xtol=1e-12, ftol=1e-12, gtol=1e-12,
    )  # fmt: skip
    residual = fit.fun * top
    parameters = dict(zip(kind.keys, (float(value) for value in fit.x), strict=True))
    if "saturation_stress" in parameters:
        parameters["saturation_stress"] = max(parameters["saturation_stress"], parameters["yield_stress"])
    return HardeningFit(
        law,
        parameters,
        float(np.sqrt((residual**2).mean())),
        float(np.sqrt(((residual / stress) ** 2).mean())),
        float(len(p) * np.log((residual**2).mean() + 1e-30) + len(kind.keys) * np.log(len(p))),
        float(p[-1]),
    )


def _flow(law: str, parameters: Sequence[float], p: FloatArray) -> FloatArray:
    sheet = _core.SheetLaw(1e5, 0.3, _VON_MISES, _core.HardeningLaw[law], parameters)
    return np.asarray(sheet.flow_stress(np.ascontiguousarray(p))[0])


_VON_MISES = _core.YieldFunction.hill1948((0.5, 0.5, 0.5, 1.5, 1.5, 1.5))


def find_yield_stress(test: TensileTest, young: float) -> float:
    """Return the stress at a plastic strain of 0.002 [MPa], Rp0.2."""
    return float(np.interp(FIRST_PLASTIC_STRAIN, test.plastic_strain(young), test.stress))


def fit_r_value(test: TensileTest, young: float, poisson: float) -> float | None:
    """Return the slope of plastic width strain over plastic thickness strain; None if the width was not measured.

    The fit is a straight line through the origin over plastic strains of 0.02 and more. Raises CaseError if it is not
    positive.
    """
    if test.width_strain is None:
        return None
    along = test.plastic_strain(young)
    used = along >= min(_FIRST_WIDTH_STRAIN, 0.5 * float(along[-1]))
    along, width = along[used], (test.width_strain + poisson * test.stress / young)[used]
    thickness = -(along + width)
    r = float((width @ thickness) / (thickness @ thickness))
    if r <= 0:
        problem = Problem("width_strain", f"it gives an r-value of {r:.3g}", "in tension the width strain is negative")
        raise CaseError([problem], f"the test at {test.angle:g} degrees")
    return r


def compare_flow(test: TensileTest, reference: TensileTest, young: float) -> float:
    """Return a test's stress over that of a reference, each at the same plastic work per volume.

    The mean over the plastic work from a plastic strain of 0.002 of the reference to where the first of them ends.
    Raises CaseError if they have no plastic work in common.
    """
    (p, stress), (q, other) = (
        (t.plastic_strain(young)[t.plastic_strain(young) > 0], t.stress[t.plastic_strain(young) > 0])
        for t in (test, reference)
    )
    work, known = (
        np.concatenate([[0.0], np.cumsum(0.5 * np.diff(e) * (s[1:] + s[:-1]))]) + 0.5 * e[:1] * s[:1]
        for e, s in ((p, stress), (q, other))
    )
    first, last = float(np.interp(FIRST_PLASTIC_STRAIN, q, known)), min(float(work[-1]), float(known[-1]))
    if not last > first:
        problem = Problem("", "has no plastic work in common with that at 0 degrees", "measure to larger strains")
        raise CaseError([problem], f"the test at {test.angle:g} degrees")
    at = np.linspace(first, last, 50)
    return float((np.interp(at, work, stress) / np.interp(at, known, other)).mean())
