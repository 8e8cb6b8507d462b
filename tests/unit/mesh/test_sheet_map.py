# SPDX-License-Identifier: Apache-2.0
"""Fields of known shape mapped to meshes of other kinds, sizes and senses, read from files of other programs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.spatial import Delaunay

from presswork.mesh.checks import MeshError
from presswork.mesh.files.dynain import first_sides
from presswork.mesh.files.formed.layers import elastic_energy, lamina_frames, lamina_stress, resultants
from presswork.mesh.files.shell_mesh import ShellMesh, read_shell_mesh
from presswork.mesh.sheet_map import covered_part, map_sheet
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import FloatArray, FormedSheet, IntArray, Section
from presswork.process.line.formed_sheet import TO
from tests.problems.formed_sheets import random_sheet, text_of

RADIUS, LENGTH, ARC = 30.0, 80.0, 1.2


def bend(flat: FloatArray) -> FloatArray:
    """Roll a sheet (n, 2) about the axis x."""
    angle = flat[:, 1] / RADIUS
    return np.column_stack([flat[:, 0], RADIUS * np.sin(angle), RADIUS * np.cos(angle)])


def fields(flat: FloatArray, heights: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return thickness, plastic strain by layer, and xx, yy, xy by layer along x and round the axis."""
    x, y = flat.T / [[LENGTH], [ARC * RADIUS]]
    thickness = 1.0 - 0.25 * x * (1 - x) - 0.1 * np.sin(2.0 * y)
    plastic = (0.1 + 0.2 * x * y)[:, None] * (1.0 + 0.5 * heights**2)
    xx = (80.0 * (1 + x))[:, None] + 200.0 * (1 - y)[:, None] * heights
    yy = (40.0 * np.cos(2 * x))[:, None] - 150.0 * heights + 0.0 * y[:, None]
    xy = (30.0 * y)[:, None] * (1.0 + heights)
    return thickness, plastic, np.stack([xx, yy, xy], axis=-1)


def sheet_on(flat: FloatArray, cells: IntArray, points: int = 5) -> FormedSheet:
    """Return the sheet with those fields at the middles of its shells."""
    heights = thickness_rule(Section(1.0, points, "gauss"))[0]
    middle = np.where((cells[:, 2] == cells[:, 3])[:, None], flat[cells[:, :3]].mean(axis=1), flat[cells].mean(axis=1))
    thickness, plastic, lamina = fields(middle, heights)
    nodes = bend(flat)
    axis = np.tile([1.0, 0.0, 0.0], (len(cells), 1))
    _, normal = first_sides(nodes, cells)
    frame = np.stack([axis, np.cross(normal, axis)], axis=1)
    tensor = np.einsum("cip,ckij,cjq->ckpq", frame, lamina[..., [[0, 2], [2, 1]]], frame)
    return FormedSheet(nodes, cells, thickness, axis, heights, tensor[:, :, TO[0], TO[1]], plastic)


def structured(nx: int, ny: int) -> tuple[FloatArray, IntArray]:
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, LENGTH, nx + 1), np.linspace(0, ARC * RADIUS, ny + 1)))
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    return np.column_stack([x, y]), np.column_stack([first, first + 1, first + nx + 2, first + nx + 1]).astype(np.int32)


def scattered(seed: int, size: float) -> tuple[FloatArray, IntArray]:
    """Return triangles between points that lie anywhere, those of the rim on it."""
    rng = np.random.default_rng(seed)
    nx, ny = (max(2, round(side / size)) for side in (LENGTH, ARC * RADIUS))
    flat, _ = structured(nx, ny)
    inside = (flat > 1e-9).all(axis=1) & (flat < [LENGTH - 1e-9, ARC * RADIUS - 1e-9]).all(axis=1)
    flat[inside] += rng.uniform(-0.3, 0.3, (inside.sum(), 2)) * size
    triangles = Delaunay(flat).simplices
    a, b, c = flat[triangles].swapaxes(0, 1)
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangles = triangles[np.abs(area) > 1e-9]
    turned = np.where((area[np.abs(area) > 1e-9] < 0)[:, None], triangles[:, ::-1], triangles)
    return flat, turned[:, [0, 1, 2, 2]].astype(np.int32)


PART = sheet_on(*structured(30, 14))


def as_mesh(flat: FloatArray, cells: IntArray) -> ShellMesh:
    return ShellMesh(bend(flat), cells, np.arange(len(flat)) + 1, np.arange(len(cells)) + 1)


@pytest.mark.parametrize(("seed", "size"), [(1, 2.4), (2, 4.0), (3, 6.0)])
def test_known_fields_on_scattered_triangles(seed: int, size: float) -> None:
    """Thickness within 1 %, against the field itself; strain energy within 2 % of that of the part."""
    flat, cells = scattered(seed, size)
    wanted = sheet_on(flat, cells)
    mapped = map_sheet(PART, as_mesh(flat, cells))
    assert mapped.is_covered.all()
    np.testing.assert_allclose(mapped.sheet.thickness, wanted.thickness, rtol=0.01)
    np.testing.assert_allclose(mapped.sheet.plastic_strain, wanted.plastic_strain, atol=0.006)
    found, known = (lamina_stress(sheet, lamina_frames(sheet)) for sheet in (mapped.sheet, wanted))
    np.testing.assert_allclose(found, known, atol=0.03 * np.abs(known).max())
    energies = [elastic_energy(sheet, 206e3, 0.3) for sheet in (PART, mapped.sheet)]
    assert energies[1] == pytest.approx(energies[0], rel=0.02)


