# SPDX-License-Identifier: Apache-2.0
"""The study file (TOML) of an optimisation: case, variables with bounds, goals, limits, and how to search."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork.case.part import Part
from presswork.case.units import fault, split_quantity
from presswork.model import FloatArray
from presswork.study.study_file import read_study_file
from presswork.study.vary import format_override


class Variable(Part):
    """One number that is varied, of one key of the case or of several alike."""

    key: str = Field(default="", description="key of the case, for instance stages.0.tools.holder.force")
    keys: tuple[str, ...] = Field(default=(), description="instead of key: several keys that all take the same value")
    lower: float | str = Field(description='least value, as the case has it: a number, or with a unit, "2 kN"')
    upper: float | str = Field(description="largest value, in the same unit")
    start: float | str | None = Field(
        default=None, description="value of the first run; without it the middle of the bounds"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if bool(self.key.strip()) == bool(self.keys):
            raise fault("give either key or keys", 'for instance key = "stages.0.tools.holder.force"', key="key")
        if any("=" in key or not key.strip() for key in self.names):
            raise fault("a key is a dotted path without =", "for instance tools.die.edge_radius", key="key")
        units = {name: split_quantity(value) for name, value in self._given().items()}
        for name, found in units.items():
            if found is None:
                raise fault("expected a number, or one with a unit", 'for instance 12, or "2 kN"', key=name)
            if found[1] != self.unit:
                raise fault(f"its unit is not that of lower (`{self.unit}`)", "write all in one unit", key=name)
        low, high = self.bounds
        if not low < high:
            remedy = "exchange them" if low > high else "give different ones, or set the key in the case"
            raise fault(f"the upper bound is not above the lower one, {low:g}", remedy, key="upper")
        if not low <= self.first <= high:
            raise fault(f"lies outside the bounds, {low:g} to {high:g}", "give a value between them", key="start")
        return self

    def _given(self) -> dict[str, float | str]:
        given = {"lower": self.lower, "upper": self.upper}
        return given if self.start is None else {**given, "start": self.start}

    @property
    def names(self) -> tuple[str, ...]:
        """The keys of the case that take the value."""
        return self.keys or (self.key.strip(),)

    @property
    def unit(self) -> str:
        """Unit of the values; empty for plain numbers."""
        return _split(self.lower)[1]

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and largest value, in the unit."""
        return _split(self.lower)[0], _split(self.upper)[0]

    @property
    def first(self) -> float:
        """Value of the first run, in the unit."""
        return 0.5 * sum(self.bounds) if self.start is None else _split(self.start)[0]

    def write(self, value: float) -> float | str:
        """Return a value as the case has it."""
        return f"{value!r} {self.unit}" if self.unit else value


class Goal(Part):
    """A measure that is to be small, or large."""

    minimise: str = Field(
        default="",
        description="measure to be as small as may be, for instance max_thinning_percent; or the key of a variable",
    )
    maximise: str = Field(
        default="",
        description="measure to be as large as may be; or the key of a variable: the largest blank that does not crack",
    )
    weight: float = Field(default=1.0, gt=0, description="of several goals: factor of this one in their sum")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if bool(self.minimise) == bool(self.maximise):
            raise fault("give either minimise or maximise", 'for instance minimise = "max_thinning_percent"')
        return self

    @property
    def measure(self) -> str:
        """Name of the measure."""
        return self.minimise or self.maximise

    @property
    def factor(self) -> float:
        """Return the factor of the measure in the sum that is minimised."""
        return self.weight if self.minimise else -self.weight


class Limit(Part):
    """A measure that must keep to a value."""

    measure: str = Field(min_length=1, description="the measure, for instance min_forming_limit_margin")
    at_most: float | None = Field(default=None, description="its largest value")
    at_least: float | None = Field(default=None, description="its least value")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.at_most is None and self.at_least is None:
            raise fault("a limit needs a value", "give at_most or at_least, or both", key="measure")
        if self.at_most is not None and self.at_least is not None and self.at_least > self.at_most:
            raise fault(f"at_least is above at_most, {self.at_most:g}", "exchange them", key="at_least")
        return self

    @property
    def sides(self) -> tuple[tuple[float, float], ...]:
        """Sign and value of each side: sign * (measure - value) <= 0 holds."""
        given = ((1.0, self.at_most), (-1.0, self.at_least))
        return tuple((sign, value) for sign, value in given if value is not None)


