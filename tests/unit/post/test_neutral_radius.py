# SPDX-License-Identifier: Apache-2.0
"""Where the flow along a platen parts: made-up fields with a known answer, and rings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, Result, run
from presswork.examples import copy_example
from presswork.post import find_neutral_radius
from presswork.results import ResultError, append_step
from presswork.study import measure_ring
from tests.unit.results.upset_output import make_fields, make_mesh

PLATEN = np.array([[24.0, 15.0, -2.0, 15.0, 0.0, 0.0, 0.0]])


def write_flow(folder: Path, velocity: object, *, analysis: str = "axisymmetric", tools: int = 1) -> Result:
    """Write a run whose top, at 15 mm, moves along the radius by velocity(x) a step while the platen goes down."""
    mesh = make_mesh(n=8)
    x = mesh.points[:, 0]
    top = np.isclose(mesh.points[:, 1], 15.0)
    speed = np.asarray(velocity(x))
    for step in range(3):
        point_data, cell_data = make_fields(mesh, 0.0)
        point_data["displacement"] = np.column_stack([step * speed, -0.1 * step * mesh.points[:, 1] / 15.0, 0 * x])
        point_data["contact_pressure"] = np.where(top, 100.0, 0.0)
        point_data["contact_shear"] = np.where(top, -np.sign(speed) * 10.0, 0.0)
        names = ["platen", "other"][:tools]
        append_step(
            folder / "results.vtkhdf",
            mesh,
            float(step),
            point_data,
            cell_data,
            tools=dict.fromkeys(names, PLATEN),
            tool_displacement=dict.fromkeys(names, np.array([0.0, -0.1 * step])),
            info={"title": "flow", "analysis": analysis},
        )
    return Result(folder)


def test_it_lies_where_the_slip_changes_its_sign(tmp_path: Path) -> None:
    result = write_flow(tmp_path, lambda x: 1e-3 * (x - 6.1))
    found = find_neutral_radius(result, 1)
    assert found.by_slip == pytest.approx(6.1, abs=1e-2)
    assert found.stick_width == pytest.approx(2 * 0.02 * 6.1, rel=0.01), "2 % of the fastest slip, both ways"
    assert found.by_shear == pytest.approx(0.5 * (5.0 + 6.25) + 0.625, abs=0.63), "found to a cell of 1.25 mm"


def test_a_zone_that_sticks_is_known_by_its_middle_and_width(tmp_path: Path) -> None:
    result = write_flow(tmp_path, lambda x: 1e-3 * np.where(x < 3, x - 3, np.where(x > 7, x - 7, 0.0)))
    found = find_neutral_radius(result, 1)
    assert found.by_slip == pytest.approx(5.0, abs=0.4)
    assert found.stick_width == pytest.approx(4.0, abs=1.3)


def test_flow_one_way_has_none(tmp_path: Path) -> None:
    found = find_neutral_radius(write_flow(tmp_path, lambda x: 1e-3 * (x + 1.0)), 1)
    assert np.isnan([found.by_slip, found.stick_width, found.by_shear]).all()


def test_a_tool_that_carries_the_whole_surface_has_none(tmp_path: Path) -> None:
    found = find_neutral_radius(write_flow(tmp_path, lambda x: 0 * x), 1)
    assert np.isnan(found.by_slip)


def test_wrong_questions_are_answered_with_what_is_there(tmp_path: Path) -> None:
    for name in ("plane", "two"):
        (tmp_path / name).mkdir()
    plane = write_flow(tmp_path / "plane", lambda x: x - 5, analysis="plane_strain")
    with pytest.raises(ResultError, match="not axisymmetric"):
        find_neutral_radius(plane)
    two = write_flow(tmp_path / "two", lambda x: x - 5, tools=2)
    with pytest.raises(ResultError, match="several tools; name one of: other, platen"):
        find_neutral_radius(two)
    with pytest.raises(ResultError, match="there is no step 7"):
        find_neutral_radius(two, 7, "platen")
    with pytest.raises(ResultError, match="no tool punch"):
        find_neutral_radius(two, 1, "punch")


def press_ring(folder: Path, law: str) -> Result:
    settings = [f"tools.punch={{profile=[[0,6],[60,6]], {law}}}", "stages.0.tools.punch.stroke=1.5", "output.steps=10"]
    case = Case.from_toml(copy_example("ring_compression", folder), settings)
    return run(case, folder / "out").result


@pytest.mark.parametrize(
    "law", ['contact="shear", m=0.3', 'contact="coulomb", mu=0.15', 'contact="sticking"', 'contact="frictionless"']
)
def test_a_ring_parts_where_its_bore_says(tmp_path: Path, law: str) -> None:
    """The bore alone gives the neutral radius of the flow averaged over the height: near that on the platen."""
    result = press_ring(tmp_path, law)
    found, of_bore = find_neutral_radius(result, 8), measure_ring(result).neutral_radius[8]
    if "frictionless" in law:
        assert np.isnan([found.by_slip, found.by_shear]).all()
    elif "sticking" in law:
        assert np.isnan(found.by_slip)
        assert 9.0 < found.by_shear < 18.0
    else:
        assert found.by_slip == pytest.approx(of_bore, abs=0.5 * found.stick_width + 0.45), "half a cell"
        assert found.by_shear == pytest.approx(found.by_slip, abs=0.5 * found.stick_width + 0.45)
