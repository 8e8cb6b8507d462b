# SPDX-License-Identifier: Apache-2.0
"""Draw the square cup of Cheng (1995), figure 4.6, by the implicit procedure: a quarter of the blank, tools in space.

The geometry is that of the thesis's plots: punch 51 mm wide, corners 10 mm, edges 4 mm; die opening 54 mm, corners
11.5 mm, shoulders 4 mm. The holder stands at a fixed gap; friction 0.1 on all tools.

Usage: python examples/implicit_square_cup.py [cells along a side] [depth in mm]
"""

import sys
import time

import numpy as np

from presswork.body.shell_arrays import ShellArrays
from presswork.geometry.swept_tool import draw_die, draw_holder, draw_punch
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.shells import mesh_shell_rectangle
from presswork.model import (
    Friction,
    Hardening,
    Material,
    Model,
    OutputSettings,
    Section,
    SolverSettings,
    Stage,
    Support,
    Tool,
    ToolMotion,
)

THICKNESS, SIDE, HOLDER_GAP, FRICTION = 0.8, 100.0, 0.1, 0.1


def make_model(cells: int, depth: float) -> Model:
    """Return the quarter of the blank between its tools."""
    lines = np.linspace(0.0, 0.5 * SIDE, cells + 1)
    mesh = mesh_shell_rectangle(lines, lines, element="shell4_mitc", section=Section(THICKNESS))
    steel = Material("steel", 210000.0, 0.3, Hardening("swift", np.array([565.32, 0.007117, 0.2589])))
    half = 0.5 * THICKNESS
    drawn = {
        "punch": (draw_punch((25.5, 25.5), 10.0, 4.0, 60.0), half),
        "die": (draw_die((27.0, 27.0), 11.5, 4.0, width=80.0, depth=60.0), -half),
        "holder": (draw_holder((27.0, 27.0), 11.5, 0.0, width=80.0, height=10.0), half + HOLDER_GAP),
    }
    tools = tuple(Tool(name, shape, (0.0, 0.0, z), Friction(mu=FRICTION)) for name, (shape, z) in drawn.items())
    planes = (
        Support("left", (True, False, False, False, True, True)),
        Support("bottom", (False, True, False, True, False, True)),
    )
    return Model(
        title="square cup",
        analysis="shell",
        mesh=mesh,
        materials=(steel,),
        tools=tools,
        supports=planes,
        stages=(Stage("draw", tool_motion={"punch": ToolMotion((0.0, 0.0, -depth))}),),
        solver=SolverSettings(symmetric=False, initial_increment=0.027 / depth, max_iterations=25),
        output=OutputSettings(steps=1),
    )


def main() -> None:
    """Draw, and print the punch's force and the draw-in on the way."""
    cells = int(sys.argv[1]) if len(sys.argv) > 1 else 16
    depth = float(sys.argv[2]) if len(sys.argv) > 2 else 27.0
    model = make_model(cells, depth)
    procedure = ImplicitProcedure(model, threads=1)
    x, y = model.mesh.points[:, 0], model.mesh.points[:, 1]
    side, corner = int(np.argmax(x - y)), int(np.argmax(x + y))
    started, iterations, cutbacks = time.perf_counter(), 0, 0
    for report in procedure.advance():
        iterations += len(report.log)
        cutbacks += len(report.cutbacks)
        if report.number % 10 and not report.is_save_point:
            continue
        state = procedure.state
        force = 4e-3 * procedure.interactions.space_tools.contact.tool_forces(state)[:, 2]
        draw_in = -state.nodes.displacement[side, 0], np.hypot(*state.nodes.displacement[corner, :2])
        thickness = np.concatenate([t.ravel() for t in state[ShellArrays].thickness])
        print(
            f"{report.fraction * depth:6.2f} mm  punch {force[0]:6.2f} kN  holder {force[2]:6.2f} kN  draw-in "
            f"{draw_in[0]:5.2f} and {draw_in[1]:5.2f} mm  thickness {thickness.min():.3f} to {thickness.max():.3f} mm"
        )
    seconds = time.perf_counter() - started
    print(f"{report.number} increments, {iterations} iterations, {cutbacks} cut-backs, {seconds:.0f} s")


if __name__ == "__main__":
    main()
