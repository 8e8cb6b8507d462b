# SPDX-License-Identifier: Apache-2.0
"""The first guess of a sheet between tools."""

from itertools import pairwise

import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_hemispherical_punch
from presswork.implicit.first_guess import find_first_guess, keep_former
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import Hardening, Material, Model, OutputSettings, SolverSettings, Stage, Support, Tool, ToolMotion
from presswork.outcome import Step
from tests.problems.shells import CLAMPED, patch, symmetry


@pytest.fixture
def procedure() -> ImplicitProcedure:
    """A quarter of a clamped plate under a ball."""
    lines = np.linspace(0.0, 20.0, 9)
    return ImplicitProcedure(
        Model(
            title="plate",
            analysis="shell",
            mesh=patch(lambda u, v: np.column_stack([u, v, 0 * u]), lines, lines, thickness=1.0),
            materials=(Material("steel", 210000.0, 0.3, Hardening("linear", np.array([200.0, 500.0]))),),
            supports=(
                Support("left", symmetry(0)),
                Support("bottom", symmetry(1)),
                Support("right", CLAMPED),
                Support("top", CLAMPED),
            ),
            stages=(Stage("press", tool_motion={"ball": ToolMotion((0.0, 0.0, -2.0))}),),
            solver=SolverSettings(symmetric=False, initial_increment=0.02),
            output=OutputSettings(steps=1),
            tools=(Tool("ball", draw_hemispherical_punch(60.0, 80.0), position=(0.0, 0.0, 0.5)),),
        ),
        threads=1,
    )


def test_a_motion_of_constant_acceleration_is_continued_exactly(procedure) -> None:
    way = np.random.default_rng(1).normal(size=procedure.state.nodes.increment.shape)
    state, fixed = procedure.at_rest(), np.ones(way.shape, dtype=bool)
    times = [0.0, 0.01, 0.03, 0.06]
    for before, after in pairwise(times[:3]):
        trial = state.duplicate()
        keep_former(state, trial)
        trial.nodes.increment = way * (after**2 - before**2)
        trial[Progress].last_size = after - before
        state = trial
    guess = find_first_guess(state, state, times[3] - times[2], (), fixed)
    np.testing.assert_allclose(guess, way * (times[3] ** 2 - times[2] ** 2), rtol=1e-12)


def test_nodes_that_touched_go_with_the_tool_and_are_pushed_as_before(procedure) -> None:
    for report in procedure.advance():
        if report.fraction > 0.5:
            break
    state, tools = procedure.state, procedure.interactions.space_tools
    n, still = report.fraction, np.zeros_like(state.nodes.increment)
    trial = state.duplicate()
    tools.place(state, trial, Step(0, n, n + 0.01, report.number + 1, 0.0, 0.01, 0.0), 0.0)
    led = tools.lead(state, trial, still)
    ways = {"left": still, "led": led}
    found = {k: tools.contact.evaluate(state, trial, state.nodes.displacement + way).by_tool for k, way in ways.items()}
    force = state[SpaceToolArrays].force
    touched = np.linalg.norm(force[0], axis=1) > 0.0
    assert touched.sum() > 2
    np.testing.assert_allclose(led[touched, 2], -0.02, rtol=0.2)
    np.testing.assert_allclose(
        np.linalg.norm(found["led"][0, touched], axis=1), np.linalg.norm(force[0, touched], axis=1), rtol=0.02
    )
    assert np.linalg.norm(found["left"]) > 10.0 * np.linalg.norm(force)
