# SPDX-License-Identifier: Apache-2.0
"""A value of a tool that the case does not have: the name is reported, whatever the value is."""

from presswork.case.errors import Problem
from presswork.case.unknown_tools import name_unknown_tools

DATA = {"tools": {"die": {}, "punch": {}}}


def test_values_of_unknown_tools_become_one_problem_of_the_name() -> None:
    given = [
        Problem("remesh.tools.punsh", "expected a length", "write one", "x"),
        Problem("stages.0.tools.dye.stroke", "expected a length", "write one", "x"),
        Problem("stages.0.tools.dye.speed", "unknown key", "remove it", 1),
    ]
    found = name_unknown_tools(given, DATA)
    assert [(one.key, one.expected) for one in found] == [
        ("remesh.tools.punsh", "no such tool"),
        ("stages.0.tools.dye", "no such tool"),
    ]
    assert found[0].remedy.startswith("did you mean `punch`?")


def test_other_problems_stay_as_they_are() -> None:
    given = [
        Problem("stages.0.tools.die.stroke", "expected a length", "write one", "x"),
        Problem("stages.0.tools.die.stroke", "expected a list", "write one", "x"),
        Problem("workpiece", "missing key", "add it"),
    ]
    assert name_unknown_tools(given, DATA) == given
    assert name_unknown_tools(given, {"tools": 3}) == given
