# SPDX-License-Identifier: Apache-2.0
"""Outline and sections of a sheet whose places are known: a plate, drawn in by known parts."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from presswork.mesh.make.blanks import assign_section, mesh_rectangular_blank
from presswork.model import Section
from presswork.post import (
    cut_sheet,
    fit_flange,
    measure_draw_in,
    measure_draw_in_around,
    trace_outline,
    write_draw_in,
    write_section,
)
from presswork.results import OutputError, Result, ResultError, append_step, write_outline
from presswork.view import plot_all, plot_outline
from presswork.view.plots.section_plot import plot_section

DRAWN = np.array([-0.1, -0.2, 0.0])
"""Displacement gradient along x and y; z is 0.5 x."""


def plate(folder: Path, planes: str, width: float = 20.0) -> Result:
    """40 mm long in cells of 2 mm, or what symmetry planes leave; thickness 1 + x/100 at the middles of cells."""
    mesh = mesh_rectangular_blank((40.0, width), 2.0, [axis in planes for axis in "xy"])
    mesh = assign_section(mesh, {"quad4": "shell4_1pt"}, Section(1.0), 0)
    moved = mesh.points * DRAWN + np.array([0.0, 0.0, 0.5]) * mesh.points[:, :1]
    thickness = 1 + mesh.points[mesh.blocks[0].connectivity, 0].mean(axis=1) / 100
    info = {"title": "plate", "analysis": "stamping", "symmetry": planes}
    for part in (0.0, 1.0):
        cells = {"thickness": thickness, "thickness_strain": np.log(thickness)}
        append_step(folder / "results.vtkhdf", mesh, part, {"displacement": part * moved}, cells, info=info)
    return Result(folder)


@pytest.mark.parametrize("planes", ["", "x", "y", "xy"])
def test_the_outline_is_that_of_the_whole_part_whatever_planes_cut_it(tmp_path: Path, planes: str) -> None:
    """A rectangle of 36 x 16 mm: perimeter 104 mm, area 576 mm2, 60 points, in one turn."""
    (loop,) = trace_outline(plate(tmp_path, planes))
    x, y = loop[:, 0], loop[:, 1]
    sides = np.linalg.norm(np.roll(loop, -1, axis=0)[:, :2] - loop[:, :2], axis=1)
    assert len(loop) == 60
    assert sides.sum() == pytest.approx(104)
    assert 0.5 * np.abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) == pytest.approx(576)
    np.testing.assert_allclose(np.abs(loop).max(axis=0)[:2], [18, 8])


def test_the_outline_is_written_as_table_and_drawing(tmp_path: Path) -> None:
    loops = trace_outline(plate(tmp_path, "xy"))
    write_outline(loops, tmp_path / "flange.csv")
    table = np.loadtxt(tmp_path / "flange.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(table[:, 1:], loops[0], rtol=1e-6)
    ezdxf = pytest.importorskip("ezdxf")
    write_outline(loops, tmp_path / "flange.dxf")
    (line,) = ezdxf.readfile(tmp_path / "flange.dxf").modelspace()
    assert line.closed
    np.testing.assert_allclose(np.array(line.get_points("xy")), loops[0][:, :2])
    with pytest.raises(OutputError, match=r"written as \.csv or \.dxf, not as \.txt"):
        write_outline(loops, tmp_path / "flange.txt")


def test_a_section_follows_any_line_from_side_to_side(tmp_path: Path) -> None:
    """Along y = 3 from x = -30: pieces of 2 mm through the middles of cells, heights 0.5 x, places 0.9 x."""
    result = plate(tmp_path, "")
    cut = cut_sheet(result, start=(-30.0, 3.0))
    middles = np.arange(-19.0, 20.0, 2.0)
    np.testing.assert_allclose(cut.distance, middles + 30)
    np.testing.assert_allclose(cut.line[:, :, 0].mean(axis=1), 0.9 * middles + 30)
    np.testing.assert_allclose(cut.line[:, :, 1].mean(axis=1), 0.5 * middles, atol=1e-12)
    np.testing.assert_allclose(result.field("thickness")[cut.cell], 1 + middles / 100)
    across = cut_sheet(result, np.pi / 2, start=(5.0, -50.0))
    np.testing.assert_allclose(across.line[:, :, 0].mean(axis=1), 50 + 0.8 * np.arange(-9.0, 10.0, 2.0))


def test_a_section_that_begins_inside_goes_one_way(tmp_path: Path) -> None:
    cut = cut_sheet(plate(tmp_path, "xy"), start=(7.5, 3.0))
    np.testing.assert_allclose(cut.distance, np.arange(9.0, 20.0, 2.0) - 7.5)


def test_a_slice_one_cell_wide_has_a_draw_in_on_its_sides_too(tmp_path: Path) -> None:
    result = plate(tmp_path, "x", width=2.0)
    assert measure_draw_in(result, np.pi / 2) == pytest.approx(0.2)
    assert measure_draw_in(result, 0.0) == pytest.approx(2.0)


def test_a_whole_section_goes_both_ways_and_a_half_or_quarter_of_a_part_has_one(tmp_path: Path) -> None:
    for symmetry, middles in (("", np.arange(-19.0, 20.0, 2.0)), ("xy", np.arange(1.0, 20.0, 2.0))):
        folder = tmp_path / f"of_{symmetry}"
        folder.mkdir()
        result = plate(folder, symmetry)
        cut = cut_sheet(result, start=(0.0, 3.0), whole=True)
        np.testing.assert_allclose(cut.distance, middles, atol=1e-9)
        left = plot_section(result).axes[0].get_xlim()[0]
        assert left == 0.0 if symmetry else left < -18.0


def test_the_thickness_along_a_section_is_written(tmp_path: Path) -> None:
    write_section(plate(tmp_path, "xy"), tmp_path / "cut.csv", start=(-1.0, 3.0))
    rows = list(csv.DictReader((tmp_path / "cut.csv").open()))
    x = np.arange(1.0, 20.0, 2.0)
    for column, wanted in {
        "undeformed_distance_mm": x + 1, "distance_mm": 0.9 * x + 1, "z_mm": 0.5 * x,
        "thickness_mm": 1 + x / 100, "thickness_strain": np.log(1 + x / 100),
    }.items():  # fmt: skip
        np.testing.assert_allclose([float(row[column]) for row in rows], wanted, rtol=1e-6)


def test_draw_in_is_measured_along_any_direction(tmp_path: Path) -> None:
    """A tenth of 20 mm along x, a fifth of 10 mm along y; at 15 degrees some of each."""
    result = plate(tmp_path, "xy")
    assert measure_draw_in(result, 0.0) == pytest.approx(2.0)
    assert measure_draw_in(result, np.pi / 2) == pytest.approx(2.0)
    c, s = np.cos(np.pi / 12), np.sin(np.pi / 12)
    assert measure_draw_in(result, np.pi / 12) == pytest.approx(20 / c * (0.1 * c**2 + 0.2 * s**2))


def test_chosen_sections_are_drawn_and_written_and_others_refused(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    result = plate(tmp_path, "xy")
    (tmp_path / "history.csv").write_text("time,stage,increment\n")
    plot_all(result, tmp_path / "plots", [], sections=[(-1.0, 3.0, 0.0)])
    names = {path.name for path in (tmp_path / "plots").iterdir()}
    assert {"section_-1_3_0_001.png", "section_-1_3_0_001.csv"} <= names
    with pytest.raises(ResultError, match=r"from \(0, 99\) mm at 0 degrees misses the blank"):
        plot_all(result, tmp_path / "plots", [], sections=[(0.0, 99.0, 0.0)])


@pytest.mark.parametrize(("planes", "low", "high"), [("", 0, 360), ("x", -90, 90), ("y", 0, 180), ("xy", 0, 90)])
def test_draw_in_is_measured_all_round_what_is_computed(tmp_path: Path, planes: str, low: float, high: float) -> None:
    """Where the ray leaves the plate of 40 x 20 mm, the edge has come in by 0.1 x cos + 0.2 y sin."""
    result = plate(tmp_path, planes)
    rows = measure_draw_in_around(result)
    assert (rows[0, 0], rows[-1, 0]) == (low, high)
    c, s = np.abs(np.cos(np.radians(rows[:, 0]))), np.abs(np.sin(np.radians(rows[:, 0])))
    length = np.minimum(20 / np.maximum(c, 1e-9), 10 / np.maximum(s, 1e-9))
    np.testing.assert_allclose(rows[:, 1], length * (0.1 * c**2 + 0.2 * s**2), rtol=1e-6)
    write_draw_in(result, tmp_path / "draw_in.csv")
    np.testing.assert_allclose(np.loadtxt(tmp_path / "draw_in.csv", delimiter=",", skiprows=1), rows, rtol=1e-6)
    figure = plot_outline(result)
    assert figure.axes[0].lines[0].get_xydata().max() == pytest.approx(20)
    np.testing.assert_allclose(figure.axes[1].lines[0].get_xydata(), rows)


@pytest.mark.parametrize("planes", ["", "x", "xy"])
def test_a_flange_that_misses_its_target_is_pulled_back(tmp_path, planes) -> None:
    """A plate drawn in by a constant gradient: corrections lead onto the blank whose image the target is."""
    angle = np.radians(np.arange(0.0, 360.0, 0.5))
    wanted = np.stack([24.0 * np.cos(angle), 16.0 * np.sin(angle)], axis=1)
    fit = fit_flange(plate(tmp_path, planes), wanted * (1.0 + DRAWN[:2]))
    moved = fit.blank + fit.correction
    assert np.hypot(moved[:, 0] / 24.0, moved[:, 1] / 16.0) == pytest.approx(np.ones(len(moved)), abs=1e-4)
    assert np.ptp(fit.blank, axis=0) == pytest.approx([40.0, 20.0])
    outside = np.hypot(fit.drawn[:, 0] / 21.6, fit.drawn[:, 1] / 12.8) > 1.0
    assert (fit.deviation > 0).tolist() == outside.tolist()
    on_axis = np.argmin(np.abs(fit.blank - [20.0, 0.0]).sum(axis=1))
    assert fit.deviation[on_axis] == pytest.approx(18.0 - 21.6, abs=1e-3)
