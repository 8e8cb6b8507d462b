# SPDX-License-Identifier: Apache-2.0
"""Formed sheets in other programs' files, read back by meshio and by the columns of each format's manual."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

from presswork.deck.notes import Notes
from presswork.deck.rad.read import RadDeck
from presswork.mesh.checks import MeshError
from presswork.mesh.files.abaqus import read_abaqus
from presswork.mesh.files.dynain import first_sides, read_dynain
from presswork.mesh.files.formed.layers import (
    elastic_energy,
    in_layers,
    lamina_frames,
    layer_weights,
    resultants,
    shell_areas,
)
from presswork.mesh.files.formed.nastran import LAYER
from presswork.mesh.files.formed.surfaces import Side, take_surface
from presswork.mesh.files.formed.writers import FORMATS, find_format
from presswork.model import FormedSheet
from presswork.process.line.formed_sheet import TO
from tests.problems.formed_sheets import as_matrix, random_sheet, text_of
from tests.problems.rad_deck import MATERIAL, PROPERTY

CURVE = "/FUNCT/1\nflow stress\n                 0.0               200.0\n                 0.5               400.0\n"
RULES = [("gauss", 5), ("simpson", 7), ("lobatto", 6)]


def block(text: str, begin: str) -> list[list[str]]:
    """Return the words of the data lines below a keyword of Abaqus."""
    rows = text.split(begin, 1)[1].split("\n")[1:]
    end = next((i for i, row in enumerate(rows) if row.startswith("*")), len(rows))
    return [[word.strip() for word in row.split(",")] for row in rows[:end] if row]


def bent_sheet(seed: int, rule: str, stress: float) -> FormedSheet:
    """Return a sheet with this stress [MPa] along x of the material on its top, none in its middle."""
    sheet = random_sheet(seed, rule)
    x = lamina_frames(sheet)[:, 0]
    tensor = stress * sheet.heights[None, :, None, None] * (x[:, None, :, None] * x[:, None, None, :])
    return replace(sheet, stress=tensor[:, :, TO[0], TO[1]])


def same_mesh(sheet: FormedSheet, mesh: meshio.Mesh) -> None:
    """Compare with what meshio has read; quadrilaterals come first in both."""
    np.testing.assert_allclose(mesh.points, sheet.points, atol=1e-7)
    is_triangle = sheet.cells[:, 2] == sheet.cells[:, 3]
    np.testing.assert_array_equal(mesh.cells_dict["quad"], sheet.cells[~is_triangle])
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], sheet.cells[is_triangle, :3])


@pytest.mark.parametrize(("rule", "points"), RULES)
def test_abaqus_has_mesh_thickness_axes_and_layers(tmp_path: Path, rule: str, points: int) -> None:
    sheet = random_sheet(1, rule, points)
    text = text_of(Path("part.inp"), sheet)
    (tmp_path / "part.inp").write_text(text)
    same_mesh(sheet, meshio.read(tmp_path / "part.inp"))
    assert {kind: len(np.concatenate(c)) for kind, c in read_abaqus(tmp_path / "part.inp").cells.items()} == {
        "quad4": 8, "tri3": 8
    }  # fmt: skip
    thickness = block(text, "*DISTRIBUTION, NAME=THICKNESS")
    assert thickness[0][0] == ""
    np.testing.assert_allclose([float(t) for _, t in thickness[1:]], sheet.thickness, rtol=1e-8)
    rows = np.array([[float(w) for w in row] for row in block(text, "*INITIAL CONDITIONS, TYPE=STRESS")])
    plastic = np.array([[float(w) for w in row] for row in block(text, "*INITIAL CONDITIONS, TYPE=HARDENING")])
    wanted, own = in_layers(sheet, ("simpson", "gauss"))
    assert f"SECTION INTEGRATION={own.upper()}" in text
    k = len(wanted.heights)
    assert block(text, "*SHELL SECTION")[0][1] == str(k)
    for table in (rows, plastic):
        np.testing.assert_array_equal(table[:, 0], np.repeat(np.arange(1, len(sheet.cells) + 1), k))
        np.testing.assert_array_equal(table[:, 1], np.tile(np.arange(1, k + 1), len(sheet.cells)))
    axes = np.array([[float(w) for w in row[1:]] for row in block(text, "*DISTRIBUTION, NAME=AXES")[1:]])
    one, two = axes[:, None, :3, None], axes[:, None, 3:, None]
    s11, s22, s12 = rows[:, 2:].reshape(-1, k, 3).transpose(2, 0, 1)[..., None, None]
    turned = [np.swapaxes(each, -1, -2) for each in (one, two)]
    back = s11 * one * turned[0] + s22 * two * turned[1] + s12 * (one * turned[1] + two * turned[0])
    np.testing.assert_allclose(back, as_matrix(wanted.stress), atol=1e-4)
    np.testing.assert_allclose(plastic[:, 2].reshape(-1, k), wanted.plastic_strain, rtol=1e-8)


def test_abaqus_section_point_1_is_on_the_face_that_the_normal_leaves() -> None:
    """A sheet bent so that its top is pulled along x of the material: s11 of the last section point is positive."""
    sheet = bent_sheet(2, "simpson", 100.0)
    rows = np.array([[float(w) for w in r] for r in block(text_of(Path("a.inp"), sheet), "TYPE=STRESS")])
    np.testing.assert_allclose(rows[rows[:, 1] == 1, 2], -100.0)
    np.testing.assert_allclose(rows[rows[:, 1] == 5, 2], 100.0)


def test_nastran_has_mesh_thickness_and_material_angle_in_the_manuals_columns(tmp_path: Path) -> None:
    sheet = random_sheet(3)
    text = text_of(Path("part.bdf"), sheet)
    lines = text.splitlines()
    bare = [row[:56] if row.startswith("CQUAD4") else row[:48] if row.startswith("CTRIA3") else row for row in lines]
    (tmp_path / "part.bdf").write_text("\n".join(row for row in bare if not row.startswith("+")) + "\n")
    same_mesh(sheet, meshio.read(tmp_path / "part.bdf"))
    side, normal = first_sides(sheet.points, sheet.cells)
    elements = [(row, lines[i + 1]) for i, row in enumerate(lines) if row.startswith(("CQUAD4", "CTRIA3"))]
    assert len(elements) == len(sheet.cells)
    for (row, more), cell, t, axis, a, n in zip(
        elements, sheet.cells, sheet.thickness, sheet.axis, side, normal, strict=True
    ):
        corners = len(set(cell.tolist()))
        theta = np.radians(float(row[8 * (3 + corners) : 8 * (4 + corners)]))
        np.testing.assert_allclose(np.cos(theta) * a + np.sin(theta) * np.cross(n, a), axis, atol=1e-4)
        assert more[:24].split() == ["+"]  # then T1 in the fourth field
        own = [float(more[i : i + 8]) for i in range(24, 24 + 8 * corners, 8)]
        assert own == pytest.approx([t] * corners, rel=2e-6)
    rows = np.array([[float(w) for w in row.split()[1:]] for row in lines if row.startswith(LAYER)])
    np.testing.assert_allclose(rows[:, 2:8], sheet.stress.reshape(-1, 6), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(rows[:, 8], sheet.plastic_strain.ravel(), rtol=1e-6)
    assert max(len(row) for row in lines if not row.startswith("$")) <= 80


def test_radioss_has_the_columns_of_its_manual_and_is_imported(tmp_path: Path) -> None:
    sheet = random_sheet(7)
    text = text_of(Path("part.rad"), sheet)
    (tmp_path / "part_0000.rad").write_text(text)
    rows = text.split("/INISHE/STRS_F/GLOB\n")[1].split("/INISH3/STRS_F/GLOB\n")
    table = [row for part in rows for row in part.splitlines() if not row.startswith("/")]
    each = 2 + 2 * len(sheet.heights)
    heads = [table[i] for i in range(0, len(table), each)]
    assert [[int(head[i : i + 10]) for i in (0, 10, 20)] for head in heads] == [
        [i + 1, 5, 1] for i in range(len(sheet.cells))
    ]
    np.testing.assert_allclose([float(head[30:50]) for head in heads], sheet.thickness, rtol=1e-11)
    layers = [row for i, row in enumerate(table) if i % each > 1]
    values = np.array([[float(row[i : i + 20]) for row in pair for i in range(0, len(row), 20)] for pair in
                       zip(layers[::2], layers[1::2], strict=True)])  # fmt: skip
    np.testing.assert_allclose(values[:, :6], sheet.stress.reshape(-1, 6), atol=1e-6)
    np.testing.assert_allclose(values[:, 6], sheet.plastic_strain.ravel(), rtol=1e-9)
    np.testing.assert_allclose(values[:, 7], np.tile(sheet.heights, len(sheet.cells)), atol=1e-9)
    whole = text.replace("/END\n", MATERIAL + PROPERTY.format(thickness=1.0) + CURVE + "/END\n")
    (tmp_path / "part_0000.rad").write_text(whole)
    deck = RadDeck(tmp_path / "part_0000.rad", Notes(tmp_path / "part_0000.rad", frozenset())).read()
    assert deck.units is not None
    assert (deck.units.length, deck.units.stress) == (1.0, 1.0)
    np.testing.assert_allclose(deck.points, sheet.points, atol=1e-9)
    assert deck.shells is not None
    np.testing.assert_array_equal(deck.shells.nodes - 1, sheet.cells)
    np.testing.assert_allclose(deck.shells.thickness, sheet.thickness, rtol=1e-11)


def test_dyna_reads_back(tmp_path: Path) -> None:
    sheet = random_sheet(4)
    (tmp_path / "part.k").write_text(text_of(Path("part.k"), sheet))
    back = read_dynain(tmp_path / "part.k")
    for name in ("points", "thickness", "axis", "heights", "stress", "plastic_strain"):
        np.testing.assert_allclose(getattr(back, name), getattr(sheet, name), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(("rule", "points"), [*RULES, ("gauss", 2)])
def test_layers_of_another_rule_bear_the_same_forces_and_moments(rule: str, points: int) -> None:
    sheet = random_sheet(5, rule, points)
    other, found = in_layers(sheet, ("simpson",))
    assert found == "simpson"
    for before, now in zip(*(resultants(each.heights, each.stress) for each in (sheet, other)), strict=True):
        np.testing.assert_allclose(now, before, atol=1e-9)
    assert (other.plastic_strain >= 0).all()


def test_weights_of_layers_of_no_rule_integrate_polynomials() -> None:
    heights = np.array([-0.95, 0.0, 0.95])
    weights = layer_weights(heights)
    assert [float(weights @ heights**p) for p in range(3)] == pytest.approx([2.0, 0.0, 2.0 / 3.0])


def test_elastic_energy_of_a_plate_in_bending() -> None:
    """s on the faces, one way: s^2 t A/(6 E)."""
    sheet = bent_sheet(6, "gauss", 100.0)
    a, b, c, d = sheet.points[sheet.cells].swapaxes(0, 1)
    area = 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1)
    assert elastic_energy(sheet, 70e3, 0.33) == pytest.approx(100.0**2 * (sheet.thickness @ area) / (6 * 70e3))


def test_unknown_ending_names_those_there_are() -> None:
    with pytest.raises(MeshError, match="no ending that a part is exported by"):
        find_format(Path("part.doc"))
    assert len({ending for each in FORMATS for ending in each.endings}) == sum(len(each.endings) for each in FORMATS)


@pytest.mark.parametrize("side", ["middle", "bottom", "top", "skin"])
def test_stl_has_the_faces_half_a_thickness_off_the_middle(tmp_path: Path, side: Side) -> None:
    sheet = random_sheet(8)
    (tmp_path / "part.stl").write_bytes(find_format(Path("part.stl")).write(sheet, "a part", side))
    found = meshio.read(tmp_path / "part.stl")
    corners = found.points[found.cells_dict["triangle"]]
    volume = float(np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)
    if side == "skin":
        assert volume == pytest.approx(float(sheet.thickness @ shell_areas(sheet.points, sheet.cells)), rel=0.01)
        assert b"open edges: 0" in (tmp_path / "part.stl").read_bytes()[:80]
        return
    assert len(corners) == 24
    _, normal = first_sides(sheet.points, sheet.cells)
    off = ((corners[:8].mean(axis=1) - _first_triangles(sheet)) * normal[:8]).sum(axis=1)
    sign = {"bottom": -1.0, "middle": 0.0, "top": 1.0}[side]
    np.testing.assert_allclose(off, sign * 0.5 * sheet.thickness[:8], atol=0.2 if sign else 1e-4)


def _first_triangles(sheet: FormedSheet) -> np.ndarray:
    """Return the middles of the first 8 triangles of its surface."""
    surface = take_surface(sheet, "middle")
    return surface.points[surface.triangles[:8]].mean(axis=1)


def test_step_is_a_solid_of_the_sheets_volume(tmp_path: Path) -> None:
    occ = pytest.importorskip("netgen.occ")
    sheet = random_sheet(9, cells=(2, 2))
    path = tmp_path / "part.step"
    path.write_bytes(find_format(path).write(sheet, "a part", "skin"))
    shape = occ.OCCGeometry(str(path)).shape
    assert len(list(shape.solids)) == 1
    surface = take_surface(sheet, "skin")
    a, b, c = surface.points[surface.triangles].swapaxes(0, 1)
    assert shape.mass == pytest.approx(float(np.einsum("ti,ti->t", a, np.cross(b, c)).sum() / 6.0), rel=1e-6)
