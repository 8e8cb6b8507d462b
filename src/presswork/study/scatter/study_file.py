# SPDX-License-Identifier: Apache-2.0
"""The study file (TOML) of a scatter: case, inputs with their distributions, limits, and how many runs."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork.case import CaseError
from presswork.case.errors import Problem, suggest
from presswork.case.part import Part
from presswork.case.units import fault, split_quantity
from presswork.model import FloatArray
from presswork.study.optimum.study_file import Limit
from presswork.study.study_file import read_study_file
from presswork.text_file import UnreadableError, read_text

Method = Literal["latin_hypercube", "sobol", "random"]
LEAST_EIGENVALUE = 1e-9
"""Eigenvalue of a matrix of correlations at or below which no inputs can be so correlated."""


class Input(Part):
    """One number that scatters, of one key of the case or of several alike."""

    key: str = Field(default="", description="key of the case, for instance blank.thickness")
    keys: tuple[str, ...] = Field(default=(), description="instead of key: several keys that all take the same value")
    distribution: Literal["normal", "lognormal", "uniform"] = Field(
        default="normal", description="normal, or lognormal, by mean and deviation; uniform between lower and upper"
    )
    mean: float | str | None = Field(
        default=None, description='mean value, as the case has it: a number, or with a unit, "0.8 mm"'
    )
    deviation: float | str | None = Field(default=None, description="standard deviation, in the same unit")
    lower: float | str | None = Field(
        default=None, description="least value: the distribution is cut off there; of a uniform one its end"
    )
    upper: float | str | None = Field(
        default=None, description="largest value: the distribution is cut off there; of a uniform one its end"
    )
    column: str = Field(default="", description="instead of a distribution: column of the coils that were measured")
    unit: str = Field(default="", description="unit of that column, where it is not the case's own")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if bool(self.key.strip()) == bool(self.keys):
            raise fault("give either key or keys", 'for instance key = "blank.thickness"', key="key")
        if any("=" in key or not key.strip() for key in self.names):
            raise fault("a key is a dotted path without =", "for instance blank.thickness", key="key")
        given = [name for name in ("mean", "deviation", "lower", "upper") if getattr(self, name) is not None]
        if self.column:
            if given:
                raise fault("the coils give the values", "leave it out, or leave out column", key=given[0])
            return self
        wanted = ("lower", "upper") if self.distribution == "uniform" else ("mean", "deviation")
        for name in wanted:
            if name not in given:
                raise fault(f"missing: a {self.distribution} distribution needs it", f"add {name}", key=name)
        if self.distribution == "uniform" and (extra := [n for n in ("mean", "deviation") if n in given]):
            raise fault("a uniform distribution has none", "leave it out", key=extra[0])
        self._check_numbers(given)
        return self

    def _check_numbers(self, given: list[str]) -> None:
        """Refuse numbers that make no distribution."""
        for name in given:
            found = split_quantity(getattr(self, name))
            if found is None:
                raise fault("expected a number, or one with a unit", 'for instance 0.8, or "0.8 mm"', key=name)
            if found[1] != self.written_unit:
                raise fault(f"its unit is not that of {given[0]} (`{self.written_unit}`)", "use one unit", key=name)
        low, high = self.bounds
        if not low < high:
            raise fault(f"the upper bound is not above the lower one, {low:g}", "exchange them", key="upper")
        if self.distribution == "uniform":
            return
        mean, deviation = self.moments
        if not deviation > 0.0:
            raise fault("expected a value > 0", "give the standard deviation", key="deviation")
        if not low < mean < high:
            raise fault(f"lies outside the bounds, {low:g} to {high:g}", "move mean or bounds", key="mean")
        if self.distribution == "lognormal" and not mean > 0.0:
            raise fault("a lognormal distribution has values above 0 alone", "take a normal one", key="mean")

    @property
    def names(self) -> tuple[str, ...]:
        """The keys of the case that take the value."""
        return self.keys or (self.key.strip(),)

    @property
    def written_unit(self) -> str:
        """Unit of the values; empty for plain numbers."""
        first = next((v for v in (self.mean, self.deviation, self.lower, self.upper) if v is not None), None)
        return self.unit if first is None else (split_quantity(first) or (0.0, ""))[1]

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and largest value, in the unit; infinite where there is none."""
        return _number(self.lower, -math.inf), _number(self.upper, math.inf)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation before anything is cut off, in the unit."""
        return _number(self.mean, math.nan), _number(self.deviation, math.nan)

    def write(self, value: float) -> float | str:
        """Return a value as the case has it."""
        return f"{value!r} {self.written_unit}" if self.written_unit else value


class Correlation(Part):
    """How far two inputs go together."""

    between: tuple[str, str] = Field(description="keys of the two inputs")
    value: float = Field(gt=-1.0, lt=1.0, description="coefficient of correlation, of normal inputs that of Pearson")


class Map(Part):
    """A field of the part that is judged place by place."""

    field: str = Field(min_length=1, description="field of the results at the end, for instance thinning")
    at_most: float | None = Field(default=None, description="its largest value, in the field's unit")
    at_least: float | None = Field(default=None, description="its least value, in the field's unit")

    @model_validator(mode="after")
    def _check(self) -> Self:
        self.limit()
        return self

    def limit(self) -> Limit:
        """Return the limit of each place. Raises a fault where there is none."""
        return Limit(measure=self.field, at_most=self.at_most, at_least=self.at_least)


class Sampling(Part):
    """How the inputs are drawn."""

    runs: int = Field(default=60, ge=8, le=10_000, strict=True, description="runs, one of each set of inputs")
    method: Method = Field(
        default="latin_hypercube",
        description="latin_hypercube: each input once in every equal part of its distribution; sobol: points that fill "
        "the space evenly, best in powers of two; random: plain Monte Carlo",
    )
    seed: int = Field(default=1, ge=0, strict=True, description="number that all draws follow from")


class ScatterStudy(Part):
    """A study: what scatters, and which limits must hold."""

    case: str = Field(min_length=1, description="the case file, relative to the study file")
    set: tuple[str, ...] = Field(default=(), description="`key=value` texts that change the case, for all runs")
    inputs: tuple[Input, ...] = Field(min_length=1, max_length=20, description="keys that scatter")
    correlations: tuple[Correlation, ...] = Field(default=(), description="pairs of inputs that go together")
    coils: str = Field(
        default="", description="table (CSV) of measured coils, a row each: rows are drawn whole, as they go together"
    )
    limits: tuple[Limit, ...] = Field(min_length=1, description="limits that every part should keep")
    maps: tuple[Map, ...] = Field(default=(), description="fields that are judged place by place")
    sampling: Sampling = Field(default_factory=Sampling, description="how the inputs are drawn")

    @model_validator(mode="after")
    def _check(self) -> Self:
        names = [name for each in self.inputs for name in each.names]
        fixed = {setting.partition("=")[0].strip() for setting in self.set}
        for index, each in enumerate(self.inputs):
            if any(names.count(name) > 1 for name in each.names):
                raise fault("a key scatters twice", "leave one out", key=f"inputs.{index}.key")
            if set(each.names) & fixed:
                raise fault("a key both is set and scatters", "leave one out", key=f"inputs.{index}.key")
            if each.column and not self.coils:
                raise fault("it names a column, and no coils are given", "add coils", key=f"inputs.{index}.column")
        if self.coils and not any(each.column for each in self.inputs):
            raise fault("no input takes a column of it", "give an input a column, or leave it out", key="coils")
        self.correlation_matrix()
        return self

    @property
    def drawn(self) -> tuple[int, ...]:
        """Numbers of the inputs that have a distribution; the others come from the coils."""
        return tuple(index for index, each in enumerate(self.inputs) if not each.column)

    def correlation_matrix(self) -> FloatArray:
        """Return the correlations of the inputs that have a distribution (n, n). Raises a fault for no such matrix."""
        places = {self.inputs[index].names[0]: place for place, index in enumerate(self.drawn)}
        matrix = np.eye(len(places))
        for number, each in enumerate(self.correlations):
            for name in each.between:
                if name not in places:
                    key, remedy = f"correlations.{number}.between", suggest(name, list(places), "inputs")
                    raise fault(f"`{name}` is no input with a distribution", remedy, key=key)
            i, j = (places[name] for name in each.between)
            if i == j:
                raise fault("names one input twice", "name two", key=f"correlations.{number}.between")
            matrix[i, j] = matrix[j, i] = each.value
        if len(matrix) and np.linalg.eigvalsh(matrix)[0] <= LEAST_EIGENVALUE:
            text = "no inputs can be so correlated: their matrix is not positive definite"
            raise fault(text, "make the correlations smaller, or leave one out", key="correlations")
        return matrix

    @property
    def measures(self) -> dict[str, str]:
        """The measures that limits name, each with the first key that does."""
        found: dict[str, str] = {}
        for index, limit in enumerate(self.limits):
            found.setdefault(limit.measure, f"limits.{index}.measure")
        return found


def read_study(path: Path | str) -> tuple[ScatterStudy, str]:
    """Read and check a study file; return its text, too. Raises CaseError with every problem found."""
    return read_study_file(path, ScatterStudy)


def read_coils(study: ScatterStudy, study_file: Path) -> FloatArray:
    """Return the measured values of the inputs that take a column (n_coils, n). Raises CaseError."""
    wanted = [(index, each.column) for index, each in enumerate(study.inputs) if each.column]
    if not wanted:
        return np.zeros((0, 0))
    path = study_file.parent / study.coils
    try:
        rows = list(csv.DictReader(io.StringIO(read_text(path))))
    except (OSError, UnreadableError) as error:
        problem = Problem("coils", f"cannot be read: {error}", "give a table (CSV)", study.coils)
        raise CaseError([problem], study_file) from None
    known = list(rows[0]) if rows else []
    problems = [
        Problem(f"inputs.{index}.column", f"{study.coils} has no such column", suggest(name, known, "columns"), name)
        for index, name in wanted
        if name not in known
    ]
    if len(rows) < 2:
        problems = [Problem("coils", "expected two rows at least", "give a row for each coil", study.coils)]
    if problems:
        raise CaseError(problems, study_file)
    return np.array(
        [[_read_number(row, name, n, study, study_file) for _, name in wanted] for n, row in enumerate(rows)]
    )


def _read_number(row: Mapping[str, str | None], name: str, number: int, study: ScatterStudy, study_file: Path) -> float:
    """Return a number of the coils' table. Raises CaseError."""
    try:
        value = float(row[name] or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        where = f"{study.coils}, row {number + 2}, column {name}: `{row[name]}` is not a number"
        raise CaseError([Problem("coils", where, "give a number, with a decimal point")], study_file)
    return value


def _number(value: float | str | None, otherwise: float) -> float:
    """Return the number of a value in its unit."""
    found = None if value is None else split_quantity(value)
    return otherwise if found is None else found[0]
