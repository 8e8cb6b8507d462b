# SPDX-License-Identifier: Apache-2.0
"""Shells on tools in space, implicit: the plate under a small ball, the rope round a drum."""

import numpy as np
import pytest

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.geometry.swept_tool import draw_hemispherical_punch, draw_punch
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.supports import NotHeldError
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import (
    EdgeForce,
    Friction,
    Hardening,
    Material,
    Mesh,
    Model,
    OutputSettings,
    PrescribedDisplacement,
    SolverSettings,
    Stage,
    Support,
    Tool,
    ToolMotion,
)
from presswork.process.implicit.stamping import make_shell_model
from tests.problems.shells import CLAMPED, RX, RZ, X, Y, fixing, patch, symmetry

YOUNG = 210000.0


def sheet_model(
    mesh: Mesh, supports: tuple[Support, ...], stages: tuple[Stage, ...], tools: tuple[Tool, ...], poisson: float
) -> Model:
    elastic = Material("elastic", YOUNG, poisson, Hardening("linear", np.array([1e9, 0.0])))
    return Model(
        title="sheet on tools",
        analysis="shell",
        mesh=mesh,
        materials=(elastic,),
        supports=supports,
        stages=stages,
        solver=SolverSettings(symmetric=False, initial_increment=0.1, max_increment=0.25, force_tolerance=1e-6),
        output=OutputSettings(steps=1),
        tools=tools,
    )


def run(model: Model) -> tuple[ImplicitProcedure, int]:
    """Return the procedure at its end, and the mean number of iterations."""
    procedure = ImplicitProcedure(model, threads=1)
    logs = [report.log for report in procedure.advance()]
    return procedure, int(np.ceil(np.mean([len(log) for log in logs])))


def test_clamped_square_plate_under_a_small_ball_bends_as_under_a_point_force() -> None:
    """w = 0.00560 F a^2 / D in the middle (Timoshenko & Woinowsky-Krieger 1959, table 37)."""
    side, thickness, poisson, deep = 100.0, 1.0, 0.3, 0.02
    lines = np.linspace(0.0, 0.5 * side, 17)
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), lines, lines, thickness=thickness)
    supports = (
        Support("left", symmetry(0)),
        Support("bottom", symmetry(1)),
        Support("right", CLAMPED),
        Support("top", CLAMPED),
    )
    ball = Tool("ball", draw_hemispherical_punch(5.0, 10.0), position=(0.0, 0.0, 0.5 * thickness))
    stages = (Stage("press", tool_motion={"ball": ToolMotion((0.0, 0.0, -deep))}),)
    procedure, _ = run(sheet_model(mesh, supports, stages, (ball,), poisson))
    middle = np.argmin(np.linalg.norm(mesh.points, axis=1))
    force = 4.0 * procedure.interactions.space_tools.contact.tool_forces(procedure.state)[0]
    stiffness = YOUNG * thickness**3 / (12.0 * (1.0 - poisson**2)) / (0.00560 * side**2)
    assert force[2] > 0.0
    assert force[2] == pytest.approx(stiffness * -procedure.state.nodes.displacement[middle, 2], rel=0.01)


RADIUS, THICK, WIDTH, HOLD = 20.0, 0.2, 2.0, 100.0


