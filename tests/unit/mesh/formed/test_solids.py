# SPDX-License-Identifier: Apache-2.0
"""Formed solids in other programs' files, read back by meshio, our importers and the columns of the manuals."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from presswork.mesh.checks import MeshError
from presswork.mesh.files.abaqus import read_abaqus
from presswork.mesh.files.formed.writers import find_format
from presswork.model import FormedSolid

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
HEX = np.array([[0, 1, 3, 2, 4, 5, 7, 6]], dtype=np.int32)
TETS = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]], dtype=np.int32)


def make(frame: str, points: np.ndarray, cells: np.ndarray) -> FormedSolid:
    rng = np.random.default_rng(len(cells))
    stress = rng.uniform(-500, 500, (len(cells), 6))
    if frame != "solid":
        stress[:, 4:] = 0.0
    return FormedSolid(points, (cells,), frame, stress, rng.uniform(0, 1, len(cells)))  # type: ignore[arg-type]


def write(solid: FormedSolid, path: Path) -> Path:
    kind = find_format(path)
    assert kind.write_solid is not None
    path.write_bytes(kind.write_solid(solid, "a body"))
    return path


def rows_below(text: str, keyword: str) -> np.ndarray:
    rows = text.split(keyword + "\n")[1].split("*")[0].strip().split("\n")
    return np.array([[float(word) for word in row.split(",")] for row in rows])


@pytest.mark.parametrize(("cells", "kind", "name"), [(HEX, "hexahedron", "C3D8R"), (TETS, "tetra", "C3D4")])
def test_abaqus_in_space(tmp_path: Path, cells: np.ndarray, kind: str, name: str) -> None:
    solid = make("solid", CUBE, cells)
    path = write(solid, tmp_path / "body.inp")
    assert f"TYPE={name}," in path.read_text()
    found = meshio.read(path)
    np.testing.assert_allclose(found.points, CUBE)
    np.testing.assert_array_equal(found.cells_dict[kind], cells)
    rows = rows_below(path.read_text(), "TYPE=STRESS")
    xx, yy, zz, xy, xz, yz = rows[:, 1:].T  # the manual's order: 11, 22, 33, 12, 13, 23
    np.testing.assert_allclose(np.stack([xx, yy, zz, xy, yz, xz], axis=1), solid.stress, rtol=1e-8)
    np.testing.assert_allclose(rows_below(path.read_text(), "TYPE=HARDENING")[:, 1], solid.plastic_strain, rtol=1e-8)


@pytest.mark.parametrize(("frame", "name"), [("axisymmetric", "CAX4R"), ("plane_strain", "CPE4R")])
def test_abaqus_in_the_plane(tmp_path: Path, frame: str, name: str) -> None:
    solid = make(frame, CUBE[:4, :2], np.array([[0, 1, 3, 2]], dtype=np.int32))
    path = write(solid, tmp_path / "body.inp")
    assert f"TYPE={name}," in path.read_text()
    np.testing.assert_array_equal(np.concatenate(read_abaqus(path).cells["quad4"]), solid.blocks[0])
    np.testing.assert_allclose(rows_below(path.read_text(), "TYPE=STRESS")[:, 1:], solid.stress[:, :4], rtol=1e-8)
    for ending in (".k", ".stl"):
        with pytest.raises(MeshError, match="bodies in space"):
            write(solid, tmp_path / f"body{ending}")


@pytest.mark.parametrize("cells", [HEX, TETS])
def test_dyna_in_space(tmp_path: Path, cells: np.ndarray) -> None:
    solid = make("solid", CUBE, cells)
    lines = write(solid, tmp_path / "body.k").read_text().splitlines()
    at, end = lines.index("*ELEMENT_SOLID") + 1, lines.index("*INITIAL_STRESS_SOLID")
    nodes = [[int(row[i : i + 8]) for i in range(0, 64, 8)] for row in lines[at + 1 : end : 2]]
    assert [list(dict.fromkeys(row)) for row in nodes] == (cells + 1).tolist()
    rows = lines[end + 1 : -1]
    assert [[int(row[i : i + 10]) for i in (0, 10, 20, 30)] for row in rows[::3]] == [
        [i + 1, 1, 0, 1] for i in range(len(cells))
    ]
    values = [[float(row[i : i + 16]) for row in pair for i in range(0, len(row), 16)]
              for pair in zip(rows[1::3], rows[2::3], strict=True)]  # fmt: skip
    np.testing.assert_allclose(values, np.column_stack([solid.stress, solid.plastic_strain]), rtol=1e-9)


@pytest.mark.parametrize("cells", [HEX, TETS])
def test_stl_is_the_closed_skin(tmp_path: Path, cells: np.ndarray) -> None:
    found = meshio.read(write(make("solid", CUBE, cells), tmp_path / "body.stl"))
    corners = found.points[found.cells_dict["triangle"]]
    assert len(corners) == 12
    volume = np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
    assert volume == pytest.approx(1.0)
