# SPDX-License-Identifier: Apache-2.0
"""A part is laid on tools by its surface, not by the chords of its shells."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_ring
from presswork.geometry.tool_surface import make_surface
from presswork.model import Operation, Tool
from presswork.process.begin import begin
from presswork.process.line.laying import lay_tools, sample_part
from presswork.process.mesh_change.transfer import SheetBlock, SheetState
from tests.problems.divided_loops import describe_line, read

RADIUS, THICKNESS, SIDE = 6.0, 0.8, 2.0


@pytest.fixture
def ridge() -> SheetState:
    """Half a pipe of shells of 2 mm whose middle surface has a radius of 6 mm, its axis along y, open downwards."""
    n, m = round(np.pi * RADIUS / SIDE), 6
    angle, y = np.meshgrid(np.linspace(np.pi, 0.0, n + 1), SIDE * np.arange(m + 1))
    points = np.stack([RADIUS * np.cos(angle).ravel(), y.ravel(), RADIUS * np.sin(angle).ravel()], axis=1)
    first = (np.arange(n)[None] + (n + 1) * np.arange(m)[:, None]).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)
    none = np.zeros((len(cells), 1, 1))
    axis, thick = np.tile([1.0, 0.0, 0.0], (len(cells), 1, 1)), np.full((len(cells), 1), THICKNESS)
    return SheetState(points, (SheetBlock(cells, axis, thick, none, none, {}, None),))


def test_points_between_nodes_lie_on_the_bent_sheet(ridge) -> None:
    """Chords lie up to L^2/8R = 0.083 mm inside; at the free edges the normals are those of one cell."""
    points, half = sample_part(ridge)
    inner = np.abs(np.arctan2(points[:, 0], points[:, 2])) < 0.5
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 2])[inner], RADIUS, atol=1e-3)
    np.testing.assert_array_equal(half, 0.5 * THICKNESS)


def lay_post(state: SheetState, edge_radius: float, *, with_edges: bool) -> float:
    """Return the height of the face of a post, 0.5 mm and its edge wide, that has come up under the ridge [mm]."""
    shape = draw_ring((0.0, 0.0), (0.5 + edge_radius, edge_radius), 10.0, works_up=True)
    post = Tool("post", shape, position=(0.0, 6.0, 0.0), kind="die", working_direction=(0.0, 0.0, 1.0))
    operation = Operation("flange", (post,), (), (), laid=("post",))
    return lay_tools(operation, state, with_edges=with_edges)[0].position[2]


def find_height(edge_radius: float) -> float:
    """Return where the round edge of such a post touches the round surface under the ridge [mm]."""
    return edge_radius + np.sqrt((RADIUS - 0.5 * THICKNESS - edge_radius) ** 2 - 0.25)


def test_both_procedures_lay_a_part_alike_on_a_blunt_tool(ridge) -> None:
    """Nodes alone touch it then, also by explicit dynamics; by the chords it lay 0.08 mm lower and further."""
    nodes, edges = (lay_post(ridge, 4.0, with_edges=each) for each in (False, True))
    assert nodes == edges == pytest.approx(find_height(4.0), abs=0.03)


def test_a_sharp_tool_touches_between_nodes(ridge) -> None:
    assert lay_post(ridge, 1.0, with_edges=True) == pytest.approx(find_height(1.0), abs=5e-3)
    assert lay_post(ridge, 1.0, with_edges=False) > find_height(1.0) + 0.02


@pytest.mark.parametrize("edge_radius", [1.9, 2.1])
def test_a_tool_is_sharp_where_its_radius_is_less_than_an_edge(edge_radius) -> None:
    surface = make_surface(draw_ring((0.0, 0.0), (5.0, edge_radius), 10.0, works_up=True))
    assert surface.is_sharp(2.0) == (edge_radius < 2.0)


def test_a_coarse_part_begins_in_the_tools_that_formed_it() -> None:
    """Chords of its edges lie in their radii, by less than they lie off the arcs by which it is laid."""
    assert len(list(begin(read(describe_line()), 1).advance())) == 5, "two rows of each, and one between them"
