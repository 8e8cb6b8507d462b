# SPDX-License-Identifier: Apache-2.0
"""Values of cells at marked points: exact where they are linear, and never outside the range of the cells round it."""

from dataclasses import replace

import numpy as np
import pytest

from presswork.mesh.make.blanks import mesh_rectangular_blank
from presswork.mesh.make.box import mesh_box
from presswork.mesh.make.structured import mesh_rectangle
from presswork.mesh.simplices import find_simplices
from presswork.observe.marked_points import take_within, weigh_cells

EDGES = np.linspace(0.0, 1.0, 6)
MESHES = {
    "quadrilaterals": mesh_rectangle(EDGES, EDGES, element="quad4_fbar"),
    "triangles": mesh_rectangle(EDGES, EDGES, element="tri3"),
    "hexahedra": mesh_box(EDGES, EDGES, EDGES, element="hex8_fbar"),
    "tetrahedra": mesh_box(EDGES, EDGES, EDGES, element="tet4_mini"),
    "shells": mesh_rectangular_blank((2.0, 2.0), 0.2, (True, True)),
}


def find_middles(mesh):
    return np.concatenate([mesh.points[block.connectivity].mean(axis=1) for block in mesh.blocks])


@pytest.mark.parametrize("name", MESHES)
def test_a_linear_field_is_found_exactly_inside_the_body(name):
    mesh, draw = MESHES[name], np.random.default_rng(1)
    slope = draw.normal(size=mesh.points.shape[1])
    places = draw.uniform(0.35, 0.65, (20, mesh.points.shape[1]))
    places[:, 2:] *= float(np.ptp(mesh.points, axis=0)[2:].any())
    field = 3.0 + find_middles(mesh) @ slope
    for place, nodes in zip(places, find_simplices(mesh, mesh.points, places)[0], strict=True):
        cells, weight = weigh_cells(mesh, mesh.points, nodes, place)
        assert take_within(field[cells], weight) == pytest.approx(3.0 + place @ slope, rel=1e-9)


@pytest.mark.parametrize("name", MESHES)
def test_values_stay_within_those_of_the_cells_round_the_point(name):
    """On the surface and at corners a linear fit over the middles of cells reaches beyond."""
    mesh, draw = MESHES[name], np.random.default_rng(2)
    places = np.concatenate([draw.uniform(0.0, 1.0, (20, mesh.points.shape[1])), mesh.points[:6]])
    places[:, 2:] *= float(np.ptp(mesh.points, axis=0)[2:].any())
    reached_beyond = 0
    for place, nodes in zip(places, find_simplices(mesh, mesh.points, places)[0], strict=True):
        cells, weight = weigh_cells(mesh, mesh.points, nodes, place)
        for field in draw.normal(size=(20, len(find_middles(mesh)))):
            reached_beyond += not field[cells].min() <= weight @ field[cells] <= field[cells].max()
            assert field[cells].min() <= take_within(field[cells], weight) <= field[cells].max()
    assert reached_beyond > 0


def test_values_of_another_material_do_not_count():
    mesh = MESHES["quadrilaterals"]
    cells = mesh.blocks[0].connectivity
    is_left = mesh.points[cells].mean(axis=1)[:, 0] < 0.4
    left, right = (replace(mesh.blocks[0], connectivity=cells[own]) for own in (is_left, ~is_left))
    two = replace(mesh, blocks=(left, replace(right, material=1)))
    field = np.repeat([100.0, 700.0], [is_left.sum(), (~is_left).sum()])
    for x, value in ((0.35, 100.0), (0.45, 700.0)):
        place = np.array([x, 0.5])
        nodes = find_simplices(two, two.points, place[None])[0][0]
        found, weight = weigh_cells(two, two.points, nodes, place)
        assert take_within(field[found], weight) == pytest.approx(value)
