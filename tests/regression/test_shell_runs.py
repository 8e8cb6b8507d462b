# SPDX-License-Identifier: Apache-2.0
"""A shell from case file to results, pictures and checkpoint."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.run import run_model
from presswork.view.all_plots import plot_all


@pytest.fixture(scope="module")
def roof(tmp_path_factory) -> Result:
    folder = tmp_path_factory.mktemp("roof")
    model = build_model(read_case(copy_example("scordelis_lo_roof", folder)))
    outcome = run_model(model, folder / "out", threads=1)
    assert outcome.status == "completed"
    return outcome.result


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


def test_pictures_are_drawn(roof, tmp_path) -> None:
    paths = plot_all(roof, tmp_path, fields=("effective_stress", "displacement"), mirror="xy")
    assert [p.name for p in paths] == ["shell_effective_stress_002.png", "shell_displacement_002.png"]
    assert all(p.stat().st_size > 10_000 for p in paths)


def test_a_resumed_run_and_one_with_two_threads_give_the_same_bits(tmp_path: Path) -> None:
    override = ["workpiece.mesh.cells=[6,6]", "materials.concrete.hardening.yield_stress=100000"]
    model = build_model(read_case(copy_example("scordelis_lo_roof", tmp_path), override))
    whole = run_model(model, tmp_path / "whole", threads=1).result
    run_model(model, tmp_path / "two", threads=2)

    def stop(progress) -> None:
        raise KeyboardInterrupt

    assert run_model(model, tmp_path / "part", threads=1, on_increment=stop).status == "interrupted"
    run_model(model, tmp_path / "part", threads=1, resume=True)
    assert whole.field("equivalent_plastic_strain").max() > 1e-4
    for name in whole.field_names:
        for other in ("two", "part"):
            np.testing.assert_array_equal(Result(tmp_path / other).field(name), whole.field(name))
