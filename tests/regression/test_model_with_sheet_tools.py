# SPDX-License-Identifier: Apache-2.0
"""A Model of a shell between tools in space, made in Python: history of its tools, resumed to the same bits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import run_model
from presswork.fingerprint import fingerprint
from presswork.geometry.swept_tool import draw_hemispherical_punch
from presswork.mesh.shells import mesh_shell_rectangle
from presswork.model import (
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
from presswork.recorder import Progress

DEEP = 0.4


def make_model() -> Model:
    """Return a quarter of a clamped square plate under a ball."""
    lines = np.linspace(0.0, 10.0, 5)
    thickness = 0.5
    mesh = mesh_shell_rectangle(lines, lines, element="shell4_mitc", section=Section(thickness))
    clamped = (True,) * 6
    return Model(
        title="plate under a ball",
        analysis="shell",
        depth=1.0,
        mesh=mesh,
        materials=(Material("steel", 210000.0, 0.3, Hardening("linear", np.array([250.0, 1000.0]))),),
        supports=(
            Support("left", (True, False, False, False, True, True)),
            Support("bottom", (False, True, False, True, False, True)),
            Support("right", clamped),
            Support("top", clamped),
        ),
        stages=(Stage("press", tool_motion={"ball": ToolMotion((0.0, 0.0, -DEEP))}),),
        solver=SolverSettings(symmetric=False, initial_increment=0.1, max_increment=0.2),
        output=OutputSettings(steps=2, checkpoint_every=1),
        tools=(Tool("ball", draw_hemispherical_punch(5.0, 10.0), (0.0, 0.0, 0.5 * thickness)),),
    )


def test_fingerprint_is_one_of_data() -> None:
    """The same tools made anew are the same; another radius is not."""
    assert fingerprint(make_model()) == fingerprint(make_model())


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    outcome = run_model(make_model(), tmp_path_factory.mktemp("plate") / "whole")
    assert outcome.status == "completed"
    return outcome.folder


def test_history_has_stroke_and_force_of_the_tool(whole: Path) -> None:
    from presswork import Result

    history = Result(whole).history
    assert history["ball.stroke"][-1] == pytest.approx(DEEP)
    assert (np.diff(history["ball.force"]) > 0).all(), "a plate that stretches bears more and more"
    np.testing.assert_allclose(history["ball.force"], history["ball.force_z"], rtol=1e-12)


def test_resumed_run_gives_the_same_bits(whole: Path, tmp_path: Path) -> None:
    def interrupt(progress: Progress) -> None:
        if progress.fraction > 0.2:
            raise KeyboardInterrupt

    folder = tmp_path / "resumed"
    assert run_model(make_model(), folder, on_increment=interrupt).status == "interrupted"
    assert run_model(make_model(), folder, resume=True).status == "completed"
    assert (folder / "history.csv").read_bytes() == (whole / "history.csv").read_bytes()
