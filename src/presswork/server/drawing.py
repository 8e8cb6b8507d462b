# SPDX-License-Identifier: Apache-2.0
"""Checks drafts of cases, and draws their start, in a process of its own: `python -m presswork.server.drawing`.

A request is a line of JSON on standard input, its answer one on standard output. No code of a case is run.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from presswork.case import CaseError, build_model, describe, read_case
from presswork.model import OneStepModel
from presswork.outcome import StartError
from presswork.recorder import write_start
from presswork.server.confined import confine


def check(case_file: Path, folder: Path) -> dict[str, Any]:
    """Return problems of a case file, or its description; the start is drawn into the folder, a run with one step."""
    try:
        model = build_model(read_case(case_file), run_user_code=False)
    except CaseError as error:
        problems = [{"key": p.key, "text": str(p), "expected": p.expected, "remedy": p.remedy} for p in error.problems]
        return {"problems": problems}
    found: dict[str, Any] = {"problems": [], "description": describe(model), "is_drawn": False}
    if isinstance(model, OneStepModel):
        return found
    if any(material.umat for material in model.materials):
        return {**found, "note": "Its materials are code, which is not run here: nothing is drawn."}
    try:
        write_start(model, folder)
    except StartError as error:
        return {**found, "problems": [{"key": "", "text": str(error), "expected": str(error), "remedy": ""}]}
    return {**found, "is_drawn": True}


def main() -> None:
    """Answer requests {case, folder} until the input ends; confined to the opened folder and that of drawings."""
    from presswork.process.implicit import forming  # noqa: F401  what the first check would wait for

    confine(Path(sys.argv[1]), Path(sys.argv[2]))
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = check(Path(request["case"]), Path(request["folder"]))
        except Exception as error:  # a fault of ours; the next draft may be well
            answer = {
                "problems": [{"key": "", "text": f"{type(error).__name__}: {error}", "expected": "", "remedy": ""}]
            }
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
