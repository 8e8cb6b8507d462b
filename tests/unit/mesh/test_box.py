# SPDX-License-Identifier: Apache-2.0
"""Hexahedra from files, their faces, and what is refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from presswork.mesh import MeshError
from presswork.mesh.faces import nodal_normals, press_faces
from presswork.mesh.make.box import corner_volumes, mesh_box, node_volumes, read_solid_mesh
from presswork.mesh.space.drawn_up import mesh_turned


def two_cells() -> tuple[np.ndarray, np.ndarray]:
    mesh = mesh_box(np.array([0.0, 1.0, 3.0]), np.array([0.0, 1.0]), np.array([0.0, 2.0]), element="hex8")
    return mesh.points, mesh.blocks[0].connectivity


def write_abaqus(path: Path, cells: np.ndarray, points: np.ndarray) -> Path:
    nodes = "\n".join(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(points, 1))
    rows = "\n".join(f"{e}, {', '.join(str(n + 1) for n in cell)}" for e, cell in enumerate(cells, 1))
    grip = ", ".join(str(i + 1) for i in np.flatnonzero(points[:, 0] == 3.0))
    path.write_text(f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D8R\n{rows}\n*NSET, NSET=grip\n{grip}\n")
    return path


def test_abaqus_hexahedra_come_with_sets_and_faces(tmp_path) -> None:
    points, cells = two_cells()
    mesh, notes = read_solid_mesh(write_abaqus(tmp_path / "m.inp", cells, points), element="hex8", scale=10.0)
    assert not notes
    assert mesh.points.max() == 30.0
    assert len(mesh.boundary_faces) == 10
    assert len(mesh.face_sets["grip"]) == 1
    np.testing.assert_array_equal(mesh.node_sets["grip"], mesh.node_sets["right"])


def test_gmsh_hexahedra_keep_their_physical_faces(tmp_path) -> None:
    points, cells = two_cells()
    face = np.flatnonzero(points[:, 0] == 0.0)[None, [0, 1, 3, 2]]
    data = {"gmsh:physical": [np.array([7, 7]), np.array([5])], "gmsh:geometrical": [np.array([1, 1]), np.array([2])]}
    raw = meshio.Mesh(points, [("hexahedron", cells), ("quad", face)], cell_data=data)
    raw.field_data = {"body": np.array([7, 3]), "wall": np.array([5, 2])}
    meshio.gmsh.write(tmp_path / "m.msh", raw, fmt_version="2.2", binary=False)
    mesh, _ = read_solid_mesh(tmp_path / "m.msh", element="hex8")
    assert len(mesh.face_sets["wall"]) == 1
    assert set(mesh.face_sets["wall"][0]) == set(mesh.node_sets["left"])


def test_cells_inside_out_are_turned_over_when_all_are(tmp_path) -> None:
    points, cells = two_cells()
    over = cells[:, [4, 5, 6, 7, 0, 1, 2, 3]]
    mesh, notes = read_solid_mesh(write_abaqus(tmp_path / "m.inp", over, points), element="hex8")
    np.testing.assert_array_equal(mesh.blocks[0].connectivity, cells)
    assert "turned over" in notes[0]


@pytest.mark.parametrize(
    ("spoil", "expected"),
    [
        (lambda points, cells: (points, np.vstack([cells[:1, [4, 5, 6, 7, 0, 1, 2, 3]], cells[1:]])), "inverted"),
        (lambda points, cells: (np.vstack([points, points + 9]), np.vstack([cells, cells + 12])), "2 parts"),
    ],
)
def test_meshes_that_cannot_be_computed_are_refused(tmp_path, spoil, expected) -> None:
    points, cells = spoil(*two_cells())
    with pytest.raises(MeshError, match=expected):
        read_solid_mesh(write_abaqus(tmp_path / "m.inp", cells, points), element="hex8")


def test_a_flat_mesh_is_refused(tmp_path) -> None:
    raw = meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))])
    meshio.vtu.write(tmp_path / "m.vtu", raw)
    with pytest.raises(MeshError, match="no hexahedra"):
        read_solid_mesh(tmp_path / "m.vtu", element="hex8")


def test_face_pressure_stiffness_is_the_derivative_of_its_force() -> None:
    rng = np.random.default_rng(2)
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) + 0.2 * rng.standard_normal((4, 3))
    face = np.array([[0, 1, 2, 3]], dtype=np.int32)
    _, stiffness = press_faces(points, face, 7.0)
    for b in range(4):
        for j in range(3):
            move = np.zeros((4, 3))
            move[b, j] = 1e-6
            ahead, behind = (press_faces(points + s * move, face, 7.0)[0][0] for s in (1, -1))
            np.testing.assert_allclose(stiffness[0, :, b, :, j], -(ahead - behind) / 2e-6, atol=1e-7)


def test_node_volumes_add_up_to_the_body() -> None:
    points, cells = two_cells()
    volumes = node_volumes(points, cells)
    np.testing.assert_allclose(volumes, np.array([[0.25] * 8, [0.5] * 8]))
    skewed = points @ np.array([[1.0, 0.0, 0.0], [0.3, 1.0, 0.0], [0.2, 0.1, 1.0]]).T
    assert node_volumes(skewed, cells).sum() == pytest.approx(6.0)


def test_tetrahedra_of_a_cylinder_fill_it_and_fit_each_other() -> None:
    z_lines = np.linspace(0.0, 6.0, 4)
    meshes = {
        element: mesh_turned(np.full(4, 5.0), None, z_lines, angle=90.0, cells=(4, 4), element=element)
        for element in ("hex8", "tet4_mini")
    }
    hexahedra, tetrahedra = (mesh.blocks[0].connectivity for mesh in meshes.values())
    assert len(tetrahedra) == 6 * len(hexahedra)
    points = meshes["tet4_mini"].points
    volumes = corner_volumes(points, tetrahedra) / 6.0
    assert volumes.min() > 0.0
    assert volumes.sum() == pytest.approx(node_volumes(points, hexahedra).sum(), rel=1e-2)
    sides = meshes["hex8"].boundary_faces
    assert len(meshes["tet4_mini"].boundary_faces) == 2 * len(sides)
    assert nodal_normals(points, meshes["tet4_mini"].boundary_faces).sum(axis=0) == pytest.approx(0.0, abs=1e-12)
