# SPDX-License-Identifier: Apache-2.0
"""Ring compression to 50 % with each friction tangent: what the tangent must know of friction for Newton to converge.

The answer is the same whatever the tangent; the program prints the bore too, to show it.
"""

from __future__ import annotations

import argparse
import importlib.resources

from presswork.case import Case, build_model
from presswork.implicit.stepping import GaveUpError, ImplicitProcedure

TANGENTS = {"return_mapping": (20, 6), "bond": (60, 20), "residual": (60, 20)}
"""Tangent: iterations an increment may take, and below which increments grow."""


def press(m: float, tangent: str) -> tuple[str, str]:
    """Return "evaluations in increments", or where it gave up, and the bore at mid-height over the first one."""
    most, target = TANGENTS[tangent]
    case = importlib.resources.files("presswork.examples") / "ring_compression.toml"
    overrides = [f"tools.punch.m={m}", f"solver.friction_tangent={tangent}"]
    overrides += [f"solver.max_iterations={most}", f"solver.target_iterations={target}"]
    model = build_model(Case.from_toml(str(case), overrides=overrides))
    procedure = ImplicitProcedure(model, threads=1)
    evaluations = increments = 0
    try:
        for report in procedure.advance():
            increments += 1
            evaluations += len(report.log)
    except GaveUpError:
        return f"fails at {100 * (1 - procedure.remaining()):.0f} %", ""
    node = model.mesh.node_sets["bottom_left"][0]
    bore = 1 + procedure.state.nodes.displacement[node, 0] / model.mesh.points[node, 0]
    return f"{evaluations} in {increments}", f"{bore:.4f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--m", type=float, nargs="+", default=[0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 1.0])
    print("| m | " + " | ".join(TANGENTS) + " | bore |")
    for m in parser.parse_args().m:
        found = [press(m, tangent) for tangent in TANGENTS]
        bores = ", ".join(bore for _, bore in found if bore)
        print(f"| {m:g} | " + " | ".join(count for count, _ in found) + f" | {bores} |", flush=True)


if __name__ == "__main__":
    main()
