# SPDX-License-Identifier: Apache-2.0
"""Loads from stage to stage, alike in every family: each goes linearly from its value at the beginning of a stage to
that given there, to zero where none is given.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.case.description import describe
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.loads import LoadArrays
from presswork.model import Model

TEXT = """
title = "a block that is pulled"
analysis = "{analysis}"
[workpiece]
material = "m"
{workpiece}
[materials.m]
young = 200000
poisson = 0.3
hardening = {{ law = "linear", yield_stress = 300, modulus = 100 }}
{boundary}
{stages}
[solver]
initial_increment = 0.25
max_increment = 0.25
force_tolerance = 1e-9
[output]
steps = 4
"""
PLANE = """
[boundary.base]
set = "bottom"
fix = ["y"]
[boundary.side]
set = "left"
fix = ["x"]
"""
SPACE = PLANE + '[boundary.depth]\nset = "back"\nfix = ["z"]\n'
SHELL = """
[boundary.base]
set = "bottom"
hold = "symmetry_y"
[boundary.side]
set = "left"
hold = "symmetry_x"
[boundary.level]
set = "bottom"
fix = ["z"]
"""
AREA = {"axisymmetric": np.pi, "plane_strain": 1.0, "solid": 1.0, "shell": 0.5}
"""Of the face that is pulled [mm2]."""
BODIES = {
    "axisymmetric": ("mesh = { size = [1, 1], cells = [1, 1] }", PLANE),
    "plane_strain": ("mesh = { size = [1, 1], cells = [1, 1] }", PLANE),
    "solid": ("mesh = { size = [1, 1, 1], cells = [1, 1, 1] }", SPACE),
    "shell": (
        "section = { thickness = 0.5, points = 2 }\nmesh = { size = [1, 1], cells = [2, 2] }\n"
        'element = "shell4_mitc_plus"',
        SHELL,
    ),
}


def pull(analysis: str, load: str, stress: float) -> str:
    """Return a line of a stage that pulls the face on top by a stress, as one kind of load."""
    zeros = ", 0" if analysis in ("solid", "shell") else ""
    by = {"edge_force": 0.5 if analysis == "shell" else 1.0, "force": AREA[analysis], "face_force": 1.0, "pressure": -1}
    value = f"{by[load] * stress}" if load == "pressure" else f"[0, {by[load] * stress}{zeros}]"
    return f'{load} = [{{ set = "top", value = {value} }}]'


def build(analysis: str, stages: list[str], folder: Path) -> Model:
    workpiece, boundary = BODIES[analysis]
    listed = "".join(f'[[stages]]\nname = "{number}"\n{stage}\n' for number, stage in enumerate(stages))
    path = folder / "case.toml"
    path.write_text(TEXT.format(analysis=analysis, workpiece=workpiece, boundary=boundary, stages=listed))
    return build_model(read_case(path))


def stresses(model: Model) -> np.ndarray:
    """Return the time in stages and the stress on the base [MPa] after every increment (n, 2)."""
    procedure, base = ImplicitProcedure(model, threads=1), model.mesh.node_sets["bottom"]
    found = []
    for report in procedure.advance():
        force = -float(procedure.state.nodes.reaction[base, 1].sum())
        found.append((int(report.stage) + report.fraction, force / AREA[model.analysis]))
    return np.array(found)


KINDS = [
    ("axisymmetric", "edge_force"), ("axisymmetric", "pressure"), ("plane_strain", "force"),
    ("plane_strain", "pressure"), ("plane_strain", "edge_force"), ("solid", "face_force"), ("solid", "pressure"),
    ("solid", "force"), ("shell", "edge_force"), ("shell", "force"),
]  # fmt: skip


@pytest.mark.parametrize(("analysis", "load"), KINDS)
def test_a_load_goes_linearly_from_where_it_is_to_the_value_given(analysis, load, tmp_path) -> None:
    """Kept, halved, not named, named again with the other sign: stresses are those of the load, after every increment.

    A pressure acts on the area as it is: 2 MPa widen or narrow it by 1e-5.
    """
    values = [2.0, 2.0, 1.0, 0.0, -2.0]
    stages = [pull(analysis, load, value) if value else "" for value in values]
    time, found = stresses(build(analysis, stages, tmp_path)).T
    assert len(time) >= 20
    np.testing.assert_allclose(found, np.interp(time, range(6), [0.0, *values]), atol=5e-5)


@pytest.mark.parametrize("analysis", BODIES)
def test_what_a_stage_no_longer_holds_is_released_linearly(analysis, tmp_path) -> None:
    """Of the stress of a face that is moved, half is left in the middle of the next stage, nothing at its end."""
    move = 'displacement = [{ set = "top", component = "y", value = 1e-5 }]'
    time, found = stresses(build(analysis, [move, ""], tmp_path)).T
    held = found[time == 1.0]
    assert held > 1.7
    np.testing.assert_allclose(found[time > 1.0], held * (2.0 - time[time > 1.0]), atol=5e-5)


def test_a_pressure_that_stays_follows_the_sheet(tmp_path) -> None:
    """A cantilever under a pressure that stays: its second stage changes nothing, however far the sheet has turned."""
    section = 'element = "shell4_mitc_plus"\nsection = { thickness = 0.1, points = 2 }\n'
    long = section + "mesh = { size = [10, 1], cells = [8, 1] }"
    stages = "".join(f'[[stages]]\nname = "{n}"\npressure = [{{ set = "all", value = 0.05 }}]\n' for n in (1, 2))
    clamped = '[boundary.base]\nset = "left"\nhold = "clamped"\n'
    path = tmp_path / "case.toml"
    text = TEXT.format(analysis="shell", workpiece=long, boundary=clamped, stages=stages)
    path.write_text(text.replace("1e-9", "1e-6").replace("yield_stress = 300", "yield_stress = 9000"))
    procedure = ImplicitProcedure(build_model(read_case(path)), threads=1)
    moved = {r.stage: procedure.state.nodes.displacement.copy() for r in procedure.advance()}
    assert np.abs(moved["1"][:, 2]).max() > 2.0
    np.testing.assert_allclose(moved["2"], moved["1"], atol=5e-5)


def test_check_says_from_which_value_to_which_loads_go(tmp_path) -> None:
    pulled = pull("axisymmetric", "edge_force", 200.0)
    moved = 'displacement = [{ set = "right", component = "x", value = 0.1 }]'
    text = describe(build("axisymmetric", [f"{pulled}\n{moved}", pulled, ""], tmp_path))
    first, second, third = (part.split("solver:")[0] for part in text.split("\nstage ")[1:])
    assert "force along top: 0 to (0, 200) MPa" in first
    assert "force along top: stays (0, 200) MPa" in second
    assert "right is no longer held, x: its force goes to zero over the stage" in second
    assert "force along top: (0, 200) to 0 MPa" in third


def test_loads_go_on_where_a_stopped_run_is_resumed(tmp_path) -> None:
    """A state taken in the middle of a stage has all that its loads go on from."""
    model = build("solid", [pull("solid", "pressure", 2.0), pull("solid", "pressure", 1.0)], tmp_path)
    whole, parts = ImplicitProcedure(model, threads=1), ImplicitProcedure(model, threads=1)
    states: list[dict[str, Any]] = [whole.state.to_arrays() for _ in whole.advance()]
    parts.state.load_arrays(states[5])
    resumed = [parts.state.to_arrays() for _ in parts.advance()]
    assert parts.state[LoadArrays].shares.tolist() == [1.0, 0.0]
    for name, values in states[-1].items():
        np.testing.assert_array_equal(resumed[-1][name], values)