def test_linear_fields_are_exact_on_a_flat_part() -> None:
    flat, cells = structured(8, 5)
    part = sheet_on(flat, cells)
    middle = flat[cells].mean(axis=1)
    points = np.column_stack([flat, np.zeros(len(flat))])
    part = replace(part, points=points, thickness=1.0 + 0.002 * middle[:, 0] - 0.003 * middle[:, 1])
    other, triangles = scattered(4, 6.0)
    mesh = ShellMesh(np.column_stack([other, np.zeros(len(other))]), triangles, np.arange(len(other)), np.arange(1))
    found = map_sheet(part, mesh).sheet.thickness
    own = other[triangles[:, :3]].mean(axis=1)
    np.testing.assert_allclose(found, 1.0 + 0.002 * own[:, 0] - 0.003 * own[:, 1], atol=1e-9)


def test_a_mesh_whose_normals_point_the_other_way_has_its_layers_from_the_other_face() -> None:
    flat, cells = structured(13, 7)
    one, other = (map_sheet(PART, as_mesh(flat, c)).sheet for c in (cells, cells[:, ::-1].copy()))
    np.testing.assert_allclose(other.stress[:, ::-1], one.stress, atol=1e-5 * np.abs(one.stress).max())
    np.testing.assert_allclose(other.plastic_strain[:, ::-1], one.plastic_strain, atol=1e-4)
    bending = [resultants(s.heights, lamina_stress(s, lamina_frames(s)))[1] for s in (one, other)]
    np.testing.assert_allclose(bending[1], bending[0] * [-1.0, -1.0, 1.0], atol=1e-2)


def test_shells_beyond_the_part_get_no_stress() -> None:
    flat, cells = structured(20, 9)
    wide = flat * [1.5, 1.0]
    mapped = map_sheet(PART, as_mesh(wide, cells))
    beyond = wide[cells].mean(axis=1)[:, 0] > LENGTH + 2.0
    assert not mapped.is_covered[beyond].any()
    assert mapped.is_covered[wide[cells].mean(axis=1)[:, 0] < LENGTH - 3.0].all()
    assert not mapped.sheet.stress[beyond].any()
    np.testing.assert_allclose(mapped.sheet.thickness[beyond], PART.thickness.mean())
    assert len(covered_part(mapped).cells) == mapped.is_covered.sum()


@pytest.mark.parametrize("ending", [".k", ".inp", ".rad", ".bdf", ".vtu", ".stl"])
def test_meshes_of_other_programs_keep_their_numbers(tmp_path: Path, ending: str) -> None:
    sheet = random_sheet(11)
    rng = np.random.default_rng(1)
    labelled = replace(
        sheet,
        node_labels=np.sort(rng.choice(90000, len(sheet.points), replace=False)) + 1,
        cell_labels=np.sort(rng.choice(90000, len(sheet.cells), replace=False)) + 1,
    )
    path = tmp_path / f"crash{ending}"
    if ending in (".vtu", ".stl"):
        quads, triangles = sheet.cells[:8], sheet.cells[8:, :3]
        split = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]], triangles])
        blocks = [("triangle", split)] if ending == ".stl" else [("quad", quads), ("triangle", triangles)]
        meshio.write(path, meshio.Mesh(sheet.points, blocks))
        found = read_shell_mesh(path, 1e3)
        corners = sheet.points[split if ending == ".stl" else sheet.cells[:, :3]]
        np.testing.assert_allclose(found.points[found.cells[:, :3]], 1e3 * corners, rtol=1e-5, atol=1e-2)
        return
    path.write_text(text_of(path, labelled))
    found = read_shell_mesh(path)
    np.testing.assert_allclose(found.points, sheet.points, atol=1e-7)
    np.testing.assert_array_equal(found.node_labels, labelled.node_labels)
    np.testing.assert_array_equal(np.sort(found.cell_labels), labelled.cell_labels)
    order = np.argsort(found.cell_labels)
    np.testing.assert_array_equal(found.cells[order], sheet.cells)


def test_nastran_in_free_and_large_fields(tmp_path: Path) -> None:
    (tmp_path / "a.bdf").write_text(
        "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID*,4,,1.0,0.\n*,2.\n"
        "GRID*                  2                           1.0+0             0.0\n*                    0.0\n"
        "GRID           3             1.0     1.0   1.5-1\nCTRIA3,7,1,1,2,3\nCTRIA3,8,1,1,2,4\nENDDATA\n"
    )
    found = read_shell_mesh(tmp_path / "a.bdf")
    np.testing.assert_allclose(found.points, [[0, 0, 0], [1, 0, 0], [1, 1, 0.15], [1, 0, 2]])
    assert found.cells.tolist() == [[0, 1, 2, 2], [0, 1, 3, 3]]


def test_a_deck_without_a_mesh_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.k").write_text("*KEYWORD\n*INCLUDE\nmesh.k\n*END\n")
    with pytest.raises(MeshError, match="in files that it includes"):
        read_shell_mesh(tmp_path / "a.k")
