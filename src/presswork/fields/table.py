# SPDX-License-Identifier: Apache-2.0
"""The table of fields: what a run saves at an instant, and what is known of a field by its name.

Files, pictures, the extremes in summary.json, the columns of sweeps and the help of `presswork plot` ask it. A program
adds a field to the runs that it makes by a row: `FIELDS[row.name] = row`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

import numpy as np

from presswork.fields.field import PLACES, VECTOR, Field
from presswork.fields.instant import Instant
from presswork.fields.rows import ROWS
from presswork.model import FloatArray

FIELDS: dict[str, Field] = {row.name: row for row in ROWS}
"""Rows by name."""


def compute_fields(now: Instant) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Return the fields of the nodes and those of the cells by name, as far as the procedure has the quantities."""
    points: dict[str, FloatArray] = {}
    cells: dict[str, FloatArray] = {}
    for row in FIELDS.values():
        found = row.find(now)
        if found is None:
            continue
        to = points if row.kind == "point" else cells
        if isinstance(found, Mapping):
            to.update({row.name.format(what): values for what, values in found.items()})
        else:
            to[row.name] = found
    return points, cells


def compute_field(name: str, now: Instant) -> FloatArray | None:
    """Return one field at an instant; None where the procedure does not have it. Raises KeyError for unknown names."""
    row = find_row(name)
    if row is None:
        raise KeyError(name)
    found = row.find(now)
    return found.get(_stands_for(row, name)) if isinstance(found, Mapping) else found


def find_row(name: str) -> Field | None:
    """Return the row of a field by its name or alias; None for a field that the table does not know."""
    if name in FIELDS and not FIELDS[name].each:
        return FIELDS[name]
    return next((row for row in FIELDS.values() if name == row.alias or _stands_for(row, name)), None)


def find_unit(name: str) -> str:
    """Return the unit of a field; empty if it is not known.

    >>> find_unit("major_strain_top"), find_unit("contact_traction_punch")
    ('1', 'MPa')
    """
    row = find_row(name)
    return row.unit if row else ""


def describe_field(name: str) -> str:
    """Return a field's name in words.

    >>> describe_field("mises"), describe_field("stress_top_xx")
    ('effective stress', 'stress top xx')
    """
    row = find_row(name)
    if row is None:
        return name.replace("_", " ")
    return (row.label or row.name.replace("_", " ")).format((_stands_for(row, name) or "").replace("_", " "))


def split_components(name: str, values: FloatArray) -> dict[str, FloatArray]:
    """Return a field as scalars by name: itself, or its components (n,)."""
    if values.ndim == 1:
        return {name: values}
    row, count = find_row(name), values.shape[1]
    parts = row.components if row and len(row.components) == count else [str(i) for i in range(count)]
    return {f"{name}_{part}": values[:, i] for i, part in enumerate(parts)}


def to_scalar(name: str, values: FloatArray) -> FloatArray | None:
    """Return a field as one number per node or cell (n,): itself, or the length of a vector; None of a tensor."""
    if values.ndim == 1:
        return values
    row = find_row(name)
    if row.components == VECTOR if row else values.shape[1] <= len(VECTOR):
        return np.asarray(np.linalg.norm(values, axis=1), dtype=np.float64)
    return None


def find_aliases() -> dict[str, str]:
    """Return the names of fields by their aliases."""
    return {row.alias: row.name for row in FIELDS.values() if row.alias}


def list_fields() -> Iterator[str]:
    """Yield a line for nodes, cells and layers of a sheet each: names of their fields with units."""
    where = {"point": "At nodes", "cell": "In cells", "layer": f"In layers of a sheet (LAYER: {', '.join(PLACES)})"}
    for place, words in where.items():
        rows = [row for row in FIELDS.values() if row.place == place]
        names = [f"{row.name.format(row.each.upper())}{f' ({row.unit})' if row.unit else ''}" for row in rows]
        yield f"{words}: {', '.join(names)}."


def _stands_for(row: Field, name: str) -> str:
    """Return what `{}` stands for in a field's name; empty if the row is another field's."""
    if not row.each:
        return ""
    what = {"layer": f"({'|'.join(PLACES)})", "number": r"(\d+)", "tool": "(.+)"}[row.each]
    found = re.fullmatch(re.escape(row.name).replace(re.escape("{}"), what), name)
    return found.group(1) if found else ""
