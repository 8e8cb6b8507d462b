# SPDX-License-Identifier: Apache-2.0
"""Results as tables of pandas."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from presswork.fields.table import split_components
from presswork.results.reader import Result, ResultError

if TYPE_CHECKING:
    import pandas


Rows = Literal["history", "point", "cell"]


def make_dataframe(result: Result, rows: Rows, step: int) -> pandas.DataFrame:
    """Return Result.to_dataframe's table."""
    try:
        import pandas
    except ImportError as error:
        raise ResultError('a table of pandas needs pandas: pip install "presswork[dataframe]"') from error
    if rows == "history":
        return pandas.DataFrame(result.history)
    if rows not in ("point", "cell"):
        raise ResultError(f'rows = "{rows}": choices are history, point and cell')
    columns, units = {}, {}
    points = result.points(step)
    if rows == "cell":
        points = np.concatenate([points[b.connectivity].mean(axis=1) for b in result.mesh_at(step).blocks])
    for axis, values in zip("xyz", points.T, strict=False):
        columns[axis], units[axis] = values, "mm"
    for name, kind in result.field_names.items():
        if kind != rows:
            continue
        for title, column in split_components(name, result.field(name, step)).items():
            columns[title], units[title] = column, result.unit(name)
    table = pandas.DataFrame(columns)
    table.index.name = rows
    table.attrs["units"] = units
    return table
