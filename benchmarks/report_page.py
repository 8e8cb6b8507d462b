# SPDX-License-Identifier: Apache-2.0
"""The page of a large run, 100,352 triangles, 20 steps, 5 fields with 1 % noise: size, time to write, open and turn.

Targets: 20 MB, written within 3 s, first picture within 2 s and 20 frames a second in Chromium without a GPU. Run as
`python -m benchmarks.report_page`; it needs Chromium and Playwright. Processor seconds are told beside those of the
clock, which other work on the machine prolongs.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from presswork.model import CellBlock, Mesh
from presswork.report import write_report
from presswork.results import Result, append_step
from tests.regression.browser import Page, chromium

SIDE, STEPS, FRAMES = 224, 20, 40
FIELDS = ("thickness_strain", "equivalent_plastic_strain", "thinning", "effective_stress", "thickness")
TURN = """async ([frames, isCoarse]) => {
  const { viewer } = presswork.stage, gl = viewer.renderer.getContext(), pixel = new Uint8Array(4);
  viewer.setCoarse(isCoarse);
  viewer.drawNow();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  const from = performance.now();
  for (let i = 0; i < frames; i++) {
    viewer.camera.position.applyAxisAngle(viewer.camera.up, 0.05);
    viewer.camera.lookAt(viewer.controls.target);
    viewer.camera.updateMatrixWorld();
    viewer.drawNow();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  }
  return (performance.now() - from) / frames;
}"""


def write_run(folder: Path) -> Result:
    """Write a sheet that is drawn into a round hollow."""
    noise = np.random.default_rng(0)
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-100.0, 100.0, SIDE + 1)] * 2))
    first = (np.arange(SIDE)[:, None] * (SIDE + 1) + np.arange(SIDE)).ravel()
    right, above, across = first + 1, first + SIDE + 1, first + SIDE + 2
    cells = np.concatenate([np.stack([first, right, across], axis=1), np.stack([first, across, above], axis=1)])
    points = np.stack([x, y, 0.0 * x], axis=1)
    mesh = Mesh(points, (CellBlock("shell3_1pt", cells.astype(np.int32), 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    radius, middle = np.hypot(x, y), points[cells].mean(axis=1)
    around = np.hypot(middle[:, 0], middle[:, 1])
    for step in range(STEPS):
        part = step / (STEPS - 1)
        depth = -60.0 * part / (1.0 + np.exp((radius - 50.0) / 6.0)) + 0.05 * noise.normal(size=len(x))
        fields = {
            name: part * (np.exp(-(((around - 50.0) / (10 + k)) ** 2)) + 0.1 * np.sin(middle[:, 0] / 7.0 + k))
            * (1.0 + 0.01 * noise.normal(size=len(cells)))
            for k, name in enumerate(FIELDS)
        }  # fmt: skip
        moved = np.stack([-0.1 * part * x, -0.1 * part * y, depth], axis=1)
        info = {"title": "sheet", "analysis": "shell"}
        append_step(folder / "results.vtkhdf", mesh, 0.01 * step, {"displacement": moved}, fields, info=info)
    return Result(folder)


def processor_seconds(root: int) -> float:
    """Return the processor time of all processes below one [s]."""
    children: dict[int, list[tuple[int, int]]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = path.read_text().rsplit(")", 1)[1].split()
        except OSError:  # it has ended meanwhile
            continue
        children.setdefault(int(words[1]), []).append((int(path.parent.name), int(words[11]) + int(words[12])))
    total, left = 0, [root]
    while left:
        for number, ticks in children.get(left.pop(), []):
            total += ticks
            left.append(number)
    return total / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Write, open and turn the page, and print what it took."""
    with tempfile.TemporaryDirectory() as folder, chromium() as browser:
        result = write_run(Path(folder))
        wall, work = perf_counter(), process_time()
        path = write_report(result)
        wall, work = perf_counter() - wall, process_time() - work
        print(f"written in {wall:.2f} s (processor {work:.2f} s), {path.stat().st_size / 1e6:.1f} MB")
        before = processor_seconds(os.getpid())
        page = Page(browser, path)
        ready = int(page.ask("() => document.documentElement.dataset.ready"))
        print(f"first picture after {ready} ms (processor {processor_seconds(os.getpid()) - before:.2f} s)")
        for is_coarse, words in ((False, "all pixels and triangles"), (True, "fewer, as while it is turned slowly")):
            before = processor_seconds(os.getpid())
            frame = page.ask(TURN, [FRAMES, is_coarse])
            work = 1e3 * (processor_seconds(os.getpid()) - before) / FRAMES
            print(f"a frame in {frame:.0f} ms (processor {work:.0f} ms), {words}")


if __name__ == "__main__":
    main()
