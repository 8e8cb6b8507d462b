# SPDX-License-Identifier: Apache-2.0
"""What derivatives cost: CPU time of a number and increment over that of an iteration, for 1, 4 and 10 numbers.

    python -m benchmarks.gradients [plane|space|plane_fine|space_fine]

An iteration is one matrix made, factorised and solved in the run without derivatives, with all that belongs to it.
Evaluations of cells and back-substitutions of a number and increment are counted, too; they do not depend on the
machine.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from time import process_time
from typing import Any

from presswork.case import build_model
from presswork.case.case_file import CaseFile
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.process.begin import begin
from tests.problems.differentiated import upset_block, upset_cylinder

HARDENING = "materials.steel.hardening"
KEYS = [
    f"{HARDENING}.K", "tools.punch.m", "stages.0.tools.punch.stroke", "workpiece.mesh.size.0",
    f"{HARDENING}.e0", f"{HARDENING}.n", "materials.steel.young", "materials.steel.poisson",
]  # fmt: skip
INCREMENTS = 6
NUMBERS = (1, 4, 10)


def upset_in_plane(cells: tuple[int, int] = (60, 90)) -> tuple[type[CaseFile], dict[str, Any], list[str]]:
    """Return a cylinder of quad4_fbar, and its numbers."""
    data = upset_cylinder(solver={"initial_increment": 0.1, "max_increment": 0.1})
    data["workpiece"]["mesh"]["cells"] = list(cells)
    data["stages"][0]["tools"]["punch"]["stroke"] = 3.0
    data["tools"]["punch"]["profile"] = [[-1, 15.01], [30, 15.01]]  # room for a tool that is lower or tilts
    return Case, data, [*KEYS, "tools.punch.profile.0.to.1", "tools.punch.profile.1.to.1"]


def upset_in_space(cells: int = 14) -> tuple[type[CaseFile], dict[str, Any], list[str]]:
    """Return a block of hex8_fbar with so many along each edge, and its numbers."""
    data = upset_block("hex8_fbar", {"contact": "shear", "m": 0.2})
    data["workpiece"]["mesh"]["cells"] = [cells] * 3
    data["tools"]["punch"]["position"] = [0, 0, 10.01]
    data["solver"] = {"initial_increment": 0.1, "max_increment": 0.1}
    return SpaceCase, data, [*KEYS, "workpiece.mesh.size.1", "tools.punch.position.2"]


CASES: dict[str, Callable[[], tuple[type[CaseFile], dict[str, Any], list[str]]]] = {
    "plane": upset_in_plane,
    "space": upset_in_space,
    "plane_fine": partial(upset_in_plane, (120, 180)),
    "space_fine": partial(upset_in_space, 21),
}


def measure(kind: type[CaseFile], data: dict[str, Any], keys: list[str]) -> tuple[float, int, int, int]:
    """Return CPU time [s], matrices, evaluations of cells and back-substitutions of the first increments."""
    asked = {"gradients": {"of": ["punch.force"], "by": keys}} if keys else {}
    recording: Any = begin(build_model(kind.model_validate({**data, **asked})), threads=1)
    procedure = (recording.run if keys else recording).procedure
    mechanics = type(procedure.mechanics)
    evaluate, evaluations = mechanics.evaluate, 0

    def counted(*given: Any, **named: Any) -> Any:
        nonlocal evaluations
        evaluations += 1
        return evaluate(*given, **named)

    assemble, matrices = mechanics.assemble_stiffness, 0

    def counted_too(*given: Any) -> None:
        nonlocal matrices
        matrices += 1
        assemble(*given)

    mechanics.evaluate, mechanics.assemble_stiffness = counted, counted_too
    started = process_time()
    for report in procedure.advance():
        recording.row(report)
        if report.number == INCREMENTS:
            break
    spent = process_time() - started
    mechanics.evaluate, mechanics.assemble_stiffness = evaluate, assemble
    rounds = recording.derivatives.rounds if keys else 0
    return spent, matrices, evaluations, rounds


def main() -> None:
    """Measure the cases that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="*", choices=[*CASES, []], default=[])
    for name in parser.parse_args().case or ("plane", "space"):
        kind, data, keys = CASES[name]()
        measure(kind, data, keys[:1])  # what is loaded and made at the first call
        alone, matrices, evaluations, _ = measure(kind, data, [])
        iteration = alone / matrices
        print(f"{name}: {1e3 * iteration:.1f} ms an iteration, {matrices / INCREMENTS:.1f} an increment")
        for count in NUMBERS:
            spent, _, more, rounds = measure(kind, data, keys[:count])
            each = count * INCREMENTS
            print(
                f"  {count:2d} numbers: {(spent - alone) / each / iteration:.2f} of an iteration each, "
                f"{(more - evaluations) / each:.1f} evaluations, {rounds / each:.1f} back-substitutions"
            )


if __name__ == "__main__":
    main()
