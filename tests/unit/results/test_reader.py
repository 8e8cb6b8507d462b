# SPDX-License-Identifier: Apache-2.0
"""Result returns what was written, and says what there is when asked for what there is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.results import OutputError, Result, ResultError
from tests.unit.results.upset_output import make_fields, make_mesh, upset, write_upset_output


@pytest.fixture
def result(tmp_path: Path) -> Result:
    """Four steps of a mesh of three blocks."""
    return Result(write_upset_output(tmp_path, ("tri3", "quad4", "quad4_fbar"), n=6))


def test_mesh_is_the_one_written(result: Result) -> None:
    mesh = make_mesh(("tri3", "quad4", "quad4_fbar"), 6)
    np.testing.assert_array_equal(result.mesh.points, mesh.points)
    np.testing.assert_array_equal(result.mesh.boundary_edges, mesh.boundary_edges)
    assert [(b.element, b.vtk_type) for b in result.mesh.blocks] == [("tri3", 5), ("quad4", 9), ("quad4_fbar", 9)]
    for read, written in zip(result.mesh.blocks, mesh.blocks, strict=True):
        np.testing.assert_array_equal(read.connectivity, written.connectivity)


def test_fields_of_each_step_are_those_written(result: Result) -> None:
    mesh = make_mesh(("tri3", "quad4", "quad4_fbar"), 6)
    for step, stroke in enumerate(np.linspace(0.0, 9.0, 4)):
        for fields in make_fields(mesh, stroke):
            for name, values in fields.items():
                np.testing.assert_array_equal(result.field(name, step), values)
        np.testing.assert_allclose(result.points(step), mesh.points + upset(mesh.points, stroke)[:, :2])
    np.testing.assert_array_equal(result.field("eqps", -1), result.field("equivalent_plastic_strain", 3))
    np.testing.assert_array_equal(result.field("stress_zz"), result.field("stress")[:, 2])


def test_times_history_summary_and_info_are_those_written(result: Result) -> None:
    np.testing.assert_allclose(result.times, [0.0, 1 / 3, 2 / 3, 1.0])
    assert result.history["die.stroke"].tolist() == [0.0, 3.0, 6.0, 9.0]
    assert result.summary["status"] == "completed"
    assert result.info == {"title": "Upsetting of a billet", "analysis": "axisymmetric"}


def test_units_and_kinds_are_known(result: Result) -> None:
    assert [result.unit(name) for name in ("eqps", "stress_xx", "displacement")] == ["1", "MPa", "mm"]
    assert [result.kind(name) for name in ("eqps", "contact_pressure")] == ["cell", "point"]


def test_missing_folder_and_empty_folder_are_errors(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="no folder"):
        Result(tmp_path / "no")
    with pytest.raises(ResultError, match=r"no results\.vtkhdf"):
        Result(tmp_path)


def test_unknown_field_names_the_nearest(result: Result) -> None:
    with pytest.raises(ResultError, match=r"did you mean effective_stress\?.*hydrostatic_stress"):
        result.field("efective_stress")
    with pytest.raises(ResultError, match="no tool punch"):
        result.tool_displacement("punch")


@pytest.mark.parametrize("step", [4, -5])
def test_step_out_of_range_is_an_error(result: Result, step: int) -> None:
    with pytest.raises(ResultError, match="has 4 saved steps, 0 to 3"):
        result.field("eqps", step)


def test_run_without_summary_or_with_a_damaged_one(result: Result) -> None:
    (result.folder / "summary.json").write_text("{")
    with pytest.raises(ResultError, match="damaged"):
        _ = result.summary
    (result.folder / "summary.json").unlink()
    assert result.summary == {}


def test_a_field_whose_name_is_damaged_is_told(result: Result) -> None:
    path = result.folder / "results.vtkhdf"
    data = path.read_bytes()
    assert data.count(b"effective_stress\0") > 0
    path.write_bytes(data.replace(b"effective_stress\0", b"effective_stres\xff\0"))
    with pytest.raises(OutputError, match=r"damaged.*not text"):
        Result(result.folder).field("equivalent_plastic_strain")
