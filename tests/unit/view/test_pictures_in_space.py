# SPDX-License-Identifier: Apache-2.0
"""Pictures in space: the body fills them, colours of a field with a limit mean it, cracks and dies are seen whole."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from presswork.model import CellBlock, Mesh
from presswork.results import Result, append_step
from presswork.results.whole_file import write_whole
from presswork.view.crack_mark import place_first_crack
from presswork.view.limit_colours import GREEN, RED, YELLOW, find_stops, make_limit_colours
from presswork.view.plots.mesh_plot import _find_colours
from presswork.view.plots.shell_plot import fill_figure, frame_axes, plot_shell
from presswork.view.style import COLOURS
from presswork.view.whole_tools import clip_triangles, find_tool_faces, split_long


@pytest.mark.parametrize("size", [(60.0, 12.0, 7.0), (80.0, 80.0, 25.0), (10.0, 10.0, 40.0)])
def test_body_fills_the_picture_with_titles_above_and_figures_below(size: tuple[float, float, float]) -> None:
    figure = Figure((7.0, 5.2), layout="constrained")
    ax = figure.add_subplot(projection="3d")
    ax.set_proj_type("ortho")
    ax.view_init(28, -58)
    frame_axes(ax, np.zeros(3), np.array(size))
    fill_figure(figure, ax, ["title", "field, step"], "max 3 at (1, 2, 3) mm, min 2 at (0, 0, 0) mm")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    width, height = figure.bbox.width, figure.bbox.height
    frame = np.array([axis.line.get_window_extent().get_points() for axis in (ax.xaxis, ax.yaxis, ax.zaxis)])
    low, high = frame[:, 0].min(axis=0), frame[:, 1].max(axis=0)
    assert max((high - low)[0] / width, (high - low)[1] / height) > 0.45
    title, foot = figure._suptitle.get_window_extent(), figure._supxlabel.get_window_extent()
    labels = [axis.label.get_window_extent() for axis in (ax.xaxis, ax.yaxis, ax.zaxis)]
    for box in labels:
        assert box.y1 < title.y0 + 2.0
        assert box.y0 > foot.y1 - 2.0
        assert box.x0 >= 0.0
        assert box.x1 <= 6.05 / 7.0 * width + 2.0, "beside the colour bar"
    assert title.y1 <= height
    assert foot.y0 >= 0.0


def judged(margin: float, critical: float) -> Any:
    damage = {"damage_oyane": {"critical": critical}}
    return SimpleNamespace(formability=SimpleNamespace(safety_margin=margin), summary={"damage": damage})


def test_margin_is_red_at_the_limit_yellow_at_the_reserve_and_green_beyond() -> None:
    scaled = make_limit_colours(find_stops(judged(0.1, 1.0), "forming_limit_margin", -0.2, 0.8))
    for value, colour in ((0.0, RED), (0.1, YELLOW), (0.8, GREEN)):
        np.testing.assert_allclose(scaled.to_rgba(value)[:3], to_rgb(colour), atol=0.02)
    dark = scaled.to_rgba(-0.2)
    assert dark[0] < to_rgb(RED)[0] - 0.2, "darker where it is torn"


def test_damage_is_red_from_its_critical_value_on_and_other_fields_have_no_limit() -> None:
    result = judged(0.1, 0.5)
    scaled = make_limit_colours(find_stops(result, "damage_oyane", 0.0, 0.45))
    for value, colour in ((0.0, GREEN), (0.4, YELLOW), (0.5, RED)):
        np.testing.assert_allclose(scaled.to_rgba(value)[:3], to_rgb(colour), atol=0.02)
    assert find_stops(result, "effective_stress", 0.0, 1.0) == []
    assert find_stops(result, "damage_lemaitre", 0.0, 1.0) == []


def test_first_crack_is_a_cross_on_top_of_the_sheet(tmp_path: Path) -> None:
    n = 4
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.arange(n + 1.0)] * 2))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)
    points = np.stack([x, y, 0.0 * x], axis=1)
    mesh = Mesh(points, (CellBlock("shell4_mitc", cells, 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    damage = np.linspace(0.0, 1.0, len(cells))
    append_step(tmp_path / "results.vtkhdf", mesh, 1.0, {"displacement": 0.0 * points}, {"damage_oyane": damage},
                info={"title": "cracked", "analysis": "shell"})  # fmt: skip
    crack = '{"cell": 6, "time_s": 0.5, "strokes_mm": {"punch": 3.0}}'
    summary = f'{{"damage": {{"damage_oyane": {{"critical": 0.4, "first_exceeded": {crack}}}}}}}'
    write_whole(tmp_path / "summary.json", summary.encode())
    figure = plot_shell(Result(tmp_path), "damage_oyane")
    crosses = [drawn for drawn in figure.axes[0].collections if drawn.get_zorder() == 20]
    middle = points[cells[6]].mean(axis=0)
    for cross in crosses:
        np.testing.assert_allclose(np.concatenate(cross._offsets3d), middle)
    assert len(crosses) == 2
    assert "first crack (x) at punch 3 mm" in figure.get_supxlabel()
    assert figure.get_suptitle().split("\n")[0] == "cracked"


def test_first_crack_of_a_run_with_new_meshes_is_marked_where_it_began() -> None:
    result: Any = SimpleNamespace(times=[0.0, 1.0], mesh_at=lambda step: SimpleNamespace(step=step))
    crack = {"time_s": 0.5, "at_mm": [1.0, 2.0], "cell": 7}
    np.testing.assert_allclose(place_first_crack(result, crack, 1, np.zeros((4, 2))), [1.0, 2.0])
    assert place_first_crack(result, crack, 0, np.zeros((4, 2))) is None


def test_contours_have_the_colours_of_a_limit_as_the_mesh_has() -> None:
    colours, norm = _find_colours(judged(0.1, 0.5), "damage_oyane", np.array([0.0, 0.6, np.nan]))
    assert norm is not None
    np.testing.assert_allclose(colours(norm(0.5))[:3], to_rgb(RED), atol=0.02)
    assert _find_colours(judged(0.1, 0.5), "effective_stress", np.array([0.0, 0.6])) == (COLOURS, None)


def test_dies_below_are_drawn_whole_and_tools_above_pale_behind_the_part(tmp_path: Path) -> None:
    """Both tools are flat, larger than the sheet between them, and cut off round the frame."""
    points = np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]])
    mesh = Mesh(points, (CellBlock("shell4_mitc", np.arange(4, dtype=np.int32)[None], 0),), {}, {},
                np.zeros((0, 2), dtype=np.int32))  # fmt: skip
    flat = np.array([[-90.0, -90, 0], [90, -90, 0], [90, 90, 0], [-90, 90, 0]])
    up = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    tools = {"die": (flat - np.array([0, 0, 1.0]), up), "punch": (flat + np.array([0, 0, 1.0]), up[:, ::-1].copy())}
    append_step(tmp_path / "results.vtkhdf", mesh, 1.0, {"displacement": 0.0 * points}, {"thickness": np.ones(1)},
                surfaces=tools, tool_centre={name: np.zeros(3) for name in tools},
                info={"title": "flat", "analysis": "stamping"})  # fmt: skip
    figure = plot_shell(Result(tmp_path), "thickness")
    drawn = {float(c.get_facecolor()[0, 3]): c for c in figure.axes[0].collections if c.get_zorder() == 0.5}
    assert sorted(drawn) == [0.25, 1.0], "a pale punch, a whole die"
    part = next(c for c in figure.axes[0].collections if c.get_zorder() == 1.0)
    assert len(part.get_facecolor()) == 1
    corners, _ = find_tool_faces(
        Result(tmp_path), "die", 0, points, np.zeros(3), np.array([10.0, 10, 0]), np.array([0.0, 0.6, 0.8])
    )
    assert (corners[..., :2].min(), corners[..., :2].max()) == (pytest.approx(-1.5), pytest.approx(11.5))


def test_clipped_and_split_triangles_keep_their_area() -> None:
    corners = np.array([[[0.0, 0, 0], [8, 0, 0], [0, 8, 0]]])

    def measure(triangles: np.ndarray) -> float:
        one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
        return float(np.linalg.norm(np.cross(one, other), axis=1).sum() / 2.0)

    small = split_long(corners, 1.0)
    assert measure(small) == pytest.approx(32.0)
    assert np.linalg.norm(np.roll(small, 1, axis=1) - small, axis=2).max() <= 1.0
    assert measure(clip_triangles(corners, np.full(3, -1.0), np.array([5.0, 5, 1]))) == pytest.approx(32.0 - 9.0)
    assert measure(clip_triangles(corners, np.array([1.0, 1, -1]), np.array([9.0, 9, 1]))) == pytest.approx(18.0)
