# SPDX-License-Identifier: Apache-2.0
"""A picture of a sheet of 100,352 triangles by the renderer off screen and by matplotlib: seconds and their ratio.

Run as `python -m benchmarks.pictures`; it needs pyvista. The first picture starts the renderer and is told by itself.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter

from benchmarks.report_page import write_run
from presswork.results import Result
from presswork.view import faces
from presswork.view.plots.shell_plot import plot_shell
from presswork.view.style import bare_figure, save_picture

ROUNDS = 3


def draw(result: Result, folder: Path, name: str) -> float:
    """Draw the last step and return the seconds that it took."""
    started = perf_counter()
    save_picture(plot_shell(result, "thinning", figure=bare_figure(7.0, 5.2)), folder / f"{name}.png")
    return perf_counter() - started


def main() -> None:
    """Draw in turn and print the least of each."""
    with tempfile.TemporaryDirectory() as place:
        result = write_run(Path(place))
        print(f"first picture, with the start of the renderer: {draw(result, Path(place), 'first'):.2f} s")
        fast, slow, many = [], [], faces.MANY
        for _ in range(ROUNDS):
            faces.MANY = many
            fast.append(draw(result, Path(place), "renderer"))
            faces.MANY = 10**9
            slow.append(draw(result, Path(place), "matplotlib"))
        print(f"renderer {min(fast):.2f} s, matplotlib {min(slow):.2f} s, ratio {min(slow) / min(fast):.1f}")


if __name__ == "__main__":
    main()
