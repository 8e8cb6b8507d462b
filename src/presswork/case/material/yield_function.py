# SPDX-License-Identifier: Apache-2.0
"""Yield functions: their keys, their parameters, and the check that the surface is convex and closed.

Formulas: docs/theory/sheet_material.md. r-values and stresses belong to tension at 0, 45 and 90 degrees from the
rolling direction; the equivalent stress is the yield stress along the rolling direction.
"""

from __future__ import annotations

import functools
import math
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork import _core, model
from presswork.case.errors import CaseError, Problem
from presswork.case.material.yld2000_fit import YieldData, fit_yld2000, r_value
from presswork.case.part import Part
from presswork.case.units import Number, fault
from presswork.law.elastic_plastic import make_yield_function
from presswork.model import FloatArray

RValue = Annotated[Number, Field(gt=0, lt=100, description="width strain over thickness strain in tension")]
Exponent = Annotated[Literal[6, 8], Field(description="exponent of the yield function: 6 for steel, 8 for aluminium")]
Ratio = Annotated[Number, Field(gt=0, description="yield stress over that along the rolling direction")]
_R_VALUE = "width strain over thickness strain in tension at {} degrees from the rolling direction"
_RATIO = "yield stress {} over that along the rolling direction"


OF_GRADE = ("r00", "r45", "r90", "stress_45", "stress_90", "stress_biaxial", "r_biaxial")
"""Keys that describe a grade's yield by tests; they exclude alpha."""
WORST = 1e-3
"""Largest error of a stress or an r-value with which parameters give back a grade's."""


class VonMisesYield(Part):
    """The isotropic yield function of von Mises."""

    law: Literal["von_mises"] = Field(default="von_mises", description="von_mises: von Mises', isotropic")

    def to_model(self) -> None:
        """Return what stands for von Mises in the Model."""

    def build(self) -> _core.YieldFunction:
        """Return the compiled function."""
        return make_yield_function(None)


class Hill1948(Part):
    """Hill's quadratic yield function, from r-values or from yield stresses."""

    law: Literal["hill1948"] = Field(default="hill1948", description="hill1948: Hill's quadratic one")
    r00: RValue | None = Field(default=None, description=_R_VALUE.format(0))
    r45: RValue | None = Field(default=None, description=_R_VALUE.format(45))
    r90: RValue | None = Field(default=None, description=_R_VALUE.format(90))
    stress_45: Ratio | None = Field(default=None, description=_RATIO.format("at 45 degrees"))
    stress_90: Ratio | None = Field(default=None, description=_RATIO.format("at 90 degrees"))
    stress_biaxial: Ratio | None = Field(default=None, description=_RATIO.format("in equibiaxial tension"))
    L: Number = Field(default=1.5, gt=0, description="parameter of the shear yz, in three dimensions")
    M: Number = Field(default=1.5, gt=0, description="parameter of the shear zx, in three dimensions")

    @model_validator(mode="after")
    def _check(self) -> Self:
        r_values, stresses = ("r00", "r45", "r90"), ("stress_45", "stress_90", "stress_biaxial")
        present = [name for name in r_values + stresses if getattr(self, name) is not None]
        wanted = stresses if present and present[0] in stresses else r_values
        remedy = "give r00, r45 and r90, or stress_45, stress_90 and stress_biaxial"
        for name in wanted:
            if name not in present:
                raise fault("missing key", remedy, key=name)
        if len(present) > 3:
            raise fault(f"{', '.join(present)} give the same quantity", remedy, key=present[-1])
        check_surface(self.build(), "stress_biaxial" if wanted is stresses else "r00")
        return self

    def hill_parameters(self) -> tuple[float, ...]:
        """Return F, G, H, L, M, N; G + H = 1."""
        if self.r00 is not None and self.r45 is not None and self.r90 is not None:
            H = self.r00 / (1 + self.r00)
            G = 1 - H
            F = H / self.r90
            return (F, G, H, self.L, self.M, (self.r45 + 0.5) * (F + G))
        assert self.stress_45 is not None
        assert self.stress_90 is not None
        assert self.stress_biaxial is not None
        x, y, z = 1.0, self.stress_90**-2, self.stress_biaxial**-2  # G + H, F + H, F + G
        F, G, H = 0.5 * (y + z - x), 0.5 * (x + z - y), 0.5 * (x + y - z)
        return (F, G, H, self.L, self.M, 0.5 * (4 * self.stress_45**-2 - z))

    def to_model(self) -> model.YieldFunction:
        """Return the Model's yield function."""
        return model.YieldFunction("hill1948", self.hill_parameters())

    def build(self) -> _core.YieldFunction:
        """Return the compiled function."""
        return make_yield_function(self.to_model())


