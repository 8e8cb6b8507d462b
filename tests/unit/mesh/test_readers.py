# SPDX-License-Identifier: Apache-2.0
"""Mesh files: the same mesh comes back from every format, and bad files are refused with a reason."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.mesh import MeshError, mesh_rectangle, read_mesh
from presswork.mesh.checks import reverse_cells
from presswork.model import ElementName, IntArray, Mesh

meshio = pytest.importorskip("meshio")
pytest.importorskip("pyuff")

MESHIO_CELLS = {"tri3": "triangle", "tri6_6pt": "triangle6", "quad4": "quad", "quad8": "quad8", "quad9": "quad9"}
ABAQUS_CELLS = {"tri3": "CAX3", "tri6_6pt": "CPE6", "quad4": "CAX4R", "quad8": "CPS8R"}
IDEAS_CELLS = {"tri3": 91, "tri6_6pt": 92, "quad4": 94, "quad8": 95}
ELEMENTS: list[ElementName] = ["tri3", "tri6_6pt", "quad4", "quad8", "quad9"]


def small(element: ElementName) -> Mesh:
    return mesh_rectangle(np.array([0.0, 4.0, 10.0]), np.array([0.0, 5.0, 10.0, 15.0]), element=element)


def spatial(mesh: Mesh) -> Any:
    return np.column_stack([mesh.points, np.zeros(len(mesh.points))])


def write_gmsh(path: Path, mesh: Mesh) -> None:
    element = mesh.blocks[0].element
    cells, axis = mesh.blocks[0].connectivity, mesh.edge_sets["left"]
    line = "line" if axis.shape[1] == 2 else "line3"
    tags = [np.full(len(axis), 7), np.full(len(cells), 9)]
    meshio.write(
        path,
        meshio.Mesh(
            spatial(mesh),
            [(line, axis[:, ::-1] if line == "line" else axis), (MESHIO_CELLS[element], cells)],
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data={"axis": np.array([7, 1]), "billet": np.array([9, 2])},
        ),
        file_format="gmsh22",
        binary=False,
    )


def write_vtk(path: Path, mesh: Mesh) -> None:
    meshio.write(
        path, meshio.Mesh(spatial(mesh), [(MESHIO_CELLS[mesh.blocks[0].element], mesh.blocks[0].connectivity)])
    )


def write_abaqus(path: Path, mesh: Mesh) -> None:
    cells, axis = mesh.blocks[0].connectivity, mesh.node_sets["left"]
    lines = ["*Heading", "** a comment", "*Node, nset=nall"]
    lines += [f"{10 * node}, {x!r}, {y!r}" for node, (x, y) in enumerate(mesh.points.tolist(), 1)]
    lines += [f"*ELEMENT, type={ABAQUS_CELLS[mesh.blocks[0].element]}, elset=Billet"]
    for label, cell in enumerate(cells, 1):
        labels = [str(10 * (node + 1)) for node in cell]
        lines += [f"{label}, {', '.join(labels[:3])},", ", ".join(labels[3:])] if len(cell) > 4 else []
        lines += [f"{label}, {', '.join(labels)}"] if len(cell) <= 4 else []
    lines += ["*NSET, NSET=axis", *(f"{10 * (node + 1)}," for node in axis), "*STEP", "*END STEP"]
    path.write_text("\n".join(lines))


def write_ideas(path: Path, mesh: Mesh) -> None:
    cells, axis = mesh.blocks[0].connectivity, mesh.edge_sets["left"]
    lines = ["    -1", "  2411"]
    for node, (x, y) in enumerate(mesh.points, 1):
        lines += [f"{node:10d}{1:10d}{1:10d}{11:10d}", f"{x:25.16E}{y:25.16E}{0.0:25.16E}".replace("E", "D")]
    lines += ["    -1", "    -1", "  2412"]
    for label, edge in enumerate(axis, 1):
        ends = edge if len(edge) == 2 else edge[[0, 2, 1]]
        lines += [f"{label:10d}{21:10d}{1:10d}{1:10d}{7:10d}{len(edge):10d}", f"{0:10d}{1:10d}{1:10d}", wide(ends)]
    for label, cell in enumerate(cells, 100):
        corners = 3 if len(cell) in (3, 6) else 4
        order = np.stack([cell[:corners], cell[corners:]], axis=1).ravel() if len(cell) > corners else cell
        kind = IDEAS_CELLS[mesh.blocks[0].element]
        lines += [f"{label:10d}{kind:10d}{1:10d}{1:10d}{7:10d}{len(cell):10d}", wide(order)]
    entities = [f"{8:10d}{label:10d}{0:10d}{0:10d}" for label in range(1, len(axis) + 1)]
    pairs = ["".join(entities[row : row + 2]) for row in range(0, len(entities), 2)]
    lines += ["    -1", "    -1", "  2467", f"{1:10d}" + f"{0:10d}" * 6 + f"{len(axis):10d}", "axis", *pairs, "    -1"]
    path.write_text("\n".join(lines) + "\n")


def wide(nodes: IntArray) -> str:
    return "".join(f"{node + 1:10d}" for node in nodes)


FORMATS: dict[str, Callable[[Path, Mesh], None]] = {
    "msh": write_gmsh,
    "vtk": write_vtk,
    "vtu": write_vtk,
    "inp": write_abaqus,
    "unv": write_ideas,
}
PAIRS = [
    (ending, element)
    for ending in FORMATS
    for element in ELEMENTS
    if element != "quad9" or ending not in ("inp", "unv")
]


@pytest.mark.parametrize(("ending", "element"), PAIRS)
def test_mesh_comes_back_from_its_file(tmp_path: Path, ending: str, element: ElementName) -> None:
    mesh = small(element)
    path = tmp_path / f"billet.{ending}"
    FORMATS[ending](path, mesh)
    read, notes = read_mesh(path, element=element, scale=2.0)
    assert notes == ()
    np.testing.assert_allclose(read.points, 2.0 * mesh.points, atol=1e-12)
    np.testing.assert_array_equal(read.blocks[0].connectivity, mesh.blocks[0].connectivity)
    np.testing.assert_array_equal(read.boundary_edges, mesh.boundary_edges)
    for name in ("left", "right", "bottom", "top"):
        np.testing.assert_array_equal(read.node_sets[name], mesh.node_sets[name])
        np.testing.assert_array_equal(read.edge_sets[name], mesh.edge_sets[name])
    if not ending.startswith("vt"):
        np.testing.assert_array_equal(read.node_sets["axis"], mesh.node_sets["left"])
        np.testing.assert_array_equal(read.edge_sets["axis"], mesh.edge_sets["left"])


def test_an_abaqus_deck_goes_on_after_commas_and_in_included_files(tmp_path: Path) -> None:
    (tmp_path / "nodes.inp").write_text("*NODE\n1, 0., 0.\n2, 1., 0.\n3, 2., 0.\n4, 2., 1.\n5, 0., 1.\n6, 1., 1.\n")
    deck = [
        "*INCLUDE, INPUT=nodes.inp", "*ELEMENT, TYPE=CPE4R,", "ELSET=Billet", "1, 1, 2, 6, 5", "2, 2, 3, 4, 6",
        "*ELEMENT, TYPE=SAX1, ELSET=Öffnung", "11, 1, 2", "*NSET, NSET=top, GENERATE", "4, 6", "*NSET, NSET=both",
        "top, 1",
    ]  # fmt: skip
    (tmp_path / "billet.inp").write_text("\n".join(deck), encoding="utf-8")
    mesh, _ = read_mesh(tmp_path / "billet.inp", element="quad4")
    assert len(mesh.blocks[0].connectivity) == 2
    assert {name: len(nodes) for name, nodes in mesh.node_sets.items() if name in ("billet", "top", "both")} == {
        "billet": 6, "top": 3, "both": 4,
    }  # fmt: skip
    assert mesh.points[mesh.edge_sets["öffnung"]].tolist() == [[[0.0, 0.0], [1.0, 0.0]]]


@pytest.mark.parametrize(("kind", "ends"), [("SAX1", 2), ("SAX2", 3), ("RAX2", 2), ("B31", 2), ("B32", 3), ("T3D3", 3)])
def test_lines_of_abaqus_have_their_number_of_nodes(tmp_path: Path, kind: str, ends: int) -> None:
    mesh = small("quad8")
    write_abaqus(tmp_path / "billet.inp", mesh)
    edge = [str(10 * (node + 1)) for node in mesh.edge_sets["left"][0][[0, 2, 1] if ends == 3 else [0, 1]]]
    with (tmp_path / "billet.inp").open("a") as file:
        file.write(f"\n*ELEMENT, TYPE={kind}, ELSET=side\n900, {', '.join(edge)}\n")
    read, _ = read_mesh(tmp_path / "billet.inp", element="quad8")
    assert set(read.node_sets["side"]) == {int(label) // 10 - 1 for label in edge}


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9])
def test_file_cut_short_is_refused(tmp_path: Path, ending: str, share: float) -> None:
    path = tmp_path / f"billet.{ending}"
    FORMATS[ending](path, small("quad4"))
    content = path.read_bytes()
    if ending == "inp":  # a deck has no end mark: cut where what is left cannot be whole
        content = content[: content.index(b"*NSET")].rstrip()[:-8]
    path.write_bytes(content[: int(share * len(content))] if ending != "inp" or share < 0.9 else content)
    with pytest.raises(MeshError) as caught:
        read_mesh(path, element="quad4")
    assert caught.value.remedy


def test_clockwise_file_is_turned_over_with_a_note(tmp_path: Path) -> None:
    mesh = small("quad4")
    path = tmp_path / "billet.vtu"
    meshio.write(path, meshio.Mesh(spatial(mesh), [("quad", reverse_cells(mesh.blocks[0].connectivity))]))
    read, notes = read_mesh(path, element="quad4")
    assert notes == ("all cells are clockwise: they were turned over",)
    np.testing.assert_array_equal(read.blocks[0].connectivity, mesh.blocks[0].connectivity)


def test_unused_nodes_are_dropped_with_a_note(tmp_path: Path) -> None:
    mesh = small("quad4")
    points = np.concatenate([[[99.0, 99.0, 0.0]], spatial(mesh)])
    path = tmp_path / "billet.vtu"
    meshio.write(path, meshio.Mesh(points, [("quad", mesh.blocks[0].connectivity + 1)]))
    read, notes = read_mesh(path, element="quad4")
    assert notes == ("1 nodes belong to no cell: they were left out",)
    np.testing.assert_allclose(read.points, mesh.points)


def test_cells_that_do_not_fit_the_element_name_those_that_do(tmp_path: Path) -> None:
    path = tmp_path / "billet.vtu"
    write_vtk(path, small("quad4"))
    with pytest.raises(MeshError, match=r"\(6 quad4\) do not fit element = tri3; choose one of: quad4, quad4_fbar"):
        read_mesh(path, element="tri3")


def test_mesh_out_of_plane_is_refused(tmp_path: Path) -> None:
    mesh = small("quad4")
    points = spatial(mesh)
    points[3, 2] = 1.0
    path = tmp_path / "billet.vtu"
    meshio.write(path, meshio.Mesh(points, [("quad", mesh.blocks[0].connectivity)]))
    with pytest.raises(MeshError, match=r"do not lie in a plane.*z runs from 0 to 1"):
        read_mesh(path, element="quad4")


def test_solid_mesh_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "billet.vtu"
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    meshio.write(path, meshio.Mesh(points * [1, 1, 0], [("tetra", np.array([[0, 1, 2, 3]]))]))
    with pytest.raises(MeshError, match=r"no 2D cells \(it has tetra\)"):
        read_mesh(path, element="quad4")


def test_unknown_ending_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"unknown mesh format `\.stp`; known endings: \.msh"):
        read_mesh(tmp_path / "billet.stp", element="quad4")


def test_group_of_points_and_cells_becomes_a_node_set(tmp_path: Path) -> None:
    path = tmp_path / "billet.msh"
    write_gmsh(path, small("tri3"))
    read, _ = read_mesh(path, element="tri3")
    np.testing.assert_array_equal(read.node_sets["billet"], read.node_sets["all"])
