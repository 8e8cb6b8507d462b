# SPDX-License-Identifier: Apache-2.0
"""Pages of two large runs: size, time to write, open and turn.

A sheet of 100,352 triangles, 20 steps, 5 fields with 1 % noise; and a hot billet of 3,600 quadrilaterals, 61 steps,
between two dies with meshes of their own (4,900 quadrilaterals each) that conduct heat, and a forging in space between
two dies of 40,000 triangles, 61 steps. Targets: 20 MB, written within 3 s, first picture within 2 s and 20 frames a
second in Chromium without a GPU. Run as `python -m benchmarks.report_page`; it needs Chromium and Playwright. Processor
seconds are printed beside those of the clock, which other work on the machine prolongs.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from presswork.model import CellBlock, Mesh
from presswork.report import write_report
from presswork.results import Result, append_step
from tests.regression.browser import Page, chromium

SIDE, STEPS, FRAMES = 224, 20, 40
MANY_STEPS, BILLET, DIE, DIE_SURFACE = 61, 60, 70, 141
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


def make_grid(n: int, low: tuple[float, float], high: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return points (n + 1)^2 of a rectangle [mm], and its n x n quadrilaterals."""
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(a, b, n + 1) for a, b in zip(low, high, strict=True)]))
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return np.column_stack([x, y]), np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)


def write_hot_run(folder: Path) -> Result:
    """Write an upset hot billet between two dies that warm up."""
    points, cells = make_grid(BILLET, (0.0, -30.0), (20.0, 30.0))
    mesh = Mesh(points, (CellBlock("quad4_fbar", cells, 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    shapes = {"upper": make_grid(DIE, (0.0, 30.0), (50.0, 90.0)), "lower": make_grid(DIE, (0.0, -90.0), (50.0, -30.0))}
    middle = points[cells].mean(axis=1)
    for step in range(MANY_STEPS):
        part = step / (MANY_STEPS - 1)
        moved = np.column_stack([0.4 * part * points[:, 0], -0.5 * part * points[:, 1]])
        heat = {"temperature": 1100.0 - 300.0 * part * (np.abs(middle[:, 1]) / 30.0) ** 4}
        fields = {"equivalent_plastic_strain": part * (1.0 - np.abs(middle[:, 1]) / 60.0), **heat}
        dies = {
            name: (p, c, 200.0 + 400.0 * part * np.exp(-np.abs(np.abs(p[:, 1]) - 30.0) / 8.0))
            for name, (p, c) in shapes.items()
        }
        append_step(folder / "results.vtkhdf", mesh, 0.01 * step, {"displacement": moved}, fields, dies=dies,
                    info={"title": "hot billet", "analysis": "axisymmetric"})  # fmt: skip
    return Result(folder)


def write_forging(folder: Path) -> Result:
    """Write a slab pressed between two dies with wavy faces."""
    n = 12
    grid = np.meshgrid(*[np.linspace(-40.0, 40.0, n + 1)] * 2, np.linspace(0.0, 20.0, n + 1), indexing="ij")
    points = np.stack([axis.ravel() for axis in grid], axis=1)
    number = np.arange(len(points)).reshape([n + 1] * 3)
    near = [
        number[i : n + i, j : n + j, k : n + k].ravel() for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    cells = np.stack(near, axis=1).astype(np.int32)
    mesh = Mesh(points, (CellBlock("hex8_fbar", cells, 0),), {}, {}, np.zeros((0, 2), dtype=np.int32))
    flat, sides = make_grid(DIE_SURFACE, (-60.0, -60.0), (60.0, 60.0))
    up = np.concatenate([sides[:, [0, 1, 2]], sides[:, [0, 2, 3]]])
    height = np.cos(flat[:, 0] / 9.0) * np.cos(flat[:, 1] / 9.0)
    tools = {
        "lower": (np.column_stack([flat, height - 1.0]), up),
        "upper": (np.column_stack([flat, 21.0 + height]), up[:, ::-1].copy()),
    }
    middle = points[cells].mean(axis=1)
    for step in range(MANY_STEPS):
        part = step / (MANY_STEPS - 1)
        moved = points * [0.15 * part, 0.15 * part, -0.3 * part]
        strain = {"equivalent_plastic_strain": 0.4 * part * (1.0 + np.sin(middle[:, 0] / 7.0))}
        append_step(folder / "results.vtkhdf", mesh, 0.01 * step, {"displacement": moved}, strain, surfaces=tools,
                    tool_centre={name: np.zeros(3) for name in tools},
                    tool_displacement={"upper": np.array([0.0, 0.0, -6.0 * part])},
                    info={"title": "slab", "analysis": "solid"})  # fmt: skip
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


def measure_opening(browser: Any, result: Result, name: str) -> Page:
    """Write the page of a run and open it, and print what both took."""
    wall, work = perf_counter(), process_time()
    path = write_report(result)
    wall, work = perf_counter() - wall, process_time() - work
    print(f"{name}: written in {wall:.2f} s (processor {work:.2f} s), {path.stat().st_size / 1e6:.1f} MB")
    before = processor_seconds(os.getpid())
    page = Page(browser, path)
    ready = int(page.ask("() => document.documentElement.dataset.ready"))
    work = processor_seconds(os.getpid()) - before
    print(f"{name}: first picture after {ready} ms (processor {work:.2f} s)", flush=True)
    return page


def main() -> None:
    """Write, open and turn the pages, and print what it took."""
    with tempfile.TemporaryDirectory() as root, chromium() as browser:
        for name, write in (("sheet", write_run), ("two heated dies", write_hot_run), ("two dies", write_forging)):
            folder = Path(root) / name
            folder.mkdir()
            page = measure_opening(browser, write(folder), name)
            for is_coarse, words in (
                (False, "all pixels and triangles"),
                (True, "fewer, as while it is turned slowly"),
            ):
                before = processor_seconds(os.getpid())
                frame = page.ask(TURN, [FRAMES, is_coarse])
                work = 1e3 * (processor_seconds(os.getpid()) - before) / FRAMES
                print(f"{name}: a frame in {frame:.0f} ms (processor {work:.0f} ms), {words}", flush=True)
            page.close()


if __name__ == "__main__":
    main()
