# SPDX-License-Identifier: Apache-2.0
"""Draw-in of the square cup by the explicit procedure beside the experiment of Cheng (1995), figure 4.9.

    python -m validation.square_cup OUT [element_size] [key=value ...]

runs the packaged example to full depth and prints draw-in at mid-side and along the diagonal: a minute with shells of
1 mm, ten seconds with 2 mm.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.post.section import measure_draw_in
from presswork.recorder import run_model

STROKE = np.array([12.77, 16.26, 22.18, 24.53])
EXPERIMENT = {0.0: np.array([6.25, 9.90, 15.10, 17.97]), 45.0: np.array([3.59, 5.66, 8.71, 10.26])}
THESIS = {0.0: np.array([7.02, 10.14, 15.67, 18.08]), 45.0: np.array([4.02, 5.94, 9.50, 11.11])}


def draw_cup(folder: Path, element_size: float = 1.0, *overrides: str) -> Result:
    """Draw the example's cup to the last stroke of the experiment."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "square_cup.toml").unlink(missing_ok=True)
    keys = [f"stages.0.tools.punch.stroke={STROKE[-1]}", f"blank.element_size={element_size}", "output.steps=50"]
    keys.append("explicit.ironing=false")  # as in the thesis; an override may have it
    case = read_case(copy_example("square_cup", folder), [*keys, *overrides])
    outcome = run_model(build_model(case), folder / "out", overwrite=True)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def draw_in(result: Result, angle: float) -> np.ndarray:
    """Draw-in [mm] at the strokes of the experiment, along the radius at an angle from x [degree]."""
    steps = range(len(result.times))
    stroke = [np.linalg.norm(result.surface_displacement("punch", step)) for step in steps]
    return np.interp(STROKE, stroke, [measure_draw_in(result, np.radians(angle), step) for step in steps])


if __name__ == "__main__":
    size = float(sys.argv[2]) if len(sys.argv) > 2 else 1.0
    cup = draw_cup(Path(sys.argv[1]), size, *sys.argv[3:])
    print("stroke", *(f"{s:6.2f}" for s in STROKE), "mm")
    for angle, measured in EXPERIMENT.items():
        for name, values in (("here", draw_in(cup, angle)), ("experiment", measured), ("thesis", THESIS[angle])):
            print(f"{angle:3.0f} degrees {name:10s}", *(f"{v:6.2f}" for v in values))
    print("thickness strain", *(f"{v:.3f}" for v in cup.summary["extremes"]["thickness_strain"]))
    print("punch force at most", f"{cup.history['punch.force'].max() / 1e3:.1f} kN;", cup.summary["work"])
