# SPDX-License-Identifier: Apache-2.0
"""Measured flow stress of strain, rate and temperature, from a table in a CSV file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from presswork.case.errors import CaseError
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.names import FileName
from presswork.case.table_file import read_table_lines
from presswork.case.units import fault
from presswork.model import FloatArray

COLUMNS = ("strain", "rate", "temperature", "stress")
UNITS = ("", " 1/s", " degrees C", " MPa")
EQUAL = 1e-9
"""Relative difference of values that are taken for the same strain, rate or temperature."""


class HotTable(HotLaw):
    """Measured flow stress: linear in strain, in the logarithm of the rate and in temperature, constant beyond."""

    law: Literal["hot_table"] = Field(
        default="hot_table", description="hot_table: a table of tests at strain rates and temperatures"
    )
    file: FileName = Field(
        description="CSV file beside the case with the columns strain, rate [1/s], temperature [degrees C] and "
        "stress [MPa], a row for each strain at each rate and temperature"
    )
    _parameters: list[float] = PrivateAttr(default=[])

    @model_validator(mode="before")
    @classmethod
    def _find_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Take the file's path from the folder of the case."""
        source = info.context.get("source") if isinstance(info.context, dict) else None
        if source and isinstance(data, dict) and isinstance(data.get("file"), str):
            return {**data, "file": str(Path(source).parent / data["file"])}
        return data

    @model_validator(mode="after")
    def _read(self) -> HotTable:
        self._parameters = read_hot_table(Path(self.file))
        return self

    def parameters(self) -> list[float]:
        """Return the parameters in the order of the compiled law."""
        return self._parameters


def read_hot_table(path: Path) -> list[float]:
    """Return numbers of strains, rates and temperatures, these themselves, then the flow stress, temperature first.

    Raises the error of a validator that names the line.
    """
    try:
        lines = read_table_lines(path, least=2)
    except CaseError as error:
        raise fault("; ".join(problem.expected for problem in error.problems), "check it", key="file") from None
    rows, numbers = _read_rows(path, lines)
    axes = [_distinct(rows[:, k]) for k in range(3)]
    stress = _fill(path, rows, numbers, axes)
    _check_order(path, stress, axes)
    return [*map(float, map(len, axes)), *(float(x) for axis in axes for x in axis), *map(float, stress.ravel())]


def _read_rows(path: Path, lines: list[tuple[int, list[str]]]) -> tuple[FloatArray, list[int]]:
    """Return the values by COLUMNS (n, 4) and the numbers of their lines."""
    head = [cell.strip() for cell in lines[0][1]]
    if sorted(head) != sorted(COLUMNS):
        raise fault(f"{path.name}: its first line is {', '.join(head)}", f"expected {', '.join(COLUMNS)}", key="file")
    order = [head.index(name) for name in COLUMNS]
    rows, numbers = [], []
    for number, cells in lines[1:]:
        try:
            row = [float(cells[k]) for k in order] if len(cells) == len(head) else []
        except ValueError:
            row = []
        if not row or not np.isfinite(row).all():
            remedy = f"expected four numbers: {', '.join(COLUMNS)}"
            raise fault(f"{path.name}, line {number}: {','.join(cells)}", remedy, key="file")
        strain, rate, _, stress = row
        for name, value, right in (
            ("strain", strain, strain >= 0),
            ("rate", rate, rate > 0),
            ("stress", stress, stress > 0),
        ):
            if not right:
                bound = ">= 0" if name == "strain" else "> 0"
                raise fault(f"{path.name}, line {number}: {name} = {value:g}", f"expected {name} {bound}", key="file")
        rows.append(row)
        numbers.append(number)
    return np.array(rows), numbers


def _distinct(values: FloatArray) -> FloatArray:
    """Return the distinct values in order."""
    ordered = np.unique(values)
    gaps = np.diff(ordered) > EQUAL * np.abs(ordered[1:])
    return np.asarray(ordered[np.concatenate([[True], gaps])])


def _fill(path: Path, rows: FloatArray, numbers: list[int], axes: list[FloatArray]) -> FloatArray:
    """Return the flow stress by strain, rate and temperature; refuse doubles and gaps."""
    places = [np.abs(rows[:, k, None] - axis).argmin(axis=1) for k, axis in enumerate(axes)]
    seen: dict[tuple[int, ...], int] = {}
    stress = np.full([len(axis) for axis in axes], np.nan)
    for number, row, *place in zip(numbers, rows, *places, strict=True):
        if tuple(place) in seen:
            raise fault(
                f"{path.name}, line {number}: the same strain, rate and temperature as in line {seen[tuple(place)]}",
                "leave one of them out",
                key="file",
            )
        seen[tuple(place)] = number
        stress[tuple(place)] = row[3]
    if np.isnan(stress).any():
        missing = np.argwhere(np.isnan(stress))
        first = _place(axes, missing[0])
        raise fault(
            f"{path.name}: {len(missing)} of {stress.size} combinations are missing, the first at {first}",
            "give every strain at every rate and temperature: bring the curves to common strains first",
            key="file",
        )
    return stress


def _check_order(path: Path, stress: FloatArray, axes: list[FloatArray]) -> None:
    """Refuse a flow stress that rises with temperature or falls with the rate: curves that cross."""
    for axis, sign, text in ((2, 1.0, "rises with temperature"), (1, -1.0, "falls as the rate rises")):
        wrong = np.argwhere(sign * np.diff(stress, axis=axis) > 0.0)
        if len(wrong):
            before = wrong[0]
            after = before + np.eye(3, dtype=int)[axis]
            raise fault(
                f"{path.name}: the flow stress {text}, from {stress[tuple(before)]:g} MPa at {_place(axes, before)} to "
                f"{stress[tuple(after)]:g} MPa at {_place(axes, after)}",
                "smooth the curves, or leave out the test that crosses the others",
                key="file",
            )


def _place(axes: list[FloatArray], at: Any) -> str:
    return ", ".join(f"{name} {axis[i]:g}{unit}" for name, unit, axis, i in zip(COLUMNS, UNITS, axes, at, strict=False))
