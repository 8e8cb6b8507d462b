# SPDX-License-Identifier: Apache-2.0
"""Springback of the strip of draw bending in single and in double precision, beside how far rounding alone moves it.

    python -m validation.precision_scatter [size of the shells, 2.5 mm] [runs in each, 25]

draws the strip of validation/draw_bending.py, of von Mises's steel, at 5 m/s with thicknesses that differ by parts in
1e7, lets it go, and prints means with their standard errors and standard deviations of angles, curl and tension. Which
nodes stick and slip under the holder follows from rounding, so single strips say nothing: two precisions agree where
their means do, within their standard errors, and scatter alike. Two minutes.
"""

from __future__ import annotations

import sys

import numpy as np

from validation.draw_bending import THICKNESS, draw_strip

MEASURES = ("angle at the punch [degree]", "at the die", "radius of the wall [mm]", "tension [N/mm]")


def draw_strips(precision: str, size: float, count: int) -> np.ndarray:
    """Return the MEASURES of so many strips (count, 4)."""
    found = []
    for part in np.arange(count) - count // 2:
        hat = draw_strip(size, 5.0, thickness=THICKNESS * (1 + 1e-7 * part), precision=precision, material="isotropic")
        found.append((*hat.angles, hat.curl, hat.tension))
    return np.array(found)


def main(size: float = 2.5, count: int = 25) -> None:
    """Print the table."""
    strips = {precision: draw_strips(precision, size, count) for precision in ("double", "single")}
    print(f"{count} strips each, shells of {size:g} mm: mean, its standard error, standard deviation")
    for i, name in enumerate(MEASURES):
        of_each = [
            (v.mean(), v.std(ddof=1) / np.sqrt(count), v.std(ddof=1)) for v in (s[:, i] for s in strips.values())
        ]
        print(f"{name:30s}", "   ".join("{:10.4f} +- {:.4f} ({:.4f})".format(*each) for each in of_each))


if __name__ == "__main__":
    main(*(float(a) for a in sys.argv[1:2]), *(int(a) for a in sys.argv[2:3]))
