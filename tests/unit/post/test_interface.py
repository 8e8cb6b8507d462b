# SPDX-License-Identifier: Apache-2.0
"""The contact surface is found and ordered."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.post import order_along_boundary, trace_interface
from presswork.results import Result, ResultError, append_step
from tests.unit.results.upset_output import DIE, make_fields, make_mesh, write_upset_output


@pytest.mark.parametrize("element", ["tri3", "tri6_6pt", "quad4", "quad8", "quad9"])
def test_top_of_the_billet_runs_from_the_axis_to_the_rim(tmp_path: Path, element: str) -> None:
    result = Result(write_upset_output(tmp_path, (element,), n=4))
    interface = trace_interface(result, "die")
    x, y = interface.points.T
    assert len(x) == (5 if element in ("tri3", "quad4") else 9)
    assert x[0] == 0
    assert np.all(np.diff(x) > 0)
    np.testing.assert_allclose(y, 6.0)
    np.testing.assert_allclose(interface.arc_length, x)
    np.testing.assert_array_equal(interface.contact_pressure, result.field("contact_pressure")[interface.nodes])
    np.testing.assert_array_equal(interface.contact_shear, result.field("contact_shear")[interface.nodes])
    assert np.all(interface.patch == 0)


def test_no_contact_gives_empty_arrays(tmp_path: Path) -> None:
    interface = trace_interface(Result(write_upset_output(tmp_path)), step=0)
    assert interface.nodes.shape == interface.arc_length.shape == interface.patch.shape == (0,)
    assert interface.points.shape == (0, 2)


def test_unknown_tool_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="no tool punch"):
        trace_interface(Result(write_upset_output(tmp_path)), "punch")


def test_each_tool_has_the_nodes_nearest_to_it(tmp_path: Path) -> None:
    mesh = make_mesh(n=4)
    point_data, cell_data = make_fields(mesh, 3.0)
    bottom = mesh.points[:, 1] == 0
    point_data["contact_pressure"] = np.where(bottom, 7.0, point_data["contact_pressure"])
    table = np.array([[-2.0, 0.0, 14.0, 0.0, 0.0, 0.0, 0.0]])
    displacement = {"die": np.array([0.0, -3.0])}
    tools = {"die": DIE, "table": table}
    path = tmp_path / "results.vtkhdf"
    append_step(path, mesh, 0.0, point_data, cell_data, tools=tools, tool_displacement=displacement)
    result = Result(tmp_path)
    assert set(trace_interface(result, "table").points[:, 1]) == {0.0}
    np.testing.assert_allclose(trace_interface(result, "die").points[:, 1], 12.0)
    assert sorted(set(trace_interface(result).patch)) == [0, 1]


def test_gap_in_contact_parts_the_surface() -> None:
    points = np.column_stack([np.arange(6.0), np.zeros(6)])
    edges = np.array([[4, 3], [1, 0], [3, 2], [5, 4], [2, 1]])  # the body on the left: it lies below
    parts = order_along_boundary(points, edges, np.array([True, True, False, True, True, True]))
    assert [part.tolist() for part in parts] == [[0, 1], [3, 4, 5]]
    single = order_along_boundary(points, edges, np.array([False, False, True, False, False, True]))
    assert [part.tolist() for part in single] == [[2], [5]]


def test_closed_contact_surface_is_passed_once() -> None:
    points = np.array([[1.0, 0], [2, 1], [1, 2], [0, 1]])
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    parts = order_along_boundary(points, edges, np.ones(4, dtype=bool))
    assert [part.tolist() for part in parts] == [[3, 0, 1, 2]]
