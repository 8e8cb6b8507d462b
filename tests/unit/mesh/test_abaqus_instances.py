# SPDX-License-Identifier: Apache-2.0
"""Meshes in Abaqus decks of parts and instances: where they lie, and numbers that two parts share."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.mesh.checks import MeshError
from presswork.mesh.files.readers import read_mesh, read_raw

PART = """*Part, name=block
*Node
1, 0., 0.
2, 2., 0.
3, 2., 1.
4, 0., 1.
*Element, type=CAX4R, elset=All
1, 1, 2, 3, 4
*Nset, nset=foot
1, 2
*End Part
*Assembly, name=A
"""


def read(folder, text: str):
    path = folder / "mesh.inp"
    path.write_text(text)
    return read_raw(path)


def test_an_instance_lies_where_it_is_moved(tmp_path) -> None:
    path = tmp_path / "mesh.inp"
    path.write_text(
        f"{PART}*Instance, name=b-1, part=block\n0., 5.\n*End Instance\n*Nset, nset=top, instance=b-1\n3, 4\n"
    )
    mesh, _ = read_mesh(path, element="quad4_fbar")
    np.testing.assert_allclose(mesh.points[:, 1], [5.0, 5.0, 6.0, 6.0])
    np.testing.assert_array_equal(mesh.node_sets["foot"], [0, 1])
    np.testing.assert_array_equal(mesh.node_sets["top"], [2, 3])


def test_an_instance_is_turned_about_an_axis(tmp_path) -> None:
    raw = read(tmp_path, f"{PART}*Instance, name=b-1, part=block\n, 5.\n0., 5., 0., 0., 5., 1., 90.\n*End Instance\n")
    np.testing.assert_allclose(raw.points[:, :2], [[0, 5], [0, 7], [-1, 7], [-1, 5]], atol=1e-12)


def test_two_instances_of_the_same_numbers_are_two(tmp_path) -> None:
    two = "*Instance, name=a, part=block\n*End Instance\n*Instance, name=b, part=block\n0., 3.\n*End Instance\n"
    raw = read(tmp_path, f"{PART}{two}*Node, nset=ref\n1, 9., 9.\n*Nset, nset=one, instance=b\n1\n")
    assert len(np.concatenate(raw.cells["quad4"])) == 2
    points = {name: raw.points[np.concatenate(rows)] for name, rows in raw.node_sets.items()}
    assert len(points["foot"]) == 4
    np.testing.assert_allclose(points["b.foot"][:, 1], 3.0)
    np.testing.assert_allclose(points["one"], [[0.0, 3.0, 0.0]])
    np.testing.assert_allclose(points["ref"], [[9.0, 9.0, 0.0]])


def test_parts_without_instances_keep_their_own_numbers(tmp_path) -> None:
    other = PART.replace("name=block", "name=other").replace("1, 0., 0.\n", "1, -1., 0.\n")
    raw = read(tmp_path, PART + other)
    assert len(np.concatenate(raw.cells["quad4"])) == 2
    assert raw.points[:, 0].min() == -1.0


def test_systems_and_cylindrical_coordinates_place_nodes(tmp_path) -> None:
    raw = read(tmp_path, PART.replace("*Node\n", "*System\n0., 4.\n*Node\n").replace("*Assembly, name=A\n", ""))
    np.testing.assert_allclose(raw.points[:, 1], [4.0, 4.0, 5.0, 5.0])
    raw = read(tmp_path, PART.replace("*Node\n", "*Node, system=C\n").replace("2, 2., 0.", "2, 2., 90."))
    np.testing.assert_allclose(raw.points[1], [0.0, 2.0, 0.0], atol=1e-12)


def test_rows_of_nodes_may_stand_in_a_file_of_their_own(tmp_path) -> None:
    rows = PART[PART.index("1, 0., 0.") : PART.index("*Element")]
    (tmp_path / "nodes.txt").write_text(rows)
    text = PART.replace(f"*Node\n{rows}", "*Node, input=nodes.txt\n")
    np.testing.assert_allclose(read(tmp_path, text).points, read(tmp_path, PART).points)
    with pytest.raises(MeshError, match=r"INPUT=none\.txt: no such file; check the path"):
        read(tmp_path, text.replace("nodes.txt", "none.txt"))


BAD = {
    "*Node\n1, 7., 7.\n*Element": ("*Element", "node 1 is there already, and is another one"),
    "*Ngen\n1, 2, 1\n*Element": ("*Element", r"\*NGEN in .* makes nodes or elements; write all of them out"),
    "*Instance, name=b, part=none\n*End Instance\n": ("*Assembly, name=A\n", "there is no part NONE"),
    "*Nset, nset=x, instance=c\n1\n": ("*Assembly, name=A\n", "there is no instance C"),
}


@pytest.mark.parametrize("new", BAD, ids=lambda text: text.split("\n")[0])
def test_what_cannot_be_read_is_named_with_its_line(tmp_path, new) -> None:
    old, message = BAD[new]
    with pytest.raises(MeshError, match=message):
        read(tmp_path, PART.replace(old, new))
