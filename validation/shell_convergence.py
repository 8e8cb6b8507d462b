# SPDX-License-Identifier: Apache-2.0
"""Draw the convergence of the shells in the obstacle course, and of a clamped plate with its thickness.

Run: python validation/shell_convergence.py docs/img/shell_convergence.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "verification"))
from test_shell_linear import PROBLEMS, plate

LINEAR, QUADRATIC = (4, 8, 16, 32), (2, 4, 8, 16)
ELEMENTS = {
    "shell3_mitc": "C0-", "shell4": "0.6", "shell4_selective": "C1-", "shell4_mitc": "C3-", "shell6_reduced": "C4--",
    "shell8_reduced": "C5--", "shell9_reduced": "C1--", "shell9_mitc": "C3--",
}  # fmt: skip
THICKNESS = (1e-1, 1e-2, 1e-3, 1e-4)


def main(path: str) -> None:
    """Draw and print the figures."""
    figure, axes = plt.subplots(2, 3, figsize=(12, 7), layout="constrained")
    for axis, (name, problem) in zip(axes[0], PROBLEMS.items(), strict=True):
        for element, style in ELEMENTS.items():
            meshes = QUADRATIC if element[5] in "689" else LINEAR
            values = [problem(element, n) for n in meshes]
            print(f"{name:11s} {element:17s}", " ".join(f"{v:7.4f}" for v in values))
            intervals = [n * (2 if element[5] in "689" else 1) for n in meshes]
            axis.plot(intervals, values, style, marker="o", ms=3, label=element)
        axis.axhline(1.0, color="0.8", zorder=0)
        axis.set(title=name, xscale="log", xlabel="node intervals a side", ylim=(0, 1.2))
        axis.set_xticks(LINEAR, [str(n) for n in LINEAR])
        axis.minorticks_off()
    axes[0, 0].set_ylabel("displacement over reference")
    for axis, (title, distortion) in zip(axes[1], (("regular mesh", 0.0), ("distorted mesh", 0.2)), strict=False):
        for element, style in ELEMENTS.items():
            n = 4 if element[5] in "689" else 8
            values = [plate(element, n, t, clamped=True, point=False, distortion=distortion) / 1.265 for t in THICKNESS]
            print(f"plate, {title:15s} {element:17s}", " ".join(f"{v:7.4f}" for v in values))
            axis.plot(THICKNESS, values, style, marker="o", ms=3, label=element)
        axis.axhline(1.0, color="0.8", zorder=0)
        axis.set(title=f"clamped plate, {title}", xscale="log", xlabel="thickness over side", ylim=(0, 1.3))
        axis.invert_xaxis()
    axes[1, 0].set_ylabel("deflection over Kirchhoff's")
    axes[1, 2].set_axis_off()
    axes[1, 2].legend(*axes[1, 0].get_legend_handles_labels(), loc="center", ncols=2)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main(sys.argv[1])
