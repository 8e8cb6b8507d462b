# SPDX-License-Identifier: Apache-2.0
"""Cells of one's own, written here alone: meshes, faces, files and pictures work on them.

Triangles of 7 nodes and hexahedra of 20, whose faces are quadrilaterals of 8.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest

from presswork.mesh import mesh_rectangle, read_mesh
from presswork.mesh.faces import face_areas, nodal_normals
from presswork.mesh.make.box import mesh_box, read_solid_mesh
from presswork.mesh.simplices import list_simplices
from presswork.mesh.triangles import double_areas
from presswork.model import CELLS, ELEMENTS, Mesh, NamesInFiles
from presswork.post import average_to_nodes, find_skin
from presswork.report.surface import find_surface
from presswork.results import ResultMesh, append_step
from presswork.results.reader import ResultBlock
from presswork.view.cells import outline_blocks, triangulate

X, Y, Z = np.linspace(0.0, 6.0, 4), np.linspace(0.0, 4.0, 3), np.linspace(0.0, 2.0, 2)

TRI7 = replace(
    CELLS["tri6"],
    name="tri7",
    places=np.vstack([CELLS["tri6"].places, [1 / 3, 1 / 3]]),
    pieces=np.array([(0, 3, 6), (3, 1, 6), (1, 4, 6), (4, 2, 6), (2, 5, 6), (5, 0, 6)]),
    reversed=np.append(CELLS["tri6"].reversed, 6),
    mass_shares=np.zeros(0),
    rules={},
    files=NamesInFiles(34, "triangle7", "CPE7"),
)
_HEX = CELLS["hex8"]
_EDGES = np.column_stack([_HEX.edges, np.arange(8, 20)])
_MIDDLE = {frozenset(edge[:2]): edge[2] for edge in _EDGES.tolist()}


def middles(ends: np.ndarray) -> np.ndarray:
    """Return the nodes in the middle of edges (..., 2)."""
    return np.array([_MIDDLE[frozenset(edge)] for edge in ends.reshape(-1, 2).tolist()]).reshape(ends.shape[:-1])


HEX20 = replace(
    _HEX,
    name="hex20",
    places=np.vstack([_HEX.places, _HEX.places[_HEX.edges].mean(axis=1)]),
    edges=_EDGES,
    faces=np.array(
        [[*f, *(_MIDDLE[frozenset((f[k], f[(k + 1) % 4]))] for k in range(4))] for f in _HEX.faces.tolist()]
    ),
    reversed=np.concatenate([_HEX.reversed, [_MIDDLE[frozenset(edge)] for edge in _HEX.reversed[_HEX.edges].tolist()]]),
    rules={},
    files=NamesInFiles(25, "hexahedron20", "C3D20R?$"),
)


@pytest.fixture(autouse=True)
def table(monkeypatch: pytest.MonkeyPatch) -> None:
    for cell in (TRI7, HEX20):
        row: Any = SimpleNamespace(name=cell.name, cell=cell.name, nodes=cell.nodes, family=ELEMENTS["tri3"].family)
        monkeypatch.setitem(CELLS, cell.name, cell)
        monkeypatch.setitem(ELEMENTS, cell.name, row)


def shown(mesh: Mesh, vtk: int) -> ResultMesh:
    block = mesh.blocks[0]
    return ResultMesh(mesh.points, (ResultBlock(block.element, vtk, block.connectivity),), mesh.boundary_edges)


def area_of(points: np.ndarray, triangles: np.ndarray) -> float:
    space = np.zeros((len(points), 3))
    space[:, : points.shape[1]] = points
    return float(np.linalg.norm(double_areas(space, triangles), axis=1).sum() / 2.0)


def write_deck(folder: Path, points: np.ndarray, cells: np.ndarray, kind: str) -> Path:
    """Write a deck of Abaqus, a row of nodes in two where it is long."""
    rows = ["*NODE", *(", ".join(map(str, [n, *x])) for n, x in enumerate(points.tolist(), 1))]
    rows += [f"*ELEMENT, TYPE={kind}"]
    for number, cell in enumerate((cells + 1).tolist(), 1):
        rows.append(", ".join(map(str, [number, *cell[:12]])) + ("," if len(cell) > 12 else ""))
        rows += [", ".join(map(str, cell[12:]))] if len(cell) > 12 else []
    (folder / "part.inp").write_text("\n".join(rows))
    return folder / "part.inp"


def test_triangles_of_seven_nodes_are_meshed_and_read(tmp_path: Path) -> None:
    mesh = mesh_rectangle(X, Y, element="tri7")
    cells = mesh.blocks[0].connectivity
    assert cells.shape == (4 * 3 * 2, 7)
    np.testing.assert_allclose(mesh.points[cells[:, 6]], mesh.points[cells[:, :3]].mean(axis=1), atol=1e-12)
    assert mesh.boundary_edges.shape == (2 * (3 + 2), 3)
    file = write_deck(tmp_path, mesh.points, cells[:, TRI7.reversed], "CPE7")
    read, notes = read_mesh(file, element="tri7")
    np.testing.assert_array_equal(read.blocks[0].connectivity, cells)
    assert "clockwise" in notes[0]


def test_triangles_of_seven_nodes_are_drawn_and_averaged() -> None:
    mesh = mesh_rectangle(X, Y, element="tri7")
    result = shown(mesh, 34)
    assert area_of(mesh.points, triangulate(result)) == pytest.approx(24.0)
    assert area_of(mesh.points, list_simplices(mesh)) == pytest.approx(24.0)
    outline = outline_blocks(result, mesh.points)[0]
    assert outline.shape == (24, 18, 2)
    place = mesh.points[mesh.blocks[0].connectivity[:, :3]].mean(axis=1)
    nodal = average_to_nodes(mesh.points, [mesh.blocks[0].connectivity], place[:, 0])
    inside = (mesh.points > 0.0).all(axis=1) & (mesh.points < [6.0, 4.0]).all(axis=1)
    np.testing.assert_allclose(nodal[inside], mesh.points[inside, 0], atol=0.5)


def test_hexahedra_of_twenty_nodes_are_meshed_with_their_faces() -> None:
    mesh = mesh_box(X, Y, Z, element="hex20")
    cells = mesh.blocks[0].connectivity
    assert cells.shape == (6, 20)
    np.testing.assert_allclose(
        mesh.points[cells[:, HEX20.edges[:, 2]]], mesh.points[cells[:, HEX20.edges[:, :2]]].mean(axis=2)
    )
    assert mesh.boundary_faces.shape == (2 * (6 + 3 + 2), 8)
    assert face_areas(mesh.points, mesh.boundary_faces).sum() == pytest.approx(2 * (24.0 + 12.0 + 8.0))
    assert face_areas(mesh.points, mesh.face_sets["top"]).sum() == pytest.approx(12.0)
    np.testing.assert_allclose(
        nodal_normals(mesh.points, mesh.face_sets["right"]).sum(axis=0), [8.0, 0.0, 0.0], atol=1e-12
    )


def test_hexahedra_of_twenty_nodes_are_read_and_drawn(tmp_path: Path) -> None:
    mesh = mesh_box(X, Y, Z, element="hex20")
    cells = mesh.blocks[0].connectivity
    file = write_deck(tmp_path, mesh.points, cells, "C3D20R")
    read, _ = read_solid_mesh(file, element="hex20")
    np.testing.assert_array_equal(read.blocks[0].connectivity, cells)
    skin, owner = find_skin(shown(mesh, 25))
    assert owner is not None
    assert skin.blocks[0].element == "quad8"
    assert area_of(mesh.points, triangulate(skin)) == pytest.approx(88.0)
    assert find_surface(shown(mesh, 25), has_inside=True).hexahedra.shape == (6, 8)


@pytest.mark.parametrize("name", ["tri7", "hex20"])
def test_results_name_them_as_vtk_does(name: str, tmp_path: Path) -> None:
    mesh = mesh_rectangle(X, Y, element="tri7") if name == "tri7" else mesh_box(X, Y, Z, element="hex20")
    append_step(tmp_path / "results.vtkhdf", mesh, 0.0, {"displacement": np.zeros((len(mesh.points), 3))}, {})
    with h5py.File(tmp_path / "results.vtkhdf") as file:
        found: list[h5py.Dataset] = []
        file.visititems(lambda path, item: found.append(item) if path.endswith("/Types") else None)
        assert set(found[0][()]) == {CELLS[name].files.vtk}
