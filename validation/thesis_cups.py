# SPDX-License-Identifier: Apache-2.0
"""The cups of Cheng (1995), figures 4.6 to 4.8, at the depths shown there: pictures, and extremes of thickness strain.

    python -m validation.thesis_cups OUT [element_size]

draws the square punch's cup with 3-node and 4-node shells and the cylindrical punch's with 3-node shells, to the
thesis's full depth, and leaves OUT/thesis_cups.png. Two minutes of one core with shells of 2 mm.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from presswork.view.plots.shell_plot import plot_shell
from validation.cup_influence import round_punch
from validation.square_cup import draw_cup

TRIANGLES = ['blank.cells="triangles"']
# name, keys, depths of the figure [mm], its extremes of thickness strain (none are printed for figure 4.8)
CUPS = {
    "square punch, 4-node": ([], (15.43, 19.07, 23.73, 26.98), (-0.278, 0.62)),
    "square punch, 3-node": (TRIANGLES, (14.98, 19.80, 23.65, 27.40), (-0.17, 0.42)),
    "cylindrical punch, 3-node": ([*TRIANGLES, *round_punch()], (17.07, 21.69, 25.27, 29.49), None),
}


def main(folder: Path, element_size: float) -> None:
    """Draw the cups, print their extremes, save the picture."""
    page = plt.figure(figsize=(28, 5.2 * len(CUPS)))
    rows = page.subfigures(len(CUPS), 1)
    for row, (name, (keys, depths, extremes)) in zip(rows, CUPS.items(), strict=True):
        stroke = f"stages.0.tools.punch.stroke={depths[-1]}"
        place = folder / name.replace(" ", "_").replace(",", "")
        cup = draw_cup(place, element_size, *keys, stroke, "output.steps=100")
        reached = [np.linalg.norm(cup.surface_displacement("punch", step)) for step in range(len(cup.times))]
        row.suptitle(name)
        print(name, "" if extremes is None else f"  thesis at the end: {extremes[0]:.3f} to {extremes[1]:.3f}")
        for panel, depth in zip(row.subfigures(1, len(depths)), depths, strict=True):
            step = int(np.argmin(np.abs(np.array(reached) - depth)))
            strain = cup.field("thickness_strain", step)
            print(f"   {reached[step]:6.2f} mm   {strain.min():6.3f} to {strain.max():.3f}", flush=True)
            plot_shell(cup, "thickness_strain", step, mirror="xy", show_edges=False, figure=panel)
    page.savefig(folder / "thesis_cups.png", dpi=55)


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 2.0)
