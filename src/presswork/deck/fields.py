# SPDX-License-Identifier: Apache-2.0
"""Fields of a row: of fixed width, or between commas; blanks are defaults, exponents may lack their letter."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence

import numpy as np

from presswork.model import FloatArray

Parameters = dict[str, str]
"""Values of parameters by name, lower case."""
_BARE_EXPONENT = re.compile(r"^([+-]?[0-9.]+)([+-][0-9]+)$")


class FieldError(ValueError):
    """A field that is no number."""


def read_fields(row: bytes, n: int, width: int) -> list[str]:
    """Return the first n fields of a row, as they stand; missing ones are empty."""
    text = row.decode("latin-1")
    return _split(text, [width] * n)


def to_number(text: str, parameters: Parameters) -> float:
    """Return the number of a field; an empty one is 0. Raises FieldError."""
    text = text.strip()
    sign = 1.0
    if "&" in text:
        if text.startswith("-"):
            sign, text = -1.0, text[1:]
        name = text.lstrip("&").strip().lower()
        if name not in parameters:
            raise FieldError(f"the parameter &{name} is not defined")
        text = parameters[name]
    if not text:
        return 0.0
    try:
        number = float(text)
    except ValueError:
        repaired = _BARE_EXPONENT.sub(r"\1e\2", text.replace("d", "e").replace("D", "e"))
        try:
            number = float(repaired)
        except ValueError:
            raise FieldError(f"`{text}` is not a number") from None
    if not math.isfinite(number):
        raise FieldError(f"`{text}` is not a finite number")
    return sign * number


def read_table(rows: Sequence[bytes], widths: Sequence[int], parameters: Parameters) -> FloatArray:
    """Return the fields of many rows of one form (n, len(widths)). Raises FieldError."""
    if not rows:
        return np.empty((0, len(widths)))
    if any(b"," in row for row in rows):
        return np.array([[to_number(t, parameters) for t in _split(row.decode("latin-1"), widths)] for row in rows])
    total = sum(widths)
    text = np.array(rows, dtype=f"S{total}").view("S1").reshape(len(rows), total)
    text = np.where(text == b"", b" ", text)
    table, begin = np.empty((len(rows), len(widths))), 0
    for column, width in enumerate(widths):
        field = np.ascontiguousarray(text[:, begin : begin + width]).view(f"S{width}")[:, 0]
        begin += width
        try:
            table[:, column] = field.astype(np.float64)
        except ValueError:
            table[:, column] = [to_number(each.decode("latin-1"), parameters) for each in field]
        if not np.isfinite(table[:, column]).all():
            bad = field[int(np.flatnonzero(~np.isfinite(table[:, column]))[0])].decode("latin-1").strip()
            raise FieldError(f"`{bad}` is not a finite number")
    return table


def _split(text: str, widths: Sequence[int]) -> list[str]:
    if "," in text:
        return (text.split(",") + [""] * len(widths))[: len(widths)]
    ends = np.cumsum([0, *widths])
    return [text[a:b] for a, b in itertools.pairwise(ends)]