def drum(mu: float, cells: int = 45) -> Model:
    """A strip round a quarter of a drum: held back by a force that pulls upwards at its upper end, drawn on along x
    at its lower end."""
    middle = RADIUS + 0.5 * THICK

    def place(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.column_stack([-middle * np.cos(u), v, RADIUS - middle * np.sin(u)])

    def normal(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.column_stack([-np.cos(u), 0 * v, -np.sin(u)])

    mesh = patch(
        place, np.linspace(0.0, 0.5 * np.pi, cells + 1), np.array([0.0, WIDTH]), thickness=THICK, normal=normal
    )
    supports = (Support("all", fixing(Y, RX, RZ)), Support("right", fixing(X)))
    shape = draw_punch((RADIUS, np.inf), 0.0, RADIUS, 30.0)
    back = EdgeForce("left", (0.0, 0.0, HOLD / WIDTH))
    stages = (
        Stage("tighten", edge_forces=(back,)),
        Stage("draw", edge_forces=(back,), prescribed=(PrescribedDisplacement("right", 0, 0.15),)),
    )
    return sheet_model(mesh, supports, stages, (Tool("drum", shape, friction=Friction(mu=mu)),), 0.0)


@pytest.mark.parametrize("mu", [0.0, 0.1, 0.3])
def test_rope_round_a_drum_obeys_euler_and_eytelwein(mu: float) -> None:
    """T2 / T1 = exp(mu pi / 2)."""
    model = drum(mu)
    procedure, iterations = run(model)
    state = procedure.state
    pull = float(state.nodes.reaction[model.mesh.node_sets["right"], 0].sum())
    assert pull == pytest.approx(HOLD * np.exp(mu * 0.5 * np.pi), rel=1e-3)
    on_drum = procedure.interactions.space_tools.contact.tool_forces(state)[0]
    np.testing.assert_allclose(on_drum, [pull, 0.0, HOLD], rtol=1e-4, atol=1e-4 * HOLD)
    assert iterations <= 5


def test_work_of_tools_and_friction_balances() -> None:
    procedure, _ = run(drum(0.3))
    balance = procedure.energy_balance()
    assert balance["friction_work"] > 1.0
    assert abs(balance["error_percent"]) < 0.1


def test_a_resumed_run_gives_the_same_bits() -> None:
    """What contact must remember is in the State."""
    model = drum(0.3)
    whole = ImplicitProcedure(model, threads=1)
    kept = None
    for report in whole.advance():
        if report.number == 10:
            kept = {name: array.copy() for name, array in whole.state.to_arrays().items()}
    assert kept is not None
    resumed = ImplicitProcedure(model, threads=1)
    resumed.state.load_arrays(kept)
    for _ in resumed.advance():
        pass
    for name, array in whole.state.to_arrays().items():
        np.testing.assert_array_equal(resumed.state.to_arrays()[name], array, err_msg=name)


def test_sheet_that_nothing_holds_is_refused() -> None:
    """The tool holds it along z alone."""
    lines = np.linspace(0.0, 10.0, 3)
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), lines, lines)
    punch = Tool("punch", draw_punch((20.0, 20.0), 5.0, 3.0, 10.0), position=(0.0, 0.0, 0.5))
    stages = (Stage("press", tool_motion={"punch": ToolMotion((0.0, 0.0, -1.0))}),)
    with pytest.raises(NotHeldError, match="x and y"):
        ImplicitProcedure(sheet_model(mesh, (), stages, (punch,), 0.3), threads=1)


def test_a_holder_bears_its_force_however_loose_the_tolerance_of_nodal_forces_is(tmp_path) -> None:
    """1e-4 of the force or of the largest nodal force, in every increment; nodes may lack a hundred times as much."""
    keys = ['procedure="implicit"', "blank.element_size=8", "stages.0.tools.punch.stroke=1.5"]
    loose = ["implicit.force_tolerance=0.01", "implicit.displacement_tolerance=0.1"]
    model = make_shell_model(build_model(read_case(copy_example("square_cup", tmp_path), [*keys, *loose])))
    procedure = ImplicitProcedure(model, threads=1)
    number = [tool.name for tool in model.tools].index("holder")
    push = model.stages[0].tool_motion["holder"].push
    for report in procedure.advance():
        state = procedure.state
        asked = np.interp(report.fraction, *push.force.T)
        found = procedure.interactions.space_tools.contact.tool_forces(state)[number] @ push.direction
        largest = np.abs(state[SpaceToolArrays].force).max()
        assert abs(abs(found) - asked) <= 1.01e-4 * max(asked, largest)
