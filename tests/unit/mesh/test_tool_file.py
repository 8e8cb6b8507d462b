# SPDX-License-Identifier: Apache-2.0
"""Tool surfaces from files: what is mended, what is said, what is refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_die, draw_punch, triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.checks import MeshError
from presswork.mesh.files.stl_file import pack_stl
from presswork.mesh.files.tool_file import read_tool
from presswork.model import Triangulation
from tests.unit.contact.shapes import box_distance, box_triangles

HALF = (20.0, 15.0, 10.0)
POINTS, BOX = box_triangles(HALF)
WHERE = np.random.default_rng(1).uniform(-30.0, 30.0, (500, 3))


def write_stl(path: Path, points: np.ndarray, triangles: np.ndarray, header: str = "tool") -> Path:
    """Write ASCII, facet by facet: unlike a mesh it may hold anything."""
    lines = [f"solid {header}"]
    for triangle in triangles:
        vertices = [f"vertex {x!r} {y!r} {z!r}" for x, y, z in points[triangle].tolist()]
        lines += ["facet normal 0 0 0", "outer loop", *vertices, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, f"endsolid {header}", ""]))
    return path


@pytest.fixture
def stl(tmp_path: Path) -> Path:
    return tmp_path / "tool.stl"


def write_binary(path: Path, header: bytes = b"") -> Path:
    meshio.stl.write(str(path), meshio.Mesh(POINTS, [("triangle", BOX)]), binary=True)
    content = path.read_bytes()
    path.write_bytes(header.ljust(80)[:80] + content[80:])
    return path


@pytest.mark.parametrize("header", [b"made by hand", b"solid in name alone"])
def test_binary_stl_is_read_whatever_its_header(stl: Path, header: bytes) -> None:
    tool, notes = read_tool(write_binary(stl, header), closed=True)
    assert notes == ()
    assert tool.is_closed
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_ascii_stl_is_read_and_scaled(stl: Path) -> None:
    tool, notes = read_tool(write_stl(stl, POINTS / 25.4, BOX), scale=25.4, closed=True)
    assert notes == ()
    assert len(tool.points) == 8
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_quadrilaterals_and_triangles_of_a_mesh_file_are_read(tmp_path: Path) -> None:
    quads = [("quad", np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2]]))]
    mesh = meshio.Mesh(POINTS, [*quads, ("triangle", np.array([[1, 3, 7], [1, 7, 5]]))])
    path = tmp_path / "tool.vtk"
    meshio.vtk.write(str(path), mesh)
    tool, notes = read_tool(path, closed=True)
    assert notes == ()
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_abaqus_shells_are_read(tmp_path: Path) -> None:
    nodes = "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(POINTS.tolist()))
    cells = "\n".join(f"{i + 1}, {a + 1}, {b + 1}, {c + 1}" for i, (a, b, c) in enumerate(BOX.tolist()))
    path = tmp_path / "tool.inp"
    path.write_text(f"*Node\n{nodes}\n*Element, type=S3\n{cells}\n")
    tool, _ = read_tool(path, closed=True)
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_points_nearly_the_same_are_merged(stl: Path) -> None:
    loose = POINTS[BOX].reshape(-1, 3) + np.random.default_rng(2).uniform(-4e-6, 4e-6, (36, 3))
    tool, _ = read_tool(write_stl(stl, loose, np.arange(36).reshape(-1, 3)), closed=True)
    assert len(tool.points) == 8


def test_flipped_facets_are_turned_over_and_said(stl: Path) -> None:
    wrong = BOX.copy()
    wrong[[3, 8]] = wrong[[3, 8], ::-1]
    tool, notes = read_tool(write_stl(stl, POINTS, wrong), closed=True)
    assert len(notes) == 1
    assert "2 of 12 facets are wound against their neighbours, the first near (" in notes[0]
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_closed_surface_inside_out_is_turned_over_and_said(stl: Path) -> None:
    tool, notes = read_tool(write_stl(stl, POINTS, BOX[:, ::-1]))
    assert notes == ("the normals of 12 facets point into the metal: turned over",)
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_hole_in_a_closed_surface_is_refused_with_its_place(stl: Path) -> None:
    path = write_stl(stl, POINTS, BOX[2:])
    with pytest.raises(MeshError, match=r"open rim \(4 edges, 50 mm across, near \(0, 0, -10\)\); close the holes"):
        read_tool(path, closed=True)
    tool, notes = read_tool(path)
    assert not tool.is_closed
    assert "an open rim" in notes[0]


def test_open_rims_of_files_that_the_program_writes_itself_are_not_noted(stl: Path) -> None:
    """Another program's copy of the same facets is; so is a file of ours that has lost facets since."""
    points, triangles = triangulate(draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=30.0), 0.1)
    stl.write_bytes(pack_stl("die", Triangulation(points, triangles, False)))
    tool, notes = read_tool(stl, facing=(0.0, 0.0, 1.0))
    assert not tool.is_closed
    assert notes == ()
    assert "open rim" in read_tool(write_stl(stl, points, triangles), facing=(0.0, 0.0, 1.0))[1][0]
    ours = pack_stl("die", Triangulation(points, triangles, False))
    lost = 84 + 50 * (len(triangles) // 2)
    count = np.uint32(len(triangles) - 1).tobytes()
    stl.write_bytes(ours[:80] + count + ours[84:lost] + ours[lost + 50 :])
    assert "open rim" in read_tool(stl, facing=(0.0, 0.0, 1.0))[1][0]


def test_die_face_is_turned_towards_the_sheet(stl: Path) -> None:
    points, triangles = triangulate(draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=30.0), 0.1)
    path = write_stl(stl, points, triangles[:, ::-1])
    tool, notes = read_tool(path, facing=(0.0, 0.0, 1.0))
    assert "2 open rims" in notes[0]
    assert notes[0].endswith("the sheet passes through those that are holes")
    assert notes[1] == f"the normals of {len(triangles)} facets point into the metal: turned over"
    above = np.array([[40.0, 0.0, 0.5], [40.0, 0.0, -0.5]])
    np.testing.assert_allclose(make_surface(tool, 5.0).nearest(above)[0], [0.5, -0.5], atol=1e-9)
    assert read_tool(path, facing=(0.0, 0.0, -1.0))[1] == notes[:1]
    with pytest.raises(MeshError, match="faces neither along \\(1, 0, 0\\) nor against it"):
        read_tool(path, facing=(1.0, 0.0, 0.0))


