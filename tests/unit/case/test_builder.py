# SPDX-License-Identifier: Apache-2.0
"""From a case to the Model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from presswork import Case, model
from presswork.case import build_model, describe, read_case
from presswork.examples import copy_example

WriteCase = Callable[..., Path]
PLANE_STRAIN = ('analysis = "axisymmetric"', 'analysis = "plane_strain"\ndepth = 5')


def build(path: Path, *overrides: str) -> model.Model:
    return build_model(read_case(path, overrides))


def test_model_holds_what_the_case_says(write_case: WriteCase) -> None:
    built = build(write_case())
    assert built.analysis == "axisymmetric"
    assert built.depth == 1.0
    assert built.mesh.blocks[0].element == "tri3"
    assert len(built.mesh.blocks[0].connectivity) == 24
    assert built.materials[0].young == pytest.approx(200e3)
    assert built.materials[0].hardening.law == "linear"
    np.testing.assert_allclose(built.materials[0].hardening.parameters, [700.0, 300.0])
    assert built.supports == (
        model.Support("left", (True, False), "axis"),
        model.Support("bottom", (False, True), "middle_plane"),
    )
    assert built.stages[0].tool_motion["punch"].move[1] <= -9.0, "60 % of 15 mm at least"
    assert built.solver == model.SolverSettings()
    assert built.output == model.OutputSettings()
    assert built.case_text.startswith('\ntitle = "A small upsetting"')


def test_loads_and_displacements_reach_the_model(write_case: WriteCase) -> None:
    loads = """
