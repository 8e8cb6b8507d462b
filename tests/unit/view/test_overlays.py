# SPDX-License-Identifier: Apache-2.0
"""Several runs in one picture; which tool works at a step; axes from zero; colours with zero in the middle."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork.cli import app
from presswork.results import Result
from presswork.view.plots import overlay_plot
from presswork.view.plots.shell_plot import DIVERGING_COLOURS, scale_colours
from presswork.view.style import _describe_load, bare_figure, begin_at_zero, describe_step
from presswork.view.tool_course import find_course
from tests.unit.results.upset_output import write_upset_output

pytest.importorskip("matplotlib")


class TwoStages:
    """The punch moves in steps 1 and 2, the ejector in 3; nothing in 4."""

    surfaces: dict[str, object] = {}  # noqa: RUF012
    is_onestep = False
    info: dict[str, object] = {}  # noqa: RUF012
    tools = {"punch": np.zeros((1, 7)), "ejector": np.zeros((1, 7))}  # noqa: RUF012
    times = np.arange(5.0)
    _way = {"punch": [0, -4, -9, -9, -9], "ejector": [0, 0, 0, 2, 2]}  # noqa: RUF012

    def tool_displacement(self, tool: str, step: int) -> np.ndarray:
        return np.array([0.0, self._way[tool][step]])

    def keep(self, _: str, find):
        return find()


@pytest.mark.parametrize(("step", "tool"), [(0, "punch"), (1, "punch"), (2, "punch"), (3, "ejector"), (-1, "ejector")])
def test_a_step_is_named_after_the_tool_that_works_then(step, tool) -> None:
    assert find_course(TwoStages()).find_working(step) == tool  # type: ignore[arg-type]


def test_a_one_step_result_is_named_after_blank_and_part() -> None:
    class OneStep:
        is_onestep = True
        times = np.arange(2.0)

    assert [describe_step(OneStep(), step) for step in (0, 1, -1)] == ["blank", "part", "part"]  # type: ignore[arg-type]


def test_a_step_without_tools_is_named_after_what_is_moved_or_its_stage() -> None:
    class Pulled:
        times = np.array([0.0, 0.5, 1.0])
        history: ClassVar[dict[str, object]] = {
            "time": np.array([0.5, 1.0]), "stage": np.array(["pull", "pull"]), "iterations": np.array([4, 4]),
            "grip.displacement_x": np.array([2.6, 5.2]), "side.displacement_y": np.array([0.0, -0.1]),
        }  # fmt: skip

    assert _describe_load(Pulled(), -1) == "grip displaced by 5.2 mm in x"  # type: ignore[arg-type]
    loaded = Pulled()
    loaded.history = {k: v for k, v in Pulled.history.items() if "displacement" not in k}
    assert _describe_load(loaded, 1) == "stage pull, time 0.5 s"  # type: ignore[arg-type]


def test_axes_begin_at_zero_where_nothing_lies_below() -> None:
    upper, lower = bare_figure().subplots(2, 1)
    upper.plot([1.0, 4.0], [300.0, 900.0])
    lower.plot([1.0, 4.0], [-300.0, 900.0])
    for ax in (upper, lower):
        begin_at_zero(ax)
    assert upper.get_xlim()[0] == lower.get_xlim()[0] == 0.0
    assert upper.get_ylim()[0] == 0.0
    assert lower.get_ylim()[0] < -300.0


def test_zero_is_the_middle_of_a_diverging_field() -> None:
    scaled = scale_colours(np.array([-2.0, 5.0, np.nan]), None, diverging=True)
    assert scaled.get_clim() == (-5.0, 5.0)
    assert scaled.get_cmap().name == DIVERGING_COLOURS
    assert scale_colours(np.array([2.0, 5.0]), None, diverging=False).get_clim() == (2.0, 5.0)


def test_two_runs_share_every_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folders = [write_upset_output(tmp_path / name, n=n) for name, n in (("coarse", 4), ("fine", 6))]
    kept = {}
    monkeypatch.setattr(overlay_plot, "save_picture", lambda figure, path: kept.setdefault(path, figure) and path)
    paths = overlay_plot.plot_overlays([Result(folder) for folder in folders], tmp_path / "both")
    assert [path.name for path in paths] == ["force_stroke.png", "interface_die.png"]
    for figure in kept.values():
        axes = figure.axes[0]
        assert [line.get_label() for line in axes.lines] == ["coarse", "fine"]
    pressure = list(kept.values())[1].axes[0].lines
    assert [len(line.get_xdata()) for line in pressure] == [5, 7]


def test_plot_of_two_folders_writes_overlays_alone(tmp_path: Path) -> None:
    folders = [str(write_upset_output(tmp_path / name)) for name in "ab"]
    told = CliRunner().invoke(app, ["plot", *folders, "--out", str(tmp_path / "both")])
    assert told.exit_code == 0, told.output
    assert sorted(path.name for path in (tmp_path / "both").iterdir()) == ["force_stroke.png", "interface_die.png"]
    assert not (tmp_path / "a" / "plots").exists()
