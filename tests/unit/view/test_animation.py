# SPDX-License-Identifier: Apache-2.0
"""Films of a run: a picture a saved step, one frame and one scale of colours."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, read_case, run
from presswork.examples import copy_example
from presswork.results import OutputError, Result, ResultError
from presswork.view import animate
from presswork.view.plots.shell_plot import plot_shell

Image = pytest.importorskip("PIL.Image")


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Result:
    folder = tmp_path_factory.mktemp("film")
    settings = ["workpiece.mesh.cells=[4,4]", "output.steps=4"]
    return run(Case.from_toml(copy_example("upsetting_q4", folder), overrides=settings), folder / "out").result


def read_frames(path: Path) -> list[np.ndarray]:
    film = Image.open(path)
    frames = []
    for number in range(film.n_frames):
        film.seek(number)
        frames.append(np.asarray(film.convert("RGB")))
    return frames


def test_gif_has_a_picture_a_step_and_takes_its_time(result: Result, tmp_path: Path) -> None:
    path = animate(result, tmp_path / "film.gif", "equivalent_plastic_strain", seconds=2.0)
    film = Image.open(path)
    assert film.n_frames == len(result.times)
    assert film.info["duration"] == pytest.approx(2000 / len(result.times), abs=10)
    frames = read_frames(path)
    assert {frame.shape for frame in frames} == {frames[0].shape}
    assert all((frames[i] != frames[i + 1]).any() for i in range(len(frames) - 1))


def test_colours_and_frame_are_those_of_all_steps(result: Result, tmp_path: Path) -> None:
    """The start has the lowest colour throughout; the body's height falls, that of the frame does not."""
    frames = read_frames(animate(result, tmp_path / "film.gif", "equivalent_plastic_strain"))
    heights = []
    for frame in (frames[0], frames[-1]):
        left = frame[:, : frame.shape[1] * 3 // 4].astype(int)
        coloured = np.ptp(left, axis=2) > 40
        heights.append(int(coloured.any(axis=1).sum()))
        low = coloured & (np.abs(left - (68, 1, 84)).max(axis=2) < 30)
        assert (low.sum() > 0.8 * coloured.sum()) == (frame is frames[0])
    assert heights[1] == pytest.approx(0.4 * heights[0], rel=0.15)


def test_mp4_is_written_where_the_library_is(result: Result, tmp_path: Path) -> None:
    library = pytest.importorskip("imageio_ffmpeg")
    path = animate(result, tmp_path / "film.mp4", seconds=1.0)
    assert library.count_frames_and_secs(str(path))[0] == len(result.times)


def test_wrong_names_are_refused_before_anything_is_written(result: Result, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"\.gif"):
        animate(result, tmp_path / "film.avi")
    with pytest.raises(ResultError, match="no field"):
        animate(result, tmp_path / "film.gif", "nothing")
    assert not list(tmp_path.iterdir())


def test_colour_bar_of_a_sheet_is_that_of_all_steps(tmp_path: Path) -> None:
    """Of a diverging field, whose bar is cut at its ends: at the start, where all is zero, too."""
    from matplotlib.figure import Figure

    settings = ["blank.element_size=10", "stages.0.tools.punch.stroke=2", "output.steps=1"]
    path = copy_example("square_cup", tmp_path)
    found = run(read_case(path, overrides=settings), tmp_path / "out").result
    figure = Figure()
    plot_shell(found, "thinning", 0, value_range=(-2.0, 5.0), figure=figure)
    assert figure.axes[1].get_ylim() == (-2.0, 5.0)