class Search(Part):
    """How to look for the optimum."""

    method: Literal["surrogate", "gradient"] = Field(
        default="surrogate",
        description="surrogate: radial basis functions through all runs; gradient: SLSQP by derivatives",
    )
    slopes: Literal["auto", "exact", "differences"] = Field(
        default="auto",
        description="of gradient: by derivatives that the runs find themselves, by differences of runs; auto: exact "
        "where the case and the measures have them, but for stampings",
    )
    runs: int = Field(default=40, ge=1, le=1000, strict=True, description="runs at most")
    together: int = Field(
        default=2,
        ge=1,
        le=64,
        strict=True,
        description="runs that the surrogate proposes at a time",
    )
    tolerance: float = Field(
        default=0.01, gt=0, lt=0.5, description="distance at which two runs are alike, as a part of the bounds' range"
    )
    step: float = Field(
        default=0.02, gt=0, lt=0.5, description="step of finite differences, as a part of the bounds' range"
    )


class Study(Part):
    """A study: what is varied, and what for."""

    case: str = Field(min_length=1, description="the case file, relative to the study file")
    set: tuple[str, ...] = Field(default=(), description="`key=value` texts that change the case, for all runs")
    variables: tuple[Variable, ...] = Field(
        min_length=1, max_length=20, description="keys that are varied, each with its bounds"
    )
    goals: tuple[Goal, ...] = Field(min_length=1, description="measures to be made small or large")
    limits: tuple[Limit, ...] = Field(default=(), description="limits that the best case must keep")
    search: Search = Field(default_factory=Search, description="how the optimum is searched")

    @model_validator(mode="after")
    def _check(self) -> Self:
        names = [name for variable in self.variables for name in variable.names]
        for index, variable in enumerate(self.variables):
            if any(names.count(name) > 1 for name in variable.names):
                raise fault("a key is varied twice", "leave one out", key=f"variables.{index}.key")
            if set(variable.names) & {setting.partition("=")[0].strip() for setting in self.set}:
                raise fault("a key is both set and varied", "leave one out", key=f"variables.{index}.key")
        return self

    def values_at(self, point: FloatArray) -> tuple[float, ...]:
        """Return the variables' values at a point of the unit box (n,), with no more digits than a case should have."""
        values = []
        for variable, part in zip(self.variables, point, strict=True):
            low, high = variable.bounds
            values.append(min(max(float(f"{low + part * (high - low):.9g}"), low), high))
        return tuple(values)

    def place_of(self, values: Sequence[float]) -> FloatArray:
        """Return values of the variables as parts of their ranges (n,)."""
        low, high = np.array([variable.bounds for variable in self.variables]).T
        return np.asarray((np.array(values) - low) / (high - low))

    def write_overrides(self, values: Sequence[float]) -> list[str]:
        """Return `key=value` texts that give a case these values of the variables."""
        written = [
            format_override(key, variable.write(value))
            for variable, value in zip(self.variables, values, strict=True)
            for key in variable.names
        ]
        return [*self.set, *written]

    @property
    def variable_names(self) -> tuple[str, ...]:
        """The keys that are varied; goals and limits may name them, too."""
        return tuple(name for variable in self.variables for name in variable.names)

    @property
    def measures(self) -> dict[str, str]:
        """The measures that goals and limits name, each with the first key that does."""
        named = [
            (f"goals.{i}.{'minimise' if goal.minimise else 'maximise'}", goal.measure)
            for i, goal in enumerate(self.goals)
        ]
        named += [(f"limits.{i}.measure", limit.measure) for i, limit in enumerate(self.limits)]
        found: dict[str, str] = {}
        for key, measure in named:
            found.setdefault(measure, key)
        return found


def read_study(path: Path | str) -> tuple[Study, str]:
    """Read and check a study file; return its text, too. Raises CaseError with every problem found."""
    return read_study_file(path, Study)


def _split(value: Any) -> tuple[float, str]:
    """Return number and unit of a value that was checked."""
    return split_quantity(value) or (math.nan, "")