def test_facets_without_area_leave_no_seam(stl: Path) -> None:
    """A needle with two corners at one point, and a cap: its middle corner on its own long side."""
    points = np.concatenate([POINTS, [[0.0, -15.0, -10.0]]])  # the middle of the edge 0 1
    t = next(t for t, row in enumerate(BOX.tolist()) if (0, 1) in zip(row, [*row[1:], row[0]], strict=True))
    third = int(np.setdiff1d(BOX[t], (0, 1))[0])
    rest = np.delete(BOX, t, axis=0)
    triangles = np.concatenate([rest, [[0, 8, third], [8, 1, third], [1, 8, 0], [4, 4, 5]]])
    seam = np.concatenate([rest, [[0, 8, third], [8, 1, third]]])
    with pytest.raises(MeshError, match="open rim"):
        read_tool(write_stl(stl, points, seam), closed=True)
    tool, notes = read_tool(write_stl(stl, points, triangles), closed=True)
    assert len(notes) == 1
    assert "2 facets have no area, the first is facet 14 near (" in notes[0]
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], box_distance(WHERE, HALF), atol=1e-12)


def test_doubled_facets_are_dropped_and_said(stl: Path) -> None:
    tool, notes = read_tool(write_stl(stl, POINTS, np.concatenate([BOX, BOX[4:6]])), closed=True)
    assert notes == ("2 facets lie on others with the same corners: left out",)
    assert len(tool.triangles) == 12


def test_edge_of_three_facets_is_refused_with_its_place(stl: Path) -> None:
    wall = np.concatenate([BOX, [[0, 3, 7]]])
    with pytest.raises(MeshError, match=r"edges belong to more than two facets, the first to 3 near \("):
        read_tool(write_stl(stl, POINTS, wall))


