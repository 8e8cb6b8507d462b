# SPDX-License-Identifier: Apache-2.0
"""A shell from case file to results, pictures and checkpoint."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.recorder import run_model
from presswork.results import ResultError
from presswork.results.checkpoint import load_checkpoint
from presswork.view.all_plots import plot_all
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end


@pytest.fixture(scope="module")
def roof(tmp_path_factory) -> Result:
    folder = tmp_path_factory.mktemp("roof")
    model = build_model(read_case(copy_example("scordelis_lo_roof", folder)))
    return run_to_end(model, folder / "out")


def test_results_have_the_sheet_in_space(roof) -> None:
    assert roof.mesh.points.shape == (17 * 17, 3)
    assert roof.mesh.blocks[0].vtk_type == 9
    assert roof.field("thickness") == pytest.approx(0.25)
    assert roof.unit("thickness") == "mm"
    assert roof.unit("stress_top") == "MPa"


def test_a_hundredth_of_the_weight_gives_a_hundredth_of_the_linear_deflection(tmp_path) -> None:
    """0.3024 (Scordelis & Lo 1964), of which MITC4 reaches 0.989 on 16 x 16 cells; at full weight the roof stiffens."""
    case = read_case(copy_example("scordelis_lo_roof", tmp_path), ["stages.0.body_force=[{value=[0,0,-3.6]}]"])
    light = run_model(build_model(case), tmp_path / "light", threads=1).result
    edge = np.argmax(light.mesh.points[:, 0] + light.mesh.points[:, 1])
    assert light.field("displacement")[edge, 2] == pytest.approx(-0.01 * 0.3024 * 0.989, rel=5e-3)


def test_stress_of_top_and_bottom_differ_by_bending(roof) -> None:
    crown = np.argmin(np.abs(roof.mesh.points[roof.mesh.blocks[0].connectivity].mean(axis=1) - (25, 0, 0)).sum(axis=1))
    top, bottom = roof.field("stress_top_yy")[crown], roof.field("stress_bottom_yy")[crown]
    assert abs(top - bottom) > 1e5
    assert roof.field("strain_middle").shape == (256, 6)


def test_every_layer_has_stress_and_strain_in_both_frames(roof) -> None:
    """The lamina frame of the rolled sheet: x along the roof's axis, which is space's x; so xx is the same in both."""
    for place in ("bottom", "middle", "top"):
        for name, unit in (("stress", "MPa"), ("strain", "1")):
            lamina, space = roof.field(f"lamina_{name}_{place}"), roof.field(f"{name}_{place}")
            assert (lamina.shape, space.shape) == ((256, 3), (256, 6))
            assert roof.unit(f"lamina_{name}_{place}") == roof.unit(f"{name}_{place}") == unit
            np.testing.assert_allclose(lamina[:, 0], space[:, 0], atol=3e-3 * np.abs(space).max())  # it slopes a little
            # the trace and the norm of a tensor do not depend on the frame
            traces = lamina[:, :2].sum(axis=1), space[:, :3].sum(axis=1)
            rounding = np.finfo(np.float32).eps * np.abs(space).max()  # layers are saved in single precision
            np.testing.assert_allclose(*traces, atol=2 * rounding)
            size = np.sqrt(np.maximum(lamina[:, 0] ** 2 + lamina[:, 1] ** 2 + 2 * lamina[:, 2] ** 2, 0.0))
            also = np.sqrt((space[:, :3] ** 2).sum(axis=1) + 2 * (space[:, 3:] ** 2).sum(axis=1))
            np.testing.assert_allclose(size, also, rtol=0.02, atol=1e-9 * also.max())
        major, minor = (roof.field(f"{which}_strain_{place}") for which in ("major", "minor"))
        trace = roof.field(f"lamina_strain_{place}")[:, :2].sum(axis=1)
        np.testing.assert_allclose(major + minor, trace, atol=2 * np.finfo(np.float32).eps * np.abs(trace).max())
    assert roof.field("thickness_strain").shape == (256,)
    np.testing.assert_array_equal(roof.field("lamina_stress_top_xy"), roof.field("lamina_stress_top")[:, 2])


def test_pictures_are_drawn(roof, tmp_path) -> None:
    paths = plot_all(roof, tmp_path, fields=("effective_stress", "displacement"), mirror="xy")
    assert [p.name for p in paths] == ["shell_effective_stress_002.png", "shell_displacement_002.png"]
    assert all(p.stat().st_size > 10_000 for p in paths)
    names = {p.stem.removeprefix("shell_")[:-4] for p in plot_all(roof, tmp_path)}
    assert names == {"effective_stress", "major_strain_top", "minor_strain_top"}, "zero throughout is not drawn"
    with pytest.raises(ResultError, match="name one, for instance lamina_stress_top_xx"):
        plot_all(roof, tmp_path, fields=("lamina_stress_top",))
    plot_all(roof, tmp_path, fields=("lamina_stress_top_xx",))


def test_a_resumed_run_and_one_with_two_threads_give_the_same_bits(tmp_path: Path) -> None:
    override = ["workpiece.mesh.cells=[6,6]", "materials.concrete.hardening.yield_stress=100000"]
    model = build_model(read_case(copy_example("scordelis_lo_roof", tmp_path), override))
    whole = run_model(model, tmp_path / "whole", threads=1).result
    run_model(model, tmp_path / "two", threads=2)

    run_in_two_parts(model, tmp_path / "part", 1)
    assert whole.field("equivalent_plastic_strain").max() > 1e-4
    for other in ("two", "part"):
        assert_same_bits(tmp_path / other, whole.folder)


STRIP = """
title = "a strip bent, flattened and let go"
analysis = "shell"
[workpiece]
material = "sheet"
element = "shell4_mitc"
section = { thickness = 1.0, points = 7, rule = "lobatto" }
mesh = { size = [20, 4], cells = [6, 2] }
[materials.sheet]
library = "%s"
%s
[boundary.grip]
set = "left"
hold = "clamped"
[[stages]]
name = "bend"
duration = 0.1
rotation = [{ set = "right", axis = "y", angle = 40 }]
[[stages]]
name = "flatten"
duration = 0.1
rotation = [{ set = "right", axis = "y", angle = -40 }]
[[stages]]
name = "release"
duration = 1.0
[solver]
initial_increment = 0.25
max_increment = 0.25
[output]
steps = 1
checkpoint_every = 1
"""
CHABOCHE = """
kinematic = { law = "chaboche", C = [4000, 500], gamma = [20, 0] }
rate = { law = "cowper_symonds", D = 40, q = 5 }
young_decrease = { saturated = "160 GPa", rate = 60 }
"""
YOSHIDA_UEMORI = """
hardening = { law = "linear", yield_stress = 150 }
kinematic = { law = "yoshida_uemori", B = 300, C = 200, m = 12, b = 40, Rsat = 190, h = 0.4 }
"""


@pytest.mark.validation
@pytest.mark.parametrize(("sheet", "laws"), [("numisheet93_mild_steel", CHABOCHE), ("aa6016_t4", YOSHIDA_UEMORI)])
def test_back_stresses_and_rates_resume_to_the_same_bits(tmp_path: Path, sheet: str, laws: str) -> None:
    """Stopped in the second stage, whose answer hangs on the back stresses of the first."""
    (tmp_path / "strip.toml").write_text(STRIP % (sheet, laws), encoding="utf-8")
    model = build_model(read_case(tmp_path / "strip.toml"))
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"

    run_in_two_parts(model, tmp_path / "part", lambda progress: progress.text.startswith("flatten"))
    states = [load_checkpoint(tmp_path / name / "checkpoint.h5")[0] for name in ("whole", "part")]
    back = states[0]["cells.history.0"][..., 1:4]
    assert np.abs(back).max() > 5.0
    results = Result(tmp_path / "whole")
    assert np.abs(results.field("back_stress_top_xx")).max() > 5.0
    assert results.unit("back_stress_top") == "MPa"
    for name, values in states[0].items():
        np.testing.assert_array_equal(states[1][name], values, err_msg=name)
