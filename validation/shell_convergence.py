# SPDX-License-Identifier: Apache-2.0
"""Print and draw the convergence of shells over meshes and thickness, on regular and graded meshes: who locks.

Run: python -m validation.shell_convergence docs/img (writes shell_convergence.png and shell_thickness.png)
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from presswork.model import ElementName
from tests.problems import shell_linear as linear

ELEMENTS: dict[ElementName, str] = {
    "shell3_mitc": "C0", "shell3_mitc_plus": "C9", "shell6_mitc": "C4", "shell4": "0.6", "shell4_mitc": "C3",
    "shell4_mitc_plus": "C1", "shell8_reduced": "C5", "shell9_reduced": "C8", "shell9_mitc": "C2",
}  # fmt: skip
MESHES: dict[str, tuple[Callable[..., float], float]] = {
    "roof": (linear.scordelis_lo, linear.ROOF),
    "cylinder": (linear.pinched_cylinder, linear.CYLINDER),
    "hemisphere with hole": (linear.hemisphere, linear.HEMISPHERE),
    "closed hemisphere": (linear.closed_hemisphere, linear.CLOSED_HEMISPHERE),
    "hypar, t/L = 1/1000": (lambda e, n, **mesh: linear.hypar(e, n, 1e-3, **mesh), linear.HYPAR[1e-3]),
    "Cook's membrane": (linear.cook, 1.0),
}
INTERVALS = (4, 8, 16)
SLENDER = (1e-1, 1e-2, 1e-3, 1e-4)
THICKNESS: dict[str, Callable[..., float]] = {
    "clamped plate": lambda e, n, t, **mesh: linear.plate(e, n, t, **mesh),
    "roof": lambda e, n, t, **mesh: linear.scordelis_lo(e, n, 25 * t, **mesh),
    "cylinder": lambda e, n, t, **mesh: linear.pinched_cylinder(e, n, 300 * t, **mesh),
    "hemisphere with hole": lambda e, n, t, **mesh: linear.hemisphere(e, n, 10 * t, **mesh),
    "hypar": lambda e, n, t, **mesh: linear.hypar(e, n, t, **mesh),
}
"""Thickness over length or radius."""


def compute(problem: Callable[..., float], element: ElementName, intervals: int, *values: float, **mesh: Any) -> float:
    """Return a problem's answer on so many node intervals a side; two triangles a square."""
    if element[5] in "36":
        mesh["pattern"] = "right"
    return problem(element, intervals // 2 if element[5] in "689" else intervals, *values, **mesh)


def draw_meshes(path: Path) -> None:
    """Answers over reference against the mesh."""
    figure, axes = plt.subplots(2, 3, figsize=(12, 7), layout="constrained")
    for axis, (name, (problem, reference)) in zip(axes.flat, MESHES.items(), strict=True):
        for element, colour in ELEMENTS.items():
            for distortion, style in ((0.0, "o-"), ("graded", "o:")):
                found = [compute(problem, element, n, distortion=distortion) / reference for n in INTERVALS]
                report(name, element, distortion, found)
                label = element if distortion == 0.0 else None
                axis.plot(INTERVALS, found, style, color=colour, ms=3, label=label)
        finish(axis, name, "node intervals a side")
        axis.set_xticks(INTERVALS, [str(n) for n in INTERVALS])
        axis.minorticks_off()
    axes[0, 0].set_ylabel("displacement over reference")
    axes[1, 0].set_ylabel("dotted: graded 1 : 2 : ... : n")
    axes[1, 2].legend(ncols=2, fontsize="small")
    figure.savefig(path, dpi=130)


def draw_thickness(path: Path) -> None:
    """Answers on 16 intervals a side against the thickness, over those of 9-node shells on 64 (plate: Kirchhoff's)."""
    figure, axes = plt.subplots(2, 5, figsize=(15, 7), layout="constrained", sharey=True)
    for column, (name, problem) in enumerate(THICKNESS.items()):
        exact = [compute(problem, "shell9_mitc", 32 if name == "hypar" else 64, t) for t in SLENDER]
        check = [compute(problem, "shell4_mitc_plus", 32 if name == "hypar" else 64, t) for t in SLENDER]
        report(name, "shell9_mitc", "fine", exact, "11.4e")
        report(name, "shell4_mitc_plus", "fine", [c / e for c, e in zip(check, exact, strict=True)])
        for row, distortion in enumerate((0.0, "graded")):
            axis = axes[row, column]
            for element, colour in ELEMENTS.items():
                found = [
                    compute(problem, element, 16, t, distortion=distortion) / e
                    for t, e in zip(SLENDER, exact, strict=True)
                ]
                report(name, element, distortion, found)
                axis.plot(SLENDER, found, "o-", color=colour, ms=3, label=element)
            finish(axis, f"{name}, {distortion or 'regular'}", "thickness over length")
            axis.invert_xaxis()
    axes[0, 0].set_ylabel("displacement over the fine mesh's")
    axes[1, 0].legend(fontsize="small")
    figure.savefig(path, dpi=130)


def finish(axis: Axes, title: str, label: str) -> None:
    """Set scale and titles."""
    axis.axhline(1.0, color="0.8", zorder=0)
    axis.set(title=title, xscale="log", xlabel=label, ylim=(0, 1.25))


def report(name: str, element: str, distortion: object, found: list[float], form: str = "7.4f") -> None:
    """Print a row."""
    print(
        f"{name:21s} {element:17s} {distortion or 'regular':8s}", " ".join(format(v, form) for v in found), flush=True
    )


def print_macneal_harder() -> None:
    """Beams of MacNeal & Harder on 6 x 1 cells and on 24 x 4 (quadratic: 12 x 2)."""
    for element in ELEMENTS:
        mesh = {"pattern": "right"} if element[5] in "36" else {}
        for cells in ((6, 1), (12, 2) if element[5] in "689" else (24, 4)):
            for shape in ("rectangle", "trapezoid", "parallelogram"):
                found = [linear.straight_beam(element, shape, load, cells, **mesh) for load in linear.STRAIGHT_BEAM]
                report(f"{shape} {cells[0]} x {cells[1]}", element, 0.0, found)
            report(f"curved beam {cells[0]} x {cells[1]}", element, 0.0,
                   [linear.curved_beam(element, load, cells, **mesh) for load in linear.CURVED_BEAM])  # fmt: skip
        n = 2 if element[5] in "689" else 4
        report(f"twisted beam {6 * n} x {n}", element, 0.0,
               [linear.twisted_beam(element, n, t, load, **mesh) for t, load in linear.TWISTED_BEAM])  # fmt: skip
        report("plates, 1/10,000", element, 0.0,
               [compute(linear.plate, element, 16, 1e-4, edge=e, load=q, aspect=a) / linear.PLATES[a, e, q]
                for a, e, q in linear.PLATES])  # fmt: skip
        report("hook", element, 0.0, [compute(linear.hook, element, k) for k in (2, 4, 10)])


if __name__ == "__main__":
    print_macneal_harder()
    draw_meshes(Path(sys.argv[1]) / "shell_convergence.png")
    draw_thickness(Path(sys.argv[1]) / "shell_thickness.png")