def test_two_parts_are_said_and_keep_their_own_sides(stl: Path) -> None:
    """Two boxes that touch along an edge's corner point, one of them inside out."""
    points = np.concatenate([POINTS, POINTS + 2.0 * np.array(HALF)])
    triangles = np.concatenate([BOX, BOX[:, ::-1] + 8])
    tool, notes = read_tool(write_stl(stl, points, triangles), closed=True)
    assert "2 parts that share no edge (12 facets in x -20 to 20, y -15 to 15, z -10 to 10; 12 facets in x" in notes[0]
    assert notes[1] == "the normals of 12 facets point into the metal: turned over"
    both = np.minimum(box_distance(WHERE, HALF), box_distance(WHERE - 2.0 * np.array(HALF), HALF))
    np.testing.assert_allclose(make_surface(tool).nearest(WHERE)[0], both, atol=1e-12)


def test_band_with_one_side_is_refused(stl: Path) -> None:
    n = 24
    angle = np.arange(n) * 2.0 * np.pi / n
    across = np.column_stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)])
    middle = 10.0 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])
    points = np.concatenate([middle - 2.0 * across, middle + 2.0 * across])
    triangles = []
    for i in range(n):
        a, b, c, d = i, i + n, i + 1, i + 1 + n
        if i == n - 1:
            c, d = n, 0
        triangles += [[a, c, b], [c, d, b]]
    with pytest.raises(MeshError, match="one side only"):
        read_tool(write_stl(stl, points, np.array(triangles)))


@pytest.mark.parametrize(
    ("factor", "fault"),
    [(1e-3, r'0.05385 mm across.*give its unit: "m" \(53.85 mm\)'), (1e3, r'5.385e\+04 mm across.*"um" \(53.85 mm\)')],
)
def test_a_tool_in_another_unit_is_refused_with_the_units_that_fit(stl: Path, factor: float, fault: str) -> None:
    with pytest.raises(MeshError, match=fault):
        read_tool(write_stl(stl, POINTS * factor, BOX))


def test_file_cut_short_is_refused(stl: Path) -> None:
    content = write_binary(stl).read_bytes()
    stl.write_bytes(content[:-70])
    with pytest.raises(MeshError, match="cut short"):
        read_tool(stl)
    text = write_stl(stl, POINTS, BOX).read_text()
    stl.write_text(text[: text.rindex("facet normal")])
    with pytest.raises(MeshError, match="cut short"):
        read_tool(stl)
    write_stl(stl, POINTS, BOX[:0])
    with pytest.raises(MeshError, match="no triangles or quadrilaterals"):
        read_tool(stl)


def test_surface_written_and_read_is_the_same(stl: Path) -> None:
    drawn = draw_punch((25.5, 20.0), 10.0, 4.0, 30.0)
    points, triangles = triangulate(drawn, 0.02)
    tool, notes = read_tool(write_stl(stl, points, triangles), facing=(0.0, 0.0, -1.0))
    assert len(notes) == 1  # its open top
    assert len(tool.triangles) == len(triangles)
    gap = make_surface(drawn).nearest(WHERE)[0]
    near = np.abs(gap) < 3.0
    assert np.abs(make_surface(tool).nearest(WHERE)[0] - gap)[near].max() < 0.02


@pytest.mark.parametrize("scale", [1e3, 1e-3])
def test_a_wrong_unit_names_the_right_one_first(stl: Path, scale: float) -> None:
    """The block is 54 across in the file's own numbers: whatever unit was given, these are millimetres."""
    with pytest.raises(MeshError, match=r'give its unit: "mm" \(53.85 mm\) or "cm"'):
        read_tool(write_stl(stl, POINTS, BOX), scale=scale)


def test_the_unit_that_fits_the_blank_is_named_first(stl: Path) -> None:
    """The block of 54 is 538 mm across in cm, 1,368 mm in inches."""
    for usual, first in ((60.0, "mm"), (500.0, "cm"), (1500.0, "inch")):
        with pytest.raises(MeshError, match=f'give its unit: "{first}"'):
            read_tool(write_stl(stl, POINTS, BOX), scale=1e-3, usual_size=usual)