class Barlat1989(Part):
    """The yield function of Barlat and Lian (1989), from r-values."""

    law: Literal["barlat1989"] = Field(default="barlat1989", description="barlat1989: Barlat and Lian's (1989)")
    r00: RValue = Field(description=_R_VALUE.format(0))
    r45: RValue = Field(description=_R_VALUE.format(45))
    r90: RValue = Field(description=_R_VALUE.format(90))
    exponent: Exponent

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_surface(self.build(), "r00")
        return self

    def coefficients(self) -> tuple[float, float, float, float]:
        """Return a, c, h, p. p is where the r-value at 45 degrees is r45."""
        from scipy.optimize import brentq  # slow to import

        x, y = self.r00 / (1 + self.r00), self.r90 / (1 + self.r90)
        c = 2 * math.sqrt(x * y)
        h = math.sqrt(x / y)
        a = 2 - c

        def miss(p: float) -> float:
            function = _core.YieldFunction.barlat1989(a, c, h, p, self.exponent)
            return float(r_value(function, np.array([math.pi / 4]))[0]) - self.r45

        return a, c, h, float(brentq(miss, 1e-2, 1e2, xtol=1e-14, rtol=1e-14))

    def to_model(self) -> model.YieldFunction:
        """Return the Model's yield function."""
        return model.YieldFunction("barlat1989", self.coefficients(), self.exponent)

    def build(self) -> _core.YieldFunction:
        """Return the compiled function."""
        return make_yield_function(self.to_model())


