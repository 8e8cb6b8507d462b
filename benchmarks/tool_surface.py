# SPDX-License-Identifier: Apache-2.0
"""Time of a call for the nearest place of a rigid tool surface, in ns: plan times profile, and triangles.

Points lie as the nodes of a sheet do, in rows near the surface, and drift by 0.5 um between calls; hints are those of
the call before. One thread. Times are the least of some repetitions.

Usage: python -m benchmarks.tool_surface
"""

from __future__ import annotations

import time

import numpy as np

from presswork import _core
from presswork.geometry.swept_tool import draw_die, draw_punch, triangulate
from presswork.geometry.tool_surface import make_surface


def time_calls(surface: _core.ToolSurface, points: np.ndarray, reach: float, *, warm: bool = True) -> float:
    """Return the least time of a call in ns."""
    hints = surface.nearest(points, reach)[3] if warm else np.full(len(points), -1, dtype=np.int32)
    drift = np.random.default_rng(0).normal(size=points.shape) * 5e-4
    least = float("inf")
    for k in range(15):
        moved = points + k * drift
        start = time.perf_counter()
        found = surface.nearest(moved, reach, hints)
        least = min(least, time.perf_counter() - start)
        if warm:
            hints = found[3]
    return least / len(points) * 1e9


def lay_sheet(surface: _core.ToolSurface, gap: float, n: int) -> np.ndarray:
    """Return about n^2 points of a square sheet, each at the same distance from the surface."""
    x = np.linspace(-45.0, 45.0, n)
    grid = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid, np.full(len(grid), -5.0 + gap)])
    found, normal, place, _ = surface.nearest(points)
    at = place + gap * normal
    return np.ascontiguousarray(at[np.isfinite(found)])


def main() -> None:
    """Print the table."""
    _core.set_threads(1)
    print("ns a call, sheet of 10,000 points; far off: 30 mm away, asked for 1 mm")
    print(f"{'tool':<10}{'triangles':>10}{'on it':>9}{'0.4 mm':>9}{'2 mm':>9}{'no hint':>9}{'far off':>9}")
    punch = draw_punch((25.5, 25.5), 10.0, 4.0, 40.0)
    die = draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=40.0)
    for name, tool in (("punch", punch), ("die", die)):
        smooth = make_surface(tool, 2.0)
        kinds = [(0, smooth)]
        for tolerance, size in ((0.01, float("inf")), (0.05, 1.35)):
            points, triangles = triangulate(tool, tolerance, size=size)
            kinds.append((len(triangles), _core.ToolSurface.triangles(points, triangles, depth=2.0)))
        sheets = [lay_sheet(smooth, gap, 100) for gap in (1e-4, 0.4, 2.0)]
        far = sheets[0] - [0.0, 0.0, 30.0 if name == "punch" else -30.0]
        for count, surface in kinds:
            near = [time_calls(surface, sheet, gap + 0.5) for sheet, gap in zip(sheets, (0.0, 0.4, 2.0), strict=True)]
            cold = time_calls(surface, sheets[1], 0.9, warm=False)
            away = time_calls(surface, far, 1.0)
            print(f"{name:<10}{count or 'smooth':>10}" + "".join(f"{t:>9.0f}" for t in (*near, cold, away)))


if __name__ == "__main__":
    main()
