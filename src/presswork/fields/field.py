# SPDX-License-Identifier: Apache-2.0
"""A field: one quantity of the results, with its name, unit, label and meaning."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from presswork.fields.instant import Instant
from presswork.model import FloatArray

VECTOR = ("x", "y", "z")
TENSOR = ("xx", "yy", "zz", "xy", "yz", "xz")
LAMINA = ("xx", "yy", "xy")
"""Components of a tensor in the plane of a sheet."""

PLACES = ("bottom", "middle", "top")
"""Layers of a sheet."""

Place = Literal["point", "cell", "layer"]


@dataclass(frozen=True)
class Field:
    """A row of the table of fields."""

    name: str
    """Name in files and commands; `{}` stands for what `each` counts."""
    unit: str
    """"1" for a pure number."""
    place: Place
    """Place of its values: at the nodes, in the cells, or in the bottom, middle and top layers of a sheet's cells."""
    find: Callable[[Instant], FloatArray | Mapping[str, FloatArray] | None]
    """Return the values at an instant, (n,) or (n, n_components), n nodes or cells; by layer, tool or number if there
    are several; None where the procedure has no such quantity."""
    each: Literal["", "layer", "tool", "number"] = ""
    """What a quantity with several fields has one field for."""
    components: tuple[str, ...] = ()
    """Names of the columns; none of a scalar."""
    label: str = ""
    """Label in pictures, with `{}` as in the name; the words of the name if empty."""
    alias: str = ""
    """A short name that commands and `Result.field` take too."""
    single: bool = False
    """Whether files keep it in single precision."""

    @property
    def kind(self) -> Literal["point", "cell"]:
        """Kind of data in files: point or cell."""
        return "point" if self.place == "point" else "cell"
