# SPDX-License-Identifier: Apache-2.0
"""Edges of shells that are drawn between ridged tools: any number of threads, a restart, edges that sleep and wake."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from tests.consistency.test_explicit_shells import SWIFT, results

THICKNESS, SIDE = 0.8, 48.0


def ridged_plate(up: bool) -> _core.ToolSurface:
    """Plate in z = 0, metal below (up) or above, with sharp ridges askew to the sheet: a groove every 6.5 mm."""
    n = 60
    s, t = np.meshgrid(np.linspace(-39.0, 39.0, n + 1), np.linspace(-39.0, 39.0, n + 1))
    depth = np.tile(np.where(np.arange(n + 1) % 5 == 2, -0.8, 0.0), n + 1)
    x, y = 24.0 + np.cos(0.3) * s - np.sin(0.3) * t, 24.0 + np.sin(0.3) * s + np.cos(0.3) * t
    points = np.stack([x.ravel(), y.ravel(), depth if up else -depth], axis=1)
    a = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    cells = np.concatenate([np.stack([a, a + 1, a + n + 2], axis=1), np.stack([a, a + n + 2, a + n + 1], axis=1)])
    return _core.ToolSurface.triangles(points, np.ascontiguousarray(cells if up else cells[:, ::-1], dtype=np.int32))


def drawn_sheet(precision: str = "double", *, edges: bool = True, ironing: bool = True) -> ExplicitShells:
    """34 x 34 shells between die and holder, drawn along at 5 m/s: shells enough for a second thread to be woken."""
    n = 34
    x, y = np.meshgrid(np.linspace(0, SIDE, n + 1), np.linspace(0, SIDE, n + 1))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    a = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    cells = np.stack([a, a + 1, a + n + 2, a + n + 1], axis=1).astype(np.int32)
    options = ShellOptions(ironing=ironing)
    sheet = ExplicitShells(points, cells, THICKNESS, SWIFT, 7.85e-9, options=options, precision=precision)  # type: ignore[arg-type]
    sheet.fix(np.flatnonzero(points[:, 0] == SIDE), "u", 5000.0)
    for name, up in (("die", True), ("holder", False)):
        tool = sheet.add_tool(name, ridged_plate(up), mu=0.1, edges=edges)
        tool.position = [0.0, 0.0, (-0.5 if up else 0.5) * THICKNESS]
    sheet.tools["holder"].push([0, 0, -1], 2.0 * SIDE**2)
    return sheet


def state(sheet: ExplicitShells) -> list[np.ndarray]:
    return [*results(sheet), sheet.contact_force, *(tool.force for tool in sheet.tools.values())]


@pytest.mark.parametrize("precision", ["double", "single"])
def test_edges_give_the_same_bits_on_any_threads_and_after_a_restart(precision: str) -> None:
    before, runs = _core.max_threads(), []
    for threads in (1, 2):
        _core.set_threads(threads)
        sheet = drawn_sheet(precision)
        sheet.advance(60)
        dump = sheet.dump()
        sheet.advance(60)
        runs.append(state(sheet))
    _core.set_threads(before)
    again = drawn_sheet(precision)
    again.restore(dump)
    again.advance(60)
    for other in [*runs[1:], state(again)]:
        for a, b in zip(runs[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_edges_that_sleep_wake_in_time() -> None:
    """Nodal forces, means of 200 cycles, beside those of a run that looks at every point in every cycle (as the die is
    put where it is): off by less than a sixteenth of what edges make of them, which is half of them.
    Without ironing, whose springs at the nodes would bear the holder in place of the edges."""
    means = {}
    for kind in ("left alone", "looked at", "nodes alone"):
        sheet = drawn_sheet(edges=kind != "nodes alone", ironing=False)
        means[kind] = np.zeros_like(sheet.contact_force)
        for _ in range(200):
            sheet.advance(1)
            means[kind] += sheet.contact_force / 200
            if kind == "looked at":
                sheet.tools["die"].position = sheet.tools["die"].position
    size, asleep, nodes = (
        np.linalg.norm(means[kind] - base)
        for kind, base in (("looked at", 0.0), ("left alone", means["looked at"]), ("nodes alone", means["looked at"]))
    )
    assert nodes > 0.3 * size
    assert asleep < 0.0625 * nodes
