# SPDX-License-Identifier: Apache-2.0
"""Data from which Yld2000-2d is identified, as a file holds them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.material.yld2000_fit import YieldData
from presswork.case.table_file import read_table_lines

COLUMNS = ("angle", "stress", "r")
BIAXIAL = "biaxial"
"""Stands for the angle in the line of the balanced biaxial test."""


def read_yield_data(path: Path) -> YieldData:
    """Read a CSV with columns angle [degrees], stress and r; the line `biaxial` has stress and r of that test.

    An empty cell was not measured. Raises CaseError with every fault, by line.
    """
    lines = read_table_lines(path, least=2)
    head = [name.strip() for name in lines[0][1]]
    if "angle" not in head or not {"stress", "r"} & set(head):
        near = suggest("angle", head, "columns")
        raise CaseError([Problem("", "no columns of yield data", f"name them {', '.join(COLUMNS)}; {near}")], path)
    problems: list[Problem] = []
    rows: list[list[float]] = []
    biaxial = [np.nan, np.nan]
    for number, cells in lines[1:]:
        texts = [cells[head.index(name)].strip() if name in head and head.index(name) < len(cells) else ""
                 for name in COLUMNS]  # fmt: skip
        values = []
        for name, text in zip(COLUMNS, texts, strict=True):
            try:
                values.append(np.nan if text in ("", BIAXIAL) else float(text))
            except ValueError:
                problems.append(Problem(f"line {number}, {name}", "expected a number", "decimals with a point", text))
                values.append(np.nan)
        if texts[0] == BIAXIAL:
            biaxial = values[1:]
        elif not np.isfinite(values[0]):
            problems.append(Problem(f"line {number}, angle", f"expected degrees or `{BIAXIAL}`", "", texts[0]))
        else:
            rows.append(values)
    if problems:
        raise CaseError(problems, path)
    table = np.array(rows).reshape(-1, 3)
    return YieldData(table[:, 0], table[:, 1], table[:, 2], *biaxial)