class Yld2000(Part):
    """Yld2000-2d of Barlat et al. (2003), from its eight parameters, or from r-values and yield stresses.

    A stress that is not given is that along the rolling direction: r-values alone then add no strength.
    """

    law: Literal["yld2000"] = Field(default="yld2000", description="yld2000: Yld2000-2d")
    alpha: tuple[Number, ...] | None = Field(
        default=None, min_length=8, max_length=8, description="alpha 1 to 8, in place of r-values and stresses"
    )
    exponent: Exponent
    r00: RValue | None = Field(default=None, description=_R_VALUE.format(0))
    r45: RValue | None = Field(default=None, description=_R_VALUE.format(45))
    r90: RValue | None = Field(default=None, description=_R_VALUE.format(90))
    stress_45: Ratio | None = Field(default=None, description=_RATIO.format("at 45 degrees") + "; 1 if left out")
    stress_90: Ratio | None = Field(default=None, description=_RATIO.format("at 90 degrees") + "; 1 if left out")
    stress_biaxial: Ratio | None = Field(
        default=None, description=_RATIO.format("in equibiaxial tension") + "; 1 if left out"
    )
    r_biaxial: RValue | None = Field(
        default=None, description="strain across over strain along in equibiaxial tension; r00/r90 if left out"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        remedy = "give alpha, or r00, r45 and r90 and the stresses that were measured"
        measured = [name for name in OF_GRADE if getattr(self, name) is not None]
        if self.alpha is None:
            for name in ("r00", "r45", "r90"):
                if name not in measured:
                    raise fault("missing key", remedy, key="alpha" if not measured else name)
            self._find_alpha()
        elif measured:
            raise fault(f"alpha and {measured[0]} give the same quantity", remedy, key=measured[0])
        check_surface(self.build(), "alpha" if self.alpha else "r00")
        return self

    def _find_alpha(self) -> tuple[float, ...]:
        """Return alpha 1 to 8: those given, or those that give back the measured values."""
        if self.alpha is not None:
            return self.alpha
        assert self.r00 is not None
        assert self.r45 is not None
        assert self.r90 is not None
        stresses = tuple(1.0 if s is None else s for s in (self.stress_45, self.stress_90, self.stress_biaxial))
        r_biaxial = self.r00 / self.r90 if self.r_biaxial is None else self.r_biaxial
        try:
            return _fit_grade((self.r00, self.r45, self.r90), stresses, r_biaxial, self.exponent)
        except CaseError as error:
            raise fault(str(error.problems[0]), "check r-values and stresses", key="r00") from None

    def find_hill(self) -> Hill1948 | None:
        """Return Hill's function of the same r-values, given or following from alpha; None where one is negative."""
        if self.alpha is None:
            return Hill1948(r00=self.r00, r45=self.r45, r90=self.r90)
        r00, r45, r90 = (float(r) for r in r_value(self.build(), np.radians([0.0, 45.0, 90.0])))
        if min(r00, r45, r90) <= 0.0:
            return None
        return Hill1948(r00=r00, r45=r45, r90=r90)

    def to_model(self) -> model.YieldFunction:
        """Return the Model's yield function."""
        return model.YieldFunction("yld2000", self._find_alpha(), self.exponent)

    def build(self) -> _core.YieldFunction:
        """Return the compiled function."""
        return make_yield_function(self.to_model())


class Yld2004(Part):
    """Yld2004-18p of Barlat et al. (2005), from the coefficients of its two transformations."""

    law: Literal["yld2004"] = Field(default="yld2004", description="yld2004: Yld2004-18p")
    prime: tuple[Number, ...] = Field(
        min_length=9, max_length=9, description="c12, c13, c21, c23, c31, c32, c44, c55, c66 of the first; 44 is yz"
    )
    double_prime: tuple[Number, ...] = Field(min_length=9, max_length=9, description="the same of the second")
    exponent: Exponent

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_surface(self.build(), "prime")
        check_surface(self.build(), "prime", components=6)
        return self

    def to_model(self) -> model.YieldFunction:
        """Return the Model's yield function."""
        return model.YieldFunction("yld2004", (*self.prime, *self.double_prime), self.exponent)

    def build(self) -> _core.YieldFunction:
        """Return the compiled function."""
        return make_yield_function(self.to_model())


YieldFunction = Annotated[VonMisesYield | Hill1948 | Barlat1989 | Yld2000 | Yld2004, Field(discriminator="law")]


@functools.lru_cache(maxsize=256)
def _fit_grade(r: tuple[float, ...], stresses: tuple[float, ...], r_biaxial: float, exponent: int) -> tuple[float, ...]:
    """Return alpha 1 to 8 of r-values at 0, 45, 90 degrees and stresses at 45, 90 degrees and biaxial."""
    data = YieldData(np.array([0.0, 45.0, 90.0]), np.array([1.0, *stresses[:2]]), np.array(r), stresses[2], r_biaxial)
    found = fit_yld2000(data, exponent)
    if max(found.worst()) > WORST:
        text = f"no parameters give these values; the best miss a stress by {100 * found.worst()[0]:.2g} %"
        raise CaseError([Problem("", text)], "yld2000")
    return found.alpha


def check_surface(function: _core.YieldFunction, key: str, n: int = 4000, *, components: Literal[3, 6] = 3) -> None:
    """Refuse a yield surface that is not closed or not convex.

    Over n directions of stress: the equivalent stress of a unit stress must be above 0.02, and no eigenvalue of the
    Hessian below zero. In six components it is stresses without a mean. Raises the schema's error at `key`.
    """
    value, _, hessian = function.evaluate(_plane_stresses(n) if components == 3 else _deviators(n))
    remedy = "check the data: a typing error, or a set of parameters for another formulation"
    if not np.isfinite(value).all() or value.min() < 0.02:
        raise fault("the yield surface is not closed: some stress never yields", remedy, key=key)
    bend = np.linalg.eigvalsh(hessian)[:, 0] * value
    if bend.min() < -1e-6 * np.abs(hessian).max():
        raise fault("the yield surface is not convex", remedy, key=key)


def _plane_stresses(n: int) -> FloatArray:
    """Return directions of plane stress (n, 3), spread evenly."""
    i = np.arange(n) + 0.5
    z, turn = 1 - 2 * i / n, np.pi * (1 + math.sqrt(5)) * i
    radius = np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)


def _deviators(n: int) -> FloatArray:
    """Return directions of deviatoric stress (n, 6), the same ones at every call."""
    stress = np.random.default_rng(0).standard_normal((n, 6))
    stress[:, :3] -= stress[:, :3].mean(axis=1, keepdims=True)
    return np.asarray(stress / np.linalg.norm(stress, axis=1, keepdims=True))
