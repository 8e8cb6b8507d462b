# SPDX-License-Identifier: Apache-2.0
"""Pictures by the renderer off screen are those of matplotlib; without it, or where it dies, matplotlib draws."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from presswork.model import CellBlock, Mesh
from presswork.results import Result, append_step
from presswork.view import faces, off_screen
from presswork.view.plots.shell_plot import plot_shell
from presswork.view.style import bare_figure, draw_pixels

pytest.importorskip("matplotlib")


@pytest.fixture
def result(tmp_path: Path) -> Result:
    """A dome of 12 x 12 shells."""
    n = 12
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-10.0, 10.0, n + 1)] * 2))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)
    points = np.stack([x, y, 0.0 * x], axis=1)
    mesh = Mesh(points, (CellBlock("shell4_mitc", cells, 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    moved = np.stack([0.0 * x, 0.0 * x, 8.0 * np.exp(-(x**2 + y**2) / 40.0)], axis=1)
    info = {"title": "dome", "analysis": "shell"}
    values = {"thickness": 1.0 + 0.1 * points[cells].mean(axis=1)[:, 0]}
    append_step(tmp_path / "results.vtkhdf", mesh, 0.5, {"displacement": moved}, values, info=info)
    return Result(tmp_path)


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[pytest.MonkeyPatch]:
    """A renderer that has not drawn yet, for any number of faces."""
    monkeypatch.setattr(faces, "MANY", 1)
    renderer = off_screen._Renderer()
    monkeypatch.setattr(off_screen, "_renderer", renderer)
    yield monkeypatch
    renderer.close()


def draw(result: Result) -> np.ndarray:
    figure = bare_figure(7.0, 5.2)
    return draw_pixels(plot_shell(result, "thickness", figure=figure))[..., :3].astype(float)


def test_renderer_draws_the_picture_that_matplotlib_draws(result: Result, fresh: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyvista")
    rendered = draw(result)
    if off_screen._renderer.has_failed:
        pytest.skip("pyvista cannot draw here without a display")
    fresh.setattr(off_screen, "is_installed", lambda: False)
    drawn = draw(result)
    assert rendered.shape == drawn.shape
    difference = np.abs(rendered - drawn).max(axis=2)
    assert (difference > 0.0).any(), "two programs drew"
    assert (difference > 40.0).mean() < 0.01, "edges of faces alone differ"
    body = drawn.max(axis=2) - drawn.min(axis=2) > 60.0
    assert body.mean() > 0.1
    assert np.abs(rendered[body].mean(axis=0) - drawn[body].mean(axis=0)).max() < 3.0


@pytest.mark.parametrize("program", ["import os; os.abort()", "print('no answer')", "import time; time.sleep(60)"])
def test_picture_is_drawn_where_the_renderer_dies(
    result: Result, fresh: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, program: str
) -> None:
    fresh.setattr(off_screen, "is_installed", lambda: True)
    fresh.setattr(off_screen, "_PROGRAM", (sys.executable, "-c", program))
    fresh.setattr(off_screen, "_LONGEST", 2.0)
    first = draw(result)
    assert [record.message for record in caplog.records if "matplotlib draws" in record.message]
    fresh.setattr(off_screen, "is_installed", lambda: False)
    np.testing.assert_array_equal(first, draw(result))


def test_many_faces_are_drawn_without_a_display_in_a_process_of_its_own(result: Result) -> None:
    program = """if True:
        import sys, logging
        from pathlib import Path
        logging.basicConfig(level="WARNING", stream=sys.stdout)
        from presswork.results import Result
        from presswork.view import faces, off_screen
        from presswork.view.plots.shell_plot import plot_shell
        from presswork.view.style import bare_figure, save_picture
        faces.MANY = 1
        result = Result(Path(sys.argv[1]))
        save_picture(plot_shell(result, "thickness", figure=bare_figure(7.0, 5.2)), Path(sys.argv[1]) / "picture.png")
        print("failed" if off_screen._renderer.has_failed else "drawn")"""
    environment = {key: text for key, text in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment["DISPLAY"] = ":97"  # a display that is not there
    found = subprocess.run(
        [sys.executable, "-c", program, str(result.folder)], env=environment, capture_output=True, text=True, check=True
    )
    assert (result.folder / "picture.png").stat().st_size > 20_000
    assert ("matplotlib draws" in found.stdout) == ("failed" in found.stdout)
