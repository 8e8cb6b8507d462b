# SPDX-License-Identifier: Apache-2.0
"""The table of elements, as the compiled core has it: there is no other list of their names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from presswork import _core
from presswork.model.cells import CELLS, Cell

ELEMENTS: dict[str, _core.Element] = {element.name: element for element in _core.elements()}
"""Every element by its name."""


def cell_of(element: str) -> Cell:
    """Return the kind of cell that an element lives on."""
    return CELLS[ELEMENTS[element].cell]


def list_names(
    family: _core.Family | None = None, *, in_implicit: bool = False, in_explicit: bool = False, cell: str | None = None
) -> tuple[str, ...]:
    """Return the names of the elements of a family that a procedure has, those that live on a kind of cell."""
    return tuple(
        name
        for name, element in ELEMENTS.items()
        if (family is None or element.family == family)
        and (element.in_implicit or not in_implicit)
        and (element.in_explicit or not in_explicit)
        and (cell is None or element.cell == cell)
    )


if TYPE_CHECKING:
    SolidElement = str
    SpaceElement = str
    HeatElement = str
    ShellElement = str
    ExplicitElement = str
    ElementName = str
else:
    SolidElement = Literal[list_names(_core.Family.plane, in_implicit=True)]
    SpaceElement = Literal[list_names(_core.Family.space)]
    HeatElement = Literal[
        list_names(_core.Family.plane, in_implicit=True) + list_names(_core.Family.space, in_implicit=True)
    ]
    ShellElement = Literal[list_names(_core.Family.shell, in_implicit=True)]
    ExplicitElement = Literal[
        tuple(n for n in list_names(_core.Family.shell, in_explicit=True) if ELEMENTS[n].cell == "quad4")
    ]
    ElementName = Literal[tuple(ELEMENTS)]
