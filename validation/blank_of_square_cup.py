# SPDX-License-Identifier: Apache-2.0
"""The blank from which the square cup of Cheng (1995) is drawn with an even flange.

    python -m validation.blank_of_square_cup OUT [element_size] [key=value ...]

searches, from the square of 100 mm, the blank of a cup of 20 mm with a flange that ends 11 mm from the die's opening,
to 0.5 mm, and draws the blank that it leaves once more, on a mesh a third finer. Three minutes with 2 mm.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from presswork.case import StampingCase, build_model
from presswork.examples import copy_example
from presswork.post import fit_flange
from presswork.recorder import run_model
from presswork.study import BlankShape, find_blank_shape, surround_opening

DEPTH, WIDTH, TOLERANCE = 20.0, 11.0, 0.5


def search(folder: Path, element_size: float = 2.0, *overrides: str) -> BlankShape:
    """Search the blank."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "square_cup.toml").unlink(missing_ok=True)
    case = copy_example("square_cup", folder)
    settings = [f"stages.0.tools.punch.stroke={DEPTH}", f"blank.element_size={element_size}", *overrides]
    target = surround_opening(case, WIDTH, settings)
    return find_blank_shape(case, target, folder / "out", tolerance=TOLERANCE, settings=settings, overwrite=True)


def draw_again(found: BlankShape, folder: Path, finer: float = 1.5) -> np.ndarray:
    """Draw the case that the search has left on a finer mesh; return the distances from the target [mm]."""
    left = found.folder / "blank.toml"
    size = StampingCase.from_toml(left).blank.element_size / finer
    model = build_model(StampingCase.from_toml(left, [f"blank.element_size={size}"]))
    outcome = run_model(model, folder, overwrite=True)
    assert outcome.status == "completed", outcome.reason
    return fit_flange(outcome.result, found.target).deviation


if __name__ == "__main__":
    out = Path(sys.argv[1])
    shape = search(out, float(sys.argv[2]) if len(sys.argv) > 2 else 2.0, *sys.argv[3:])
    print(shape.status, shape.reason)
    for draw in shape.draws:
        d = draw.fit.deviation
        print(
            f"draw {draw.number}: {d.min():+.3f} to {d.max():+.3f} mm, rms {np.sqrt(np.mean(d**2)):.3f} mm; blank "
            f"{np.ptp(draw.fit.blank[:, 0]):.2f} mm wide, "
            f"{2 * np.abs(draw.fit.blank.sum(axis=1)).max() / np.sqrt(2):.2f} mm across corners; {draw.seconds:.0f} s"
        )
    again = draw_again(shape, out / "again")
    print(f"drawn again on a finer mesh: {again.min():+.3f} to {again.max():+.3f} mm")
