# SPDX-License-Identifier: Apache-2.0
"""Faces and lines in space drawn by pyvista without a display, in a process of its own.

A graphics driver that is missing or broken ends that process and not the program; its pictures are then drawn by
matplotlib. Requests and answers are pickled arrays between the two.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import pickle
import subprocess
import sys
import threading
from dataclasses import dataclass
from importlib.util import find_spec
from typing import IO

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray

logger = logging.getLogger(__name__)

_LONGEST = 60.0
"""Seconds that a picture may take."""
_PROGRAM = (sys.executable, "-P", "-m", "presswork.view.off_screen")


@dataclass(frozen=True)
class Scene:
    """What is drawn, and from where."""

    blocks: tuple[FloatArray, ...]
    """Corners of faces, (n, k, 3) each."""
    colours: NDArray[np.uint8]
    """Red, green, blue of each face (n_faces, 3)."""
    edge_width: float
    """Width of the lines around the faces [pixel]; 0: none."""
    edge_colour: tuple[float, float, float]
    edge_opacity: float
    lines: tuple[tuple[FloatArray, tuple[float, float, float]], ...]
    """Lines (n, 2, 3), each row with its colour."""
    line_width: float
    """[pixel]"""
    middle: FloatArray
    """The place in the middle of the picture (3,)."""
    right: FloatArray
    """Unit vector from left to right in the picture (3,)."""
    up: FloatArray
    """Unit vector upwards (3,)."""
    size: tuple[float, float]
    """Width and height of what is shown, in the unit of the places."""
    pixels: tuple[int, int]
    """Columns and rows of the picture."""


class _Renderer:
    """The process that draws; it starts with the first picture and ends with the program."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self.has_failed = False
        """Whether a picture could not be drawn; no other is asked for then."""

    def draw(self, scene: Scene) -> NDArray[np.uint8] | None:
        """Return the picture (n_rows, n_columns, 4), or None where it cannot be drawn, which is logged once."""
        if self.has_failed:
            return None
        if self._process is None:
            self._process = subprocess.Popen(
                _PROGRAM, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
            atexit.register(self.close)
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        timer = threading.Timer(_LONGEST, process.kill)
        timer.start()
        try:
            _write(process.stdin, scene)
            picture = pickle.load(process.stdout)
            assert isinstance(picture, np.ndarray)
            return picture
        except Exception:  # whatever is left of an answer
            self.has_failed = True
            self.close()
            logger.warning(
                "pyvista cannot draw here without a display (it needs EGL or OSMesa); matplotlib draws, more slowly"
            )
            return None
        finally:
            timer.cancel()

    def close(self) -> None:
        """End the process."""
        if self._process is None:
            return
        process, self._process = self._process, None
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                assert pipe is not None
                pipe.close()


_renderer = _Renderer()


def is_installed() -> bool:
    """Return whether pyvista is installed."""
    return find_spec("pyvista") is not None


def draw(scene: Scene) -> NDArray[np.uint8] | None:
    """Return the picture (n_rows, n_columns, 4), transparent where nothing is; None where it cannot be drawn."""
    return _renderer.draw(scene)


def _write(stream: IO[bytes], data: object) -> None:
    pickle.dump(data, stream, protocol=pickle.HIGHEST_PROTOCOL)
    stream.flush()


# --- the process that draws ------------------------------------------------------------------------------------------


def render(scene: Scene) -> NDArray[np.uint8]:
    """Return the picture of a scene, drawn in this process."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(scene.pixels), lighting="none")
    first = 0
    for corners in scene.blocks:
        n, k = corners.shape[:2]
        faces = np.column_stack([np.full(n, k), np.arange(n * k).reshape(n, k)]).ravel()
        mesh = pyvista.PolyData(corners.reshape(-1, 3), faces=faces)
        mesh.cell_data["colour"] = scene.colours[first : first + n]
        first += n
        plotter.add_mesh(
            mesh, scalars="colour", rgb=True, lighting=False, show_edges=scene.edge_width > 0.0,
            line_width=max(scene.edge_width, 1.0), edge_color=scene.edge_colour, edge_opacity=scene.edge_opacity,
        )  # fmt: skip
    for row, colour in scene.lines:
        ends = row.reshape(-1, 3)
        cells = np.column_stack([np.full(len(row), 2), np.arange(len(ends)).reshape(-1, 2)]).ravel()
        mesh = pyvista.PolyData(ends, lines=cells)
        plotter.add_mesh(mesh, color=colour, lighting=False, line_width=scene.line_width)
    camera = plotter.camera
    towards = np.cross(scene.right, scene.up)
    camera.focal_point = tuple(scene.middle)
    camera.position = tuple(scene.middle + 10.0 * max(scene.size) * towards)
    camera.up = tuple(scene.up)
    camera.parallel_projection = True
    camera.parallel_scale = 0.5 * scene.size[1]
    plotter.renderer.ResetCameraClippingRange()
    picture = plotter.screenshot(transparent_background=True, return_img=True)
    plotter.close()
    return np.asarray(picture, dtype=np.uint8)


def main() -> None:
    """Draw the scenes that arrive on standard input until it ends."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no answer
    while True:
        try:
            scene = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        _write(answers, render(scene))


if __name__ == "__main__":
    main()
