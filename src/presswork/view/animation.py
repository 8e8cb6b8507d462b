# SPDX-License-Identifier: Apache-2.0
"""A run as a film: a picture a saved step, all with the same frame and the same colours."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from io import BufferedRandom
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.results import OutputError, Result
from presswork.results.whole_file import copy_content, replace_whole
from presswork.view.all_plots import default_fields
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.plots.mesh_plot import plot_mesh
from presswork.view.plots.shell_plot import plot_shell
from presswork.view.style import bare_figure, draw_pixels, require_matplotlib

KINDS = (".gif", ".mp4")
_LAST = 1.5
"""Seconds that the last picture of a GIF stays before it begins anew."""
_NEEDED_BYTES = 20_000_000


def animate(
    result: Result,
    path: Path,
    field: str | None = None,
    *,
    steps: Sequence[int] | None = None,
    seconds: float = 5.0,
) -> Path:
    """Write a film of a field over the saved steps, by default all, and return its path.

    path: ends with .gif or .mp4; the latter needs the library imageio-ffmpeg. field: by default the first that pictures
    of such a run show. seconds: length of the film. Raises OutputError, for a file that cannot be written or a missing
    library, and ResultError for an unknown field or step.
    """
    require_matplotlib()
    if path.suffix not in KINDS:
        raise OutputError(f"{path}: a film is a {' or a '.join(KINDS)} file")
    with result.kept_open():
        name = field or next(name for name in default_fields(result) if name in result.field_names)
        chosen = list(range(len(result.times))) if steps is None else [step % len(result.times) for step in steps]
        pictures = _draw(result, name, chosen)
        rate = len(chosen) / seconds
        with replace_whole(path, needed_bytes=_NEEDED_BYTES) as file:
            (_write_gif if path.suffix == ".gif" else _write_mp4)(file, pictures, rate)
    return path


def _draw(result: Result, field: str, steps: Sequence[int]) -> Iterator[NDArray[np.uint8]]:
    """Yield the pictures (n_rows, n_columns, 3)."""
    finite = [values[np.isfinite(values)] for values in (result.scalar(field, step) for step in steps)]
    inside = np.concatenate([values for values in finite if len(values)] or [np.zeros(1)])
    value_range = float(inside.min()), float(inside.max())
    mirror = cast(Mirror, result.info.get("symmetry", "") if result.is_stamping else "")
    frame = _find_frame(result, steps, mirror)
    is_space = result.is_shell or result.is_space_solid
    for step in steps:
        figure = bare_figure()
        if is_space:
            figure.set_size_inches(7.0, 5.2)
            plot_shell(result, field, step, mirror=mirror, value_range=value_range, frame=frame, figure=figure)
        else:
            figure.set_size_inches(*_choose_size(frame))
            plot_mesh(result, field, step, figure.subplots(), value_range=value_range, frame=frame)
        yield draw_pixels(figure)[..., :3]


def _find_frame(result: Result, steps: Sequence[int], mirror: Mirror) -> tuple[FloatArray, FloatArray]:
    """Return the corners of the box that the body needs in all steps."""
    points = [result.points(step) for step in steps]
    signs = [(*sign, 1)[: points[0].shape[1]] for sign in IMAGES[mirror]]
    low = np.min([(each * sign).min(axis=0) for each in points for sign in signs], axis=0)
    high = np.max([(each * sign).max(axis=0) for each in points for sign in signs], axis=0)
    margin = 0.07 * float(np.max(high - low))
    return low - margin, high + margin


def _choose_size(frame: tuple[FloatArray, FloatArray]) -> tuple[float, float]:
    """Return width and height [inch] of the picture of a section."""
    size = frame[1] - frame[0]
    width = float(np.clip(4.0 * np.sqrt(size[0] / size[1]), 3.0, 7.0))
    return width + 1.6, float(np.clip(width * size[1] / size[0], 2.0, 8.0)) + 1.3


def _write_gif(file: BufferedRandom, pictures: Iterator[NDArray[np.uint8]], rate: float) -> None:
    from PIL import Image

    images = [Image.fromarray(picture) for picture in pictures]
    palette = images[-1].quantize(255)  # the last one has the most colours, and one palette for all does not flicker
    coded = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    pauses = [round(1000 / rate)] * (len(coded) - 1) + [round(1000 * max(_LAST, 1 / rate))]
    coded[0].save(file, "gif", save_all=True, append_images=coded[1:], duration=pauses, loop=0)


def _write_mp4(file: BufferedRandom, pictures: Iterator[NDArray[np.uint8]], rate: float) -> None:
    try:
        from imageio_ffmpeg import write_frames
    except ImportError as error:
        raise OutputError('an MP4 needs imageio-ffmpeg: pip install "presswork[video]"; a GIF does not') from error
    first = next(pictures)
    rows, columns = (2 * (size // 2) for size in first.shape[:2])  # the code of an MP4 takes even numbers alone
    with tempfile.TemporaryDirectory() as place:
        film = Path(place) / "film.mp4"
        writer = write_frames(str(film), (columns, rows), fps=rate, macro_block_size=2)
        writer.send(None)
        for picture in (first, *pictures):
            writer.send(np.ascontiguousarray(picture[:rows, :columns]))
        writer.close()
        copy_content(film, file)
