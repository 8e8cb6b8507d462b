# SPDX-License-Identifier: Apache-2.0
"""Results as tables of pandas."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from presswork.results.reader import IN_PLANE, IN_PLANE_COMPONENTS, STRESS_COMPONENTS, Result, ResultError

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
        values = result.field(name, step)
        for title, column in (
            [(name, values)] if values.ndim == 1 else zip(_titles(name, values), values.T, strict=True)
        ):
            columns[title], units[title] = column, result.unit(name)
    table = pandas.DataFrame(columns)
    table.index.name = rows
    table.attrs["units"] = units
    return table


def _titles(name: str, values: np.ndarray) -> list[str]:
    """Return the names of a field's components, as Result.field takes those of stresses."""
    count = values.shape[1]
    of_plane = name.startswith(IN_PLANE) and count == len(IN_PLANE_COMPONENTS)
    known: dict[int, tuple[str, ...]] = {3: IN_PLANE_COMPONENTS if of_plane else ("x", "y", "z"), 6: STRESS_COMPONENTS}
    parts = known.get(count, tuple(str(i) for i in range(count)))
    return [f"{name}_{part}" for part in parts]
