# SPDX-License-Identifier: Apache-2.0
"""Checks drafts of cases, and draws their start, in a process of its own: `python -m presswork.server.drawing`.

A request is a line of JSON on standard input, its answer one on standard output. No code of a case is run.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from presswork.case import CaseError, Problem, build_model, describe, read_case
from presswork.case.motion import find_planes, mark_ends, plan_motion
from presswork.model import Model, OneStepModel
from presswork.outcome import StartError
from presswork.recorder import write_start
from presswork.results import Result
from presswork.server.confined import confine
from presswork.server.estimated_part import EstimatedPart

MOTION = "motion.json"
"""The file beside the drawn start with the motion of the tools."""


def check(case_file: Path, folder: Path) -> dict[str, Any]:
    """Return problems of a case file, or its description; the start is drawn into the folder, a run with one step.

    A case whose tools clash or close too far is drawn, too: where they do is seen in their motion.
    """
    try:
        model = build_model(read_case(case_file), run_user_code=False)
    except CaseError as error:
        problems = [{"key": p.key, "text": str(p), "expected": p.expected, "remedy": p.remedy} for p in error.problems]
        return {"problems": problems, "is_drawn": _draw_anyway(case_file, folder, error.problems)}
    found: dict[str, Any] = {"problems": [], "description": describe(model), "is_drawn": False}
    if isinstance(model, OneStepModel):
        return found
    if any(material.umat for material in model.materials):
        return {**found, "note": "Its materials are code, which is not run here: nothing is drawn."}
    try:
        draw(model, folder)
    except StartError as error:
        return {**found, "problems": [{"key": "", "text": str(error), "expected": str(error), "remedy": ""}]}
    return {**found, "is_drawn": True}


def draw(model: Model, folder: Path, problems: Sequence[Problem] = ()) -> None:
    """Write the start and the motion of the tools into a folder. Raises StartError.

    problems: of tools in a stage, which are marked where the stage ends.
    """
    write_start(model, folder)
    result = Result(folder)
    part = EstimatedPart(model) if len(model.operations) > 1 else None
    moments = plan_motion(model, {name: points for name, (points, _) in result.surfaces.items()}, part)
    names = [*result.tools, *result.surfaces]
    motion = {
        "moments": [moment.to_data(names, model.dimension) for moment in mark_ends(moments, problems)],
        "symmetry": _find_symmetry(model),
    }
    (folder / MOTION).write_text(json.dumps(motion), encoding="utf-8")


def _find_symmetry(model: Model) -> str:
    """Return the planes x = 0 and y = 0 across which a section in the plane is mirrored, as "xy"."""
    if model.dimension != 2:
        return ""
    axes = {axis for axis, place, _ in find_planes(model) if place == 0.0}
    return "".join("xy"[axis] for axis in sorted(axes | ({0} if model.analysis == "axisymmetric" else set())))


def _draw_anyway(case_file: Path, folder: Path, problems: Sequence[Problem]) -> bool:
    """Draw a case that would not be run, if all that is wrong is how its tools move; return whether that was so."""
    try:
        model = build_model(read_case(case_file, ["limits.stop=false"]), run_user_code=False)
        if isinstance(model, OneStepModel) or any(material.umat for material in model.materials):
            return False
        draw(model, folder, problems)
    except (CaseError, StartError):
        return False
    return True


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
