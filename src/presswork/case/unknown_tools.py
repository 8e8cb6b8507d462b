# SPDX-License-Identifier: Apache-2.0
"""Values of tools that a case does not have: the name is what is wrong, whatever else is."""

from __future__ import annotations

import re
from collections.abc import Sequence

from presswork.case.errors import Problem, suggest

_OF_A_TOOL = re.compile(r"((?:.+\.)?(?:remesh|stages\.\d+)\.tools\.)([^.]+)")


def name_unknown_tools(problems: Sequence[Problem], data: object) -> list[Problem]:
    """Replace the problems inside the table of a tool that the case lacks by one of its name; return all problems.

    data: the whole case as read.
    """
    tools = data.get("tools") if isinstance(data, dict) and "operations" not in data else None
    if not isinstance(tools, dict):
        return list(problems)
    found: dict[str, Problem] = {}
    for problem in problems:
        match = _OF_A_TOOL.match(problem.key)
        if match and match[2] not in tools:
            key = match[1] + match[2]
            found.setdefault(key, Problem(key, "no such tool", suggest(match[2], tools, "tools")))
        else:
            found[f"{problem.key} {len(found)}"] = problem
    return list(found.values())
