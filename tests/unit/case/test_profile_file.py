# SPDX-License-Identifier: Apache-2.0
"""Tool profiles from text files and drawings, and what is said of files that hold none."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import _core, model
from presswork.case import Case, Tool, build_model, describe
from presswork.case.tools.profile_file import read_outline, read_points
from presswork.examples import copy_example
from presswork.geometry.chain import ProfileFileError
from presswork.model import FloatArray

ezdxf = pytest.importorskip("ezdxf")

WALL_FILLET_FACE = [[10, -20, 10, -1, 0, 0, 0], [10, -1, 11, 0, 11, -1, -1], [11, 0, 50, 0, 0, 0, 0]]
PROFILE = "profile = [[0, 15], [30, 15]]"


@pytest.mark.parametrize(
    "text",
    [
        "0,15\n30,16",
        "x,y\n0,15\n30,16\n",
        "# a punch\n\n0 15   # centre\n30\t16\n",
        "x;y\n0;15\n30,0;16,0\n",
        "X [mm]; Y [mm]\n0; 15;\n30; 16;\n",
        "\ufeff0, 1.5e1\r\n0, 15\r\n30, 16\r\n",
    ],
)
def test_points_are_read_whatever_separates_them(tmp_path: Path, text: str) -> None:
    path = tmp_path / "punch.csv"
    path.write_text(text, encoding="utf-8", newline="")
    assert read_points(path)[0] == [(0.0, 15.0), (30.0, 16.0)]
    assert read_points(path, 10.0)[0] == [(0.0, 150.0), (300.0, 160.0)]


@pytest.mark.parametrize(
    ("text", "fragment"),
    [
        ("0,15\n30,abc\n", "line 2: expected two numbers, x and y, but found `30,abc`"),
        ("x,y\n0,15,0\n", "line 2: expected two numbers"),
        ("0,15\n30,nan\n", "line 2: expected two numbers"),
        ("x,y\nmm,mm\n0,15", "line 2: expected two numbers"),
        ("x,y\n0,15\n", "1 points, where a profile needs at least 2"),
        ("0,0\n30,0\n31,0.1\n32,0.3\n33,0.6", "line 2: the curve through the points swings out"),
    ],
)
def test_bad_text_is_refused_with_its_line(tmp_path: Path, text: str, fragment: str) -> None:
    (tmp_path / "punch.csv").write_text(text)
    with pytest.raises(ProfileFileError, match="^" + fragment.replace("(", r"\(")):
        read_outline(tmp_path / "punch.csv", Tool(profile_file="punch.csv", contact="sticking"))


def test_file_is_found_beside_the_case_which_stays_runnable_from_anywhere(
    write_case: Callable[..., Path], tmp_path: Path
) -> None:
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "punch.csv").write_text("0,1.5\n3,1.5\n")
    path = write_case((PROFILE, 'profile_file = "tools/punch.csv"\nunit = "cm"'))
    built = build_model(Case.from_toml(path))
    np.testing.assert_allclose(built.tools[0].profile.segments, [[30, 15, 0, 15, 0, 0, 0]])
    elsewhere = tmp_path / "elsewhere" / "case.toml"
    elsewhere.parent.mkdir()
    elsewhere.write_text(built.case_text)
    np.testing.assert_array_equal(
        build_model(Case.from_toml(elsewhere)).tools[0].profile.segments, built.tools[0].profile.segments
    )


def test_text_is_a_smooth_curve_unless_it_is_a_polyline(tmp_path: Path) -> None:
    angles = np.linspace(np.pi, 2 * np.pi, 25)
    np.savetxt(tmp_path / "punch.csv", 20.0 * np.column_stack([np.cos(angles), np.sin(angles)]), delimiter=",")

    def read(**options: Any) -> FloatArray:
        return read_outline(
            tmp_path / "punch.csv", Tool(profile_file="punch.csv", contact="sticking", **options)
        ).segments

    assert read()[:, 6].all()
    assert not read(curve="polyline")[:, 6].any()
    assert len(read(tolerance=1e-6)) > len(read())
    assert not read(corner_angle=5.0)[:, 6].any(), "the chords turn by 7.5 degrees"
    assert len(read(curve="polyline", closed=True)) == 25


@pytest.mark.parametrize(
    ("changes", "fragments"),
    [
        ('profile_file = "punch.csv"', ["tools.punch.profile_file", "no such file", "relative to the case"]),
        (PROFILE + '\nprofile_file = "a.csv"', ["tools.punch.profile_file", "both given", "one of them"]),
        (PROFILE + '\nunit = "cm"', ["tools.punch.unit", "no meaning without profile_file"]),
        ('profile_file = "a.csv"\nunit = "kg"', ['tools.punch.unit = "kg"', "unit of length"]),
        ('profile_file = "a.csv"\nlayer = "die"', ["tools.punch.layer", "text file"]),
        ('profile_file = "a.dxf"\ncurve = "spline"', ["tools.punch.curve", "lines and arcs stay"]),
        (PROFILE + "\ntolerance = 0.1", ["tools.punch.tolerance", 'curve = "spline" only']),
        (
            'curve = "spline"\nprofile = [[0, 15], {to = [9, 15], radius = 1}, [30, 18]]',
            ["tools.punch.profile.1", "no radius and no arc"],
        ),
    ],
)
def test_keys_that_do_not_go_together_are_refused(
    fail_case: Callable[..., str], changes: str, fragments: list[str]
) -> None:
    message = fail_case((PROFILE, changes))
    for fragment in fragments:
        assert fragment in message


Draw = Callable[[Any, Any], None]


def draw_parts(space: Any, _: Any) -> None:
    """A fillet, a wall and a face, in no order, the face drawn towards the fillet."""
    space.add_arc((11, -1), 1, 90, 180)
    space.add_line((10, -20), (10, -1))
    space.add_line((50, 0), (11, 0))


def draw_polyline(space: Any, _: Any) -> None:
    bulge = -math.tan(math.pi / 8)
    space.add_lwpolyline([(10, -20, 0), (10, -1, bulge), (11, 0, 0), (50, 0, 0)], format="xyb")


def draw_block(space: Any, drawing: Any) -> None:
    draw_parts(drawing.blocks.new("DIE"), drawing)
    space.add_blockref("DIE", (0, 0), dxfattribs={"layer": "die"})
    space.add_line((0, 0), (1, 5), dxfattribs={"layer": "axis"})


def draw_mirrored(space: Any, _: Any) -> None:
    """The same, its arc in a coordinate system that looks from behind."""
    space.add_line((10, -20), (10, -1))
    space.add_arc((-11, -1), 1, 0, 90, dxfattribs={"extrusion": (0, 0, -1)})
    space.add_line((11, 0), (50, 0))


def draw_twice(space: Any, drawing: Any) -> None:
    draw_parts(space, drawing)
    draw_parts(space, drawing)


def read(tmp_path: Path, draw: Draw, units: int = 4, **options: Any) -> FloatArray:
    drawing = ezdxf.new(units=units)
    draw(drawing.modelspace(), drawing)
    drawing.saveas(tmp_path / "die.dxf")
    return read_outline(tmp_path / "die.dxf", Tool(profile_file="die.dxf", contact="sticking", **options)).segments


@pytest.mark.parametrize("draw", [draw_parts, draw_polyline, draw_mirrored])
def test_lines_and_arcs_of_a_drawing_are_joined_exactly(tmp_path: Path, draw: Draw) -> None:
    np.testing.assert_allclose(read(tmp_path, draw), WALL_FILLET_FACE, atol=1e-12)


def test_units_are_the_drawings_own_or_those_given(tmp_path: Path) -> None:
    scale = np.array([1, 1, 1, 1, 1, 1, 0])
    expected = np.array(WALL_FILLET_FACE, dtype=float)
    for options, factor in (({"units": 1}, 25.4), ({"units": 0}, 1.0), ({"units": 1, "unit": "cm"}, 10.0)):
        found = read(tmp_path, draw_parts, **options)
        np.testing.assert_allclose(found, expected * np.where(scale, factor, 1.0), atol=1e-9)


@pytest.mark.parametrize("header", ["", "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n"])
def test_a_drawing_that_names_no_unit_is_in_mm(tmp_path: Path, header: str) -> None:
    line = "0\nLINE\n8\n0\n10\n3\n20\n4\n11\n30\n21\n4\n"
    text = f"{header}0\nSECTION\n2\nENTITIES\n{line}0\nENDSEC\n0\nEOF\n"
    (tmp_path / "die.dxf").write_text(text)
    tool = Tool(profile_file="die.dxf", contact="sticking")
    np.testing.assert_allclose(read_outline(tmp_path / "die.dxf", tool).segments[:, :4], [[3, 4, 30, 4]])


def test_blocks_are_taken_apart_and_layers_told_apart(tmp_path: Path) -> None:
    np.testing.assert_allclose(read(tmp_path, draw_block, layer="DIE"), WALL_FILLET_FACE, atol=1e-12)
    with pytest.raises(ProfileFileError, match=r"nothing is drawn on the layer `dye`; did you mean `die`"):
        read(tmp_path, draw_block, layer="dye")
    with pytest.raises(ProfileFileError, match=r"3 of 4 pieces are connected.*name its layer"):
        read(tmp_path, draw_block)


def test_what_is_drawn_twice_counts_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        assert len(read(tmp_path, draw_twice)) == 3
    assert "the ARC from (11, 0) to (10, -1) is drawn twice" in caplog.text


def test_a_small_gap_is_closed_by_the_line_and_a_wide_one_is_named(tmp_path: Path) -> None:
    def draw(space: Any, _: Any) -> None:
        space.add_arc((11, -1), 1, 90, 180)
        space.add_line((10, -20), (10.0004, -1.0003))

    np.testing.assert_allclose(read(tmp_path, draw, tolerance=1e-3)[0], [11, 0, 10, -1, 11, -1, 1], atol=1e-12)
    np.testing.assert_allclose(read(tmp_path, draw, tolerance=1e-3)[1], [10, -1, 10, -20, 0, 0, 0], atol=1e-12)
    with pytest.raises(ProfileFileError, match=r"gap between \(10, -1\) and \(10.0004, -1.0003\) is 0.0005 mm wide"):
        read(tmp_path, draw)


def test_circles_and_ellipses_are_closed_and_within_the_tolerance(tmp_path: Path) -> None:
    circle = read(tmp_path, lambda space, _: space.add_circle((3, 4), 5), closed=True)
    np.testing.assert_allclose(np.linalg.norm(circle[:, 0:2] - [3, 4], axis=1), 5.0)
    assert len(circle) == 2
    ellipse = read(tmp_path, lambda space, _: space.add_ellipse((0, 0), (40, 0), 0.5), tolerance=1e-3, closed=True)
    angles = np.linspace(0.0, 2 * np.pi, 3000)
    points = np.column_stack([40 * np.cos(angles), 20 * np.sin(angles)])
    assert np.abs(_core.touch_profile(ellipse, points)[0]).max() < 1e-3


def test_spline_of_a_drawing_becomes_arcs_within_the_tolerance(tmp_path: Path) -> None:
    poles = [(0, 0), (10, 0), (20, 8), (30, 8)]

    def draw(space: Any, _: Any) -> None:
        space.add_open_spline(poles)
        space.add_line((30, 8), (60, 8))

    segments = read(tmp_path, draw, tolerance=1e-3)
    t = np.linspace(0.0, 1.0, 2000)[1:-1, None]
    bezier = sum(math.comb(3, k) * t**k * (1 - t) ** (3 - k) * np.array(pole) for k, pole in enumerate(poles))
    gap, *_ = _core.touch_profile(segments, np.ascontiguousarray(bezier))
    assert 1e-5 < np.abs(gap).max() < 1.02e-3
    np.testing.assert_allclose(segments[-1], [30, 8, 60, 8, 0, 0, 0], atol=1e-9)


def add_branch(space: Any, drawing: Any) -> None:
    draw_parts(space, drawing)
    space.add_line((11, 0), (11, 40))


@pytest.mark.parametrize(
    ("draw", "options", "fragment"),
    [
        (add_branch, {}, r"3 pieces meet at \(11, 0\), where a profile has two"),
        (lambda space, _: space.add_text("DIE"), {}, "no LINE, ARC.* but TEXT"),
        (lambda space, _: None, {}, "but nothing"),
        (draw_parts, {"closed": True}, r"chain is open, from \(10, -20\) to \(50, 0\)"),
        (
            lambda space, _: space.add_circle((0, 0), 5, dxfattribs={"extrusion": (0, 1, 0)}),
            {},
            "not drawn in the plane z = 0",
        ),
    ],
)
def test_drawings_without_one_chain_are_refused(
    tmp_path: Path, draw: Draw, options: dict[str, Any], fragment: str
) -> None:
    with pytest.raises(ProfileFileError, match=fragment):
        read(tmp_path, draw, **options)


def test_a_file_that_is_no_drawing_is_refused(tmp_path: Path) -> None:
    (tmp_path / "die.dxf").write_text("hello")
    with pytest.raises(ProfileFileError, match=r"no DXF drawing that can be read .*; export it again"):
        read_outline(tmp_path / "die.dxf", Tool(profile_file="die.dxf", contact="sticking"))


def test_the_example_copies_its_file_and_says_its_shape(tmp_path: Path) -> None:
    path = copy_example("curved_die", tmp_path)
    built: model.Model = build_model(Case.from_toml(path))
    assert "tool die: " in describe(built)
    assert "arcs from (-4, " in describe(built)
    (tmp_path / "curved_die.toml").unlink()
    with pytest.raises(Exception, match=r"curved_die.csv is there already"):
        copy_example("curved_die", tmp_path)
    assert not path.exists(), "nothing is copied by halves"
