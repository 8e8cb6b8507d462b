# SPDX-License-Identifier: Apache-2.0
"""The pictures show what the results hold, with names and units."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswork.post import average_to_nodes
from presswork.results import (
    History,
    OutputError,
    Result,
    ResultError,
    ResultMesh,
    append_step,
    history_columns,
)
from presswork.view import (
    plot_all,
    plot_contours,
    plot_flow_lines,
    plot_history,
    plot_interface,
    plot_mesh,
    plot_mesh_and_contours,
)
from presswork.view.extremes import describe_extremes
from presswork.view.plots.flow_lines_plot import space_lines
from presswork.view.style import new_figure
from tests.unit.results.upset_output import DIE, make_fields, make_mesh, write_upset_output

matplotlib = pytest.importorskip("matplotlib")


@pytest.fixture(autouse=True)
def _no_window() -> Iterator[None]:
    from matplotlib import pyplot

    pyplot.switch_backend("Agg")
    yield
    pyplot.close("all")


@pytest.fixture
def result(tmp_path: Path) -> Result:
    """A run of four steps."""
    return Result(write_upset_output(tmp_path / "upset"))


def test_mesh_shows_every_cell_with_its_value_and_unit(result: Result) -> None:
    ax = plot_mesh(result, "effective_stress")
    (cells,) = [c for c in ax.collections if c.get_array() is not None]
    np.testing.assert_array_equal(cells.get_array(), result.field("effective_stress"))
    outline = cells.get_paths()[0].vertices[:4]
    np.testing.assert_allclose(outline, result.points()[result.mesh.blocks[0].connectivity[0]])
    assert ax.child_axes[0].get_ylabel() == "effective stress [MPa]"
    assert ax.get_xlabel().split("\n")[0] == "radius r [mm]"
    assert "die stroke 9.00 mm, height of the workpiece reduced by 60.0 %" in ax.get_title()
    assert ax.get_aspect() == 1.0


@pytest.mark.parametrize("field", ["eqps", "stress_yy", "displacement", "contact_pressure", None])
@pytest.mark.parametrize("elements", [("tri6_6pt", "quad8", "quad9"), ("tri3", "quad4")])
def test_every_kind_of_field_and_cell_is_drawn(tmp_path: Path, field: str | None, elements: tuple[str, ...]) -> None:
    run = Result(write_upset_output(tmp_path, elements, n=6, steps=2))
    plot_mesh(run, field, mirror="xy", show_edges=False).figure.canvas.draw()
    if field:
        plot_contours(run, field, 0, mirror="x").figure.canvas.draw()


def test_mirror_doubles_the_picture(result: Result) -> None:
    assert plot_mesh(result).get_xlim()[0] > -2
    low, high = plot_mesh(result, mirror="x").get_xlim()
    assert low == pytest.approx(-high)


def test_tool_is_drawn_where_it_is(result: Result) -> None:
    ax = plot_mesh(result, step=1)
    (line,) = ax.lines
    np.testing.assert_allclose(line.get_ydata(), 12.0)


def test_tensor_needs_a_component(result: Result) -> None:
    with pytest.raises(ResultError, match="stress_xx"):
        plot_mesh(result, "stress")


@pytest.mark.parametrize("share", [0.1, 1.0])
def test_non_finite_values_leave_holes(tmp_path: Path, share: float) -> None:
    mesh = make_mesh()
    point_data, cell_data = make_fields(mesh, 3.0)
    bad = int(share * len(cell_data["effective_stress"]))
    cell_data["effective_stress"][:bad] = np.nan
    append_step(tmp_path / "results.vtkhdf", mesh, 0.5, point_data, cell_data)
    run = Result(tmp_path)
    plot_mesh_and_contours(run).canvas.draw()
    ax = plot_mesh(run)
    ax.figure.canvas.draw()
    assert "time 0.5 s" in ax.get_title()


def test_labels_below_contours_are_within_the_picture(result: Result) -> None:
    figure = plot_mesh_and_contours(result, step=2)
    figure.canvas.draw()
    assert all(ax.xaxis.label.get_window_extent().y0 > 0.0 for ax in figure.axes)


def test_contours_beside_the_mesh_carry_title_and_stroke(result: Result) -> None:
    figure = plot_mesh_and_contours(result, step=2)
    assert (
        "Upsetting of a billet\ndie stroke 6.00 mm, height of the workpiece reduced by 40.0 %" in figure.get_suptitle()
    )
    assert [ax.get_title().partition("\n")[0] for ax in figure.axes] == ["deformed mesh", "effective stress"]
    values = average_to_nodes(
        result.points(2), [b.connectivity for b in result.mesh.blocks], result.field("effective_stress", 2)
    )
    assert figure.axes[1].get_xlabel().partition("\n")[2] == describe_extremes(values, result.points(2))


def test_stroke_and_reduction_have_a_line_each_in_a_narrow_picture(result: Result) -> None:
    ax = plot_mesh(result, ax=new_figure(5.0, 5.0).subplots())
    assert ax.get_title() == "effective stress\ndie stroke 9.00 mm\nheight of the workpiece reduced by 60.0 %"
    ax.figure.canvas.draw()
    title = ax.title.get_window_extent()
    assert title.x0 >= 0.0
    assert title.x1 <= ax.figure.bbox.x1


def test_the_title_of_a_narrow_picture_is_not_wider_than_the_picture(tmp_path: Path) -> None:
    """A long bar has a narrow picture; each extreme has a line below."""
    mesh = make_mesh()
    point_data, cell_data = make_fields(mesh, 3.0)
    mesh = replace(mesh, points=mesh.points * np.array([0.3, 2.0]))
    append_step(tmp_path / "results.vtkhdf", mesh, 0.5, point_data, cell_data)
    ax = plot_mesh(Result(tmp_path))
    ax.figure.canvas.draw()
    assert "mm\nmin " in ax.get_xlabel()
    title = ax.title.get_window_extent()
    assert title.x0 >= 0.0
    assert title.x1 <= ax.figure.bbox.x1


def test_force_is_drawn_in_kilonewton_against_stroke(result: Result) -> None:
    ax = plot_history(result)
    line, largest = ax.lines
    np.testing.assert_allclose(line.get_xdata(), [0, 3, 6, 9])
    force = result.history["die.force"] / 1000
    np.testing.assert_allclose(line.get_ydata(), force)
    assert largest.get_ydata() == [pytest.approx(np.abs(force).max())]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("die stroke [mm]", "die force [kN]")


def test_the_way_back_of_a_lifted_tool_is_left_out(tmp_path: Path) -> None:
    """Two blows, and between them the tool goes up without force."""
    folder = write_upset_output(tmp_path / "blows")
    (folder / "history.csv").unlink()
    strokes, forces = [0.0, 1.0, 2.0, 1.0, -1.0, 2.0, 3.0], [0.0, 1e5, 2e5, 0.0, 0.0, 1e4, 3e5]
    history = History(folder / "history.csv", history_columns(["die"]))
    for number, (stroke, force) in enumerate(zip(strokes, forces, strict=True)):
        row = {"die.stroke": stroke, "die.force": force, "die.force_x": 0.0, "die.force_y": force, "die.force_z": 0.0}
        history.append({"time": float(number), "stage": "press", "increment": number, "iterations": 3, **row})
    line, _ = plot_history(Result(folder)).lines
    np.testing.assert_array_equal(np.isnan(line.get_xdata()), [False, False, False, True, True, False, False])


def test_any_columns_can_be_chosen(result: Result) -> None:
    ax = plot_history(result, x="time", y="iterations")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time [s]", "iterations")
    assert plot_history(result, y="die.force_y").get_xlabel() == "die stroke [mm]"
    with pytest.raises(ResultError, match=r"no history column punch\.force; there are: time"):
        plot_history(result, y="punch.force")


def test_several_runs_share_a_diagram_and_are_named(result: Result, tmp_path: Path) -> None:
    other = Result(write_upset_output(tmp_path / "fine", n=6))
    texts = [text.get_text() for text in plot_history([result, other]).get_legend().get_texts()]
    assert texts == ["upset", "fine"]
    legend = plot_history([result, other], labels=["4 x 4", "6 x 6"]).get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ["4 x 4", "6 x 6"]


def test_interface_shows_one_curve_per_step(result: Result) -> None:
    figure = plot_interface(result, "die", steps=[1, 3])
    upper, lower = figure.axes
    assert len(upper.lines) == len(lower.lines) == 2
    top = result.points(1)[:, 1] == 12.0
    np.testing.assert_allclose(np.sort(upper.lines[0].get_ydata()), np.sort(result.field("contact_pressure", 1)[top]))
    np.testing.assert_allclose(upper.lines[0].get_xdata(), np.sort(result.points(1)[top, 0]))
    assert upper.get_ylabel() == "contact pressure [MPa]"
    assert lower.get_xlabel() == "radius r [mm]"
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["3.00 mm, 20.0 %", "9.00 mm, 60.0 %"]


def test_interface_shows_what_friction_allows(tmp_path: Path) -> None:
    mesh = make_mesh()
    for step, stroke in enumerate((3.0, 6.0)):
        point_data, cell_data = make_fields(mesh, stroke)
        point_data["friction_limit"] = np.where(point_data["contact_pressure"] > 0, 100.0 + stroke, 0.0)
        append_step(
            tmp_path / "results.vtkhdf",
            mesh,
            float(step),
            point_data,
            cell_data,
            tools={"die": DIE},
            tool_displacement={"die": np.array([0.0, -stroke])},
            info={"title": "friction", "analysis": "axisymmetric"},
        )
    figure = plot_interface(Result(tmp_path), "die")
    upper, lower = figure.axes
    assert not any("limit" in text.get_text() for text in figure.legends[0].get_texts())
    dashed = [line for line in lower.lines if line.get_linestyle() == "--"]
    assert sorted(float(line.get_ydata()[0]) for line in dashed) == [-106.0, 106.0], "at the last step, both ways"
    assert [text.get_text() for text in lower.get_legend().get_texts()] == ["friction limit, last step shown"]
    assert all(line.get_linestyle() == "-" for line in upper.lines)


def test_interface_can_be_drawn_along_its_length(result: Result) -> None:
    assert "arc length" in plot_interface(result, x="arc_length").axes[1].get_xlabel()


def test_interface_without_contact_says_so(result: Result) -> None:
    assert [text.get_text() for text in plot_interface(result, steps=[0]).axes[0].texts] == ["no contact"]


def test_all_pictures_are_written_as_png(result: Result) -> None:
    paths = plot_all(result)
    assert sorted(path.name for path in paths) == [
        "contours_effective_stress_003.png",
        "contours_equivalent_plastic_strain_003.png",
        "force_stroke.png",
        "interface_die.png",
        "mesh_effective_stress_003.png",
        "mesh_equivalent_plastic_strain_003.png",
    ]
    for path in paths:
        assert path.parent == result.folder / "plots"
        assert path.read_bytes().startswith(b"\x89PNG")


def test_chosen_pictures_go_to_the_chosen_folder(result: Result, tmp_path: Path) -> None:
    names = {path.name for path in plot_all(result, tmp_path / "pictures", fields=["eqps"], steps=[0, -2])}
    assert {"contours_eqps_000.png", "contours_eqps_002.png"} < names


def test_wrong_field_step_or_folder_writes_nothing(result: Result, tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="did you mean"):
        plot_all(result, fields=["efective_stress"])
    with pytest.raises(ResultError, match="no step 9"):
        plot_all(result, steps=[9])
    with pytest.raises(OutputError, match="parent folder"):
        plot_all(result, tmp_path / "no" / "pictures")
    assert not (result.folder / "plots").exists()


def test_missing_matplotlib_is_named_with_the_remedy(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for plot in (plot_mesh, plot_history, plot_interface, plot_all):
        with pytest.raises(ImportError, match=r"pip install \"presswork\[plot\]\""):
            plot(result)


def test_grain_flow_draws_lines_of_the_first_places_of_the_material(result: Result, tmp_path: Path) -> None:
    """Every line has its place at the start; the lines of a section that kept its mesh are drawn when asked for."""
    ax = plot_flow_lines(result, mirror="x")
    lines = [c for c in ax.collections if isinstance(c, matplotlib.contour.ContourSet)]
    assert len(lines) == 4
    for axis in (0, 1):
        places, start = space_lines(result.mesh.points)[axis], result.mesh.points[:, axis]
        np.testing.assert_array_equal(lines[axis].levels, places)
        assert start.min() < places[0] < places[-1] < start.max()
    assert "initial radius every" in ax.get_title()
    names = {path.name for path in plot_all(result, tmp_path / "flow", fields=["eqps"], flow_lines=True)}
    assert "flow_lines_003.png" in names
    sheet = Result(result.folder)
    sheet.mesh = ResultMesh(np.zeros((4, 3)), (), np.zeros((0, 2), dtype=np.int64))
    with pytest.raises(ResultError, match="no section with grain flow"):
        plot_all(sheet, tmp_path / "none", flow_lines=True)
    assert not (tmp_path / "none").exists()