[[stages.displacement]]
set = "top"
component = "y"
value = "-1 cm"
[[stages.force]]
set = "top_right"
value = ["1 kN", 0]
[[stages.pressure]]
set = "right"
value = "1 GPa"
[stages.tools.punch]"""
    stage = build(write_case(("[stages.tools.punch]", loads))).stages[0]
    assert stage.prescribed == (model.PrescribedDisplacement("top", 1, -10.0),)
    assert stage.forces == (model.PointForce("top_right", (1000.0, 0.0)),)
    assert stage.pressures == (model.Pressure("right", 1000.0),)


def test_a_stage_may_only_take_a_load_off(write_case: WriteCase) -> None:
    load = '[[stages.pressure]]\nset = "right"\nvalue = 1\n[[stages]]\nname = "off"\n'
    path = write_case(("[stages.tools.punch]\nstroke = 9.0\ndirection = [0, -1]", load))
    assert [stage.name for stage in build(path).stages] == ["upset", "off"]


@pytest.mark.parametrize(
    ("law", "parameters"),
    [
        ('law = "swift"\nK = 500\ne0 = 0.01\nn = 0.2', [500, 0.01, 0.2]),
        ('law = "ludwik"\nyield_stress = 300\nK = 500\nn = 0.2', [300, 500, 0.2]),
        ('law = "voce"\nyield_stress = 300\nsaturation_stress = 500\nrate = 5', [300, 500, 5]),
        (
            'law = "hockett_sherby"\nyield_stress = 300\nsaturation_stress = 500\nrate = 5\nexponent = 0.7',
            [300, 500, 5, 0.7],
        ),
        ('law = "table"\npoints = [[0, 300], [0.1, "0.4 GPa"]]', [0, 300, 0.1, 400]),
        ('law = "table"\nsoftening = true\npoints = [[0, 300], [0.1, 290]]', [0, 300, 0.1, 290]),
        ('law = "monotone_table"\npoints = [[0, 300], [0.1, 400]]', [0, 300, 1000, 0.1, 400, 1000]),
        (
            'law = "swift_voce"\nvoce_share = 0.4\nK = 500\ne0 = 0.01\nn = 0.2\nyield_stress = 300\n'
            "saturation_stress = 500\nrate = 5",
            [0.4, 500, 0.01, 0.2, 300, 500, 5],
        ),
    ],
)
def test_hardening_parameters_are_in_the_order_of_the_model(
    write_case: WriteCase, law: str, parameters: list[float]
) -> None:
    linear = 'law = "linear"\nyield_stress = 700\nmodulus = "0.3 kN/mm^2"'
    hardening = build(write_case((linear, law))).materials[0].hardening
    assert hardening.law == law.split('"')[1]
    np.testing.assert_allclose(hardening.parameters, parameters)


@pytest.mark.parametrize("profile", ["[[0, 15], [30, 15]]", "[[30, 15], [0, 15]]"])
def test_workpiece_is_left_of_the_tool_however_it_is_drawn(write_case: WriteCase, profile: str) -> None:
    tool = build(write_case(("[[0, 15], [30, 15]]", profile))).tools[0]
    np.testing.assert_allclose(tool.profile.segments, [[30, 15, 0, 15, 0, 0, 0]])


def test_free_side_is_honoured(write_case: WriteCase) -> None:
    change = ('contact = "sticking"', 'contact = "sticking"\nfree_side = "right"')
    assert build(write_case(change)).tools[0].profile.segments[0, 0] == 30.0


def test_tool_reaching_a_symmetry_plane_is_mirrored_in_plane_strain(write_case: WriteCase) -> None:
    assert build(write_case(PLANE_STRAIN)).tools[0].mirrored_across == (True, False)
    assert build(write_case()).tools[0].mirrored_across == (False, False)


@pytest.mark.parametrize(
    ("override", "mirrored"),
    [
        ("boundary.axis.symmetry=false", (False, False)),
        ('boundary.axis.fix=["x", "y"]', (False, False)),
        ('tools.punch.mirrored=["x", "y"]', (True, True)),
        ("tools.punch.profile=[[1, 15], [30, 15]]", (False, False)),
        ("boundary.axis.set=all", (False, False)),
    ],
)
def test_mirroring_follows_the_planes_and_the_profile(
    write_case: WriteCase, override: str, mirrored: tuple[bool, bool]
) -> None:
    built = build(write_case(PLANE_STRAIN), override, "stages.0.tools.punch.stroke=4")
    assert built.tools[0].mirrored_across == mirrored


def test_zones_replace_size_and_cells(write_case: WriteCase) -> None:
    change = ("size = [10, 15]\ncells = [2, 3]", "zones_x = [[10, 2, 1]]\nzones_y = [[5, 5, 1], {length=10, cells=2}]")
    built = build(write_case(change))
    np.testing.assert_allclose(built.mesh.points[built.mesh.node_sets["left"], 1], [0, 1, 2, 3, 4, 5, 10, 15])


def test_description_says_the_model_in_words(write_case: WriteCase) -> None:
    text = describe(build(write_case(), "solver.newton=modified"))
    for fragment in (
        "analysis: axisymmetric",
        "24 tri3",
        "nodes: 18, freedoms: 36",
        "linear hardening: 700 + 300 e MPa",
        "tool punch: 1 line from (30, 15) to (0, 15), x 0 to 30 mm, y 15 to 15 mm, sticking",
        "support: x held on left (4 nodes)",
        "tool punch moves by (0, -9) mm",
        "solver: newton = modified",
        "MB",
    ):
        assert fragment in text


@pytest.mark.parametrize(
    ("name", "n_cells", "element"),
    [
        ("upsetting_4cst", 900, "tri3"),
        ("upsetting_t6_7pt", 200, "tri6_7pt"),
        ("upsetting_t6_6pt", 200, "tri6_6pt"),
        ("upsetting_q8_2x2", 100, "quad8_2x2"),
        ("upsetting_q4", 225, "quad4_fbar"),
    ],
)
def test_upsetting_examples_have_the_meshes_of_the_thesis(
    tmp_path: Path, name: str, n_cells: int, element: str
) -> None:
    built = build(copy_example(name, tmp_path))
    assert len(built.mesh.blocks[0].connectivity) == n_cells
    assert built.mesh.blocks[0].element == element
    assert built.stages[0].tool_motion["punch"].move[1] <= -9.0, "60 % of 15 mm at least"


@pytest.mark.parametrize("free_side", ["auto", "left", "right"])
def test_friction_goes_with_its_piece_whichever_way_the_profile_runs(write_case: WriteCase, free_side: str) -> None:
    profile = "[[30, 15], {to = [5, 15], m = 0.3}, {to = [0, 15]}]"
    if free_side == "right":
        profile = "[[0, 15], {to = [5, 15]}, {to = [30, 15], m = 0.3}]"
    change = ('contact = "sticking"', f'contact = "shear"\nm = 0.1\nfree_side = "{free_side}"')
    tool = build(write_case(("[[0, 15], [30, 15]]", profile), change)).tools[0]
    np.testing.assert_allclose(tool.profile.segments[:, [0, 2]], [[30, 5], [5, 0]])
    np.testing.assert_array_equal(tool.friction.m, [0.3, 0.1])
    np.testing.assert_array_equal(tool.friction.mu, [0.0, 0.0])


def test_a_fillet_has_the_friction_of_its_point(write_case: WriteCase) -> None:
    profile = "[[0, 15], {to = [20, 15], radius = 2, m = 0.3}, [20, 30]]"
    change = ('contact = "sticking"', 'contact = "shear"\nm = 0.1')
    tool = build(write_case(("[[0, 15], [30, 15]]", profile), change)).tools[0]
    assert sorted(zip(tool.profile.segments[:, 6] != 0, tool.friction.m, strict=True)) == [
        (False, 0.1),
        (False, 0.3),
        (True, 0.3),
    ]
    assert "m = 0.1 and 0.3" in describe(build(write_case(("[[0, 15], [30, 15]]", profile), change)))


def test_a_smooth_profile_is_directed_and_mirrored_like_any_other(write_case: WriteCase) -> None:
    points = [[x, 15 + 0.01 * x * x] for x in range(0, 32, 3)]
    for profile in (points, points[::-1]):
        change = ("profile = [[0, 15], [30, 15]]", f'curve = "spline"\nprofile = {profile}')
        tool = build(write_case(PLANE_STRAIN, change)).tools[0]
        assert tool.profile.segments[:, 6].all()
        assert tool.profile.segments[0, 0] > tool.profile.segments[-1, 2], "the workpiece below is on the left"
        assert tool.mirrored_across == (True, False)


def test_a_tool_that_only_withdraws_is_told_in_the_log(write_case: WriteCase, caplog: pytest.LogCaptureFixture) -> None:
    guard = '[tools.guard]\nprofile = [[20, 0], [20, 30]]\ncontact = "frictionless"\n\n[boundary.axis]'
    motion = "[stages.tools.guard]\nmove = [5, 0]\n[stages.tools.punch]"
    build(write_case(("[boundary.axis]", guard), ("[stages.tools.punch]", motion)))
    assert "tools.guard: the tool moves, but never comes nearer" in caplog.text


def test_copying_an_example_refuses_to_overwrite_and_unknown_names(tmp_path: Path) -> None:
    copy_example("heading", tmp_path)
    with pytest.raises(Exception, match="is there already"):
        copy_example("heading", tmp_path)
    with pytest.raises(Exception, match="did you mean `heading`"):
        copy_example("headng", tmp_path)


def test_an_example_with_a_mesh_file_brings_it_along(tmp_path: Path) -> None:
    case_file = copy_example("extrusion_cone", tmp_path)
    assert (tmp_path / "extrusion_cone.inp").exists()
    assert build(case_file).mesh.blocks[0].element == "quad4_fbar"
    case_file.unlink()
    with pytest.raises(Exception, match=r"extrusion_cone.inp is there already"):
        copy_example("extrusion_cone", tmp_path)
    assert not case_file.exists()


def test_without_an_element_quad4_fbar_is_taken_and_check_names_it() -> None:
    """The default (docs/verification/neck_of_a_bar.md)."""
    steel = {"young": 210e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 100}}
    case = Case.model_validate({
        "title": "block", "analysis": "plane_strain", "materials": {"steel": steel},
        "workpiece": {"material": "steel", "mesh": {"size": [2, 1], "cells": [2, 1]}},
        "boundary": {"foot": {"set": "bottom", "fix": ["x", "y"]}},
        "stages": [{"name": "pull", "displacement": [{"set": "top", "component": "y", "value": 0.1}]}],
    })  # fmt: skip
    problem = build_model(case)
    assert [block.element for block in problem.mesh.blocks] == ["quad4_fbar"]
    assert "elements: 2 quad4_fbar" in describe(problem)
