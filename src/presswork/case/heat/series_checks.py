# SPDX-License-Identifier: Apache-2.0
"""What is checked of a series of parts before there is a mesh."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from presswork.case.errors import Problem

if TYPE_CHECKING:
    from presswork.case.plane.schema import Case


def check_series(case: Case) -> Iterator[Problem]:
    """Yield the problems of a series that show without the mesh."""
    if case.series is None:
        return
    if case.heat is None:
        remedy = "add [heat], or leave [series] out: without heat all parts are alike"
        yield Problem("series", "has no meaning without [heat]", remedy)
        return
    for name, tool in case.tools.items():
        if tool.heat is not None and tool.heat.warms_up:
            fault = "the steel behind nodes of the workpiece leaves with each part"
            yield Problem(f"tools.{name}.heat.warms_up", fault, "give the tool a mesh, or leave [series] out")
    if not any(tool.heat is not None and tool.heat.mesh is not None for tool in case.tools.values()):
        remedy = "give a tool a mesh: tools.NAME.heat.mesh = { size = 1, depth = 40 }"
        yield Problem("series", "no tool takes heat from part to part", remedy)
