# SPDX-License-Identifier: Apache-2.0
"""The packaged press line by explicit dynamics and by increments, operation by operation.

    python -m validation.press_line_twice OUT [key=value ...]

draws, trims, pierces and flanges the round cup of `press_line` both ways, and prints how far outline, thickness and
forces lie apart after each operation; then once more with explicit shells as the implicit ones are: fully integrated,
without stress across the thickness. Four minutes on one core.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.post.section import cut_sheet
from presswork.recorder import run_model

IMPLICIT = 'procedure="implicit"'
ALIKE = ('explicit.element="shell4_mitc_plus"', "explicit.ironing=false")
"""Explicit shells as the implicit ones are."""
FINE = ("blank.element_size=1.0",)
"""A mesh whose shells turn by less over the die edge of the flange."""
ANGLES = tuple(np.radians((5.0, 25.0, 45.0, 65.0, 85.0)))
"""Of the rays along which the part is compared, off the symmetry planes [rad]."""


@dataclass(frozen=True)
class Difference:
    """Of two runs at one step."""

    rim: float
    """Of the radii of the rim, at most over the rays: where the sheet ends, so of draw-in, too [mm]."""
    height: float
    """Of heights at equal places of the blank, at most [mm]."""
    thickness: float
    """Of thickness at equal places of the blank over that of the blank, at most."""
    thickness_rms: float


def run_line(folder: Path, *overrides: str, example: str = "press_line") -> Result:
    """Run the packaged line, each stage saved once."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{example}.toml").unlink(missing_ok=True)
    case = read_case(copy_example(example, folder), ["output.steps=1", *overrides])
    outcome = run_model(build_model(case), folder / "out", overwrite=True, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def step_of(run: Result, stage: str) -> int:
    """Return the step saved at the end of a stage, of a run that saves each once."""
    stages = list(dict.fromkeys(run.history["stage"]))
    assert len(run.times) == 1 + len(stages)
    return 1 + stages.index(stage)


def compare(one: Result, other: Result, step: int) -> Difference:
    """Compare two runs at one step along rays of the blank: their meshes differ once the part has been cut."""
    rim, heights, thicknesses = [], [], []
    for angle in ANGLES:
        cuts = [cut_sheet(run, angle, step) for run in (one, other)]
        rim.append(abs(np.subtract(*(cut.line[:, 1, 0].max() for cut in cuts))))
        least, most = max(c.distance[0] for c in cuts), min(c.distance[-1] for c in cuts)
        way = np.linspace(least, most, 60)
        values = [
            np.interp(way, c.distance, run.field("thickness", step)[c.cell])
            for run, c in zip((one, other), cuts, strict=True)
        ]
        middle = [np.interp(way, c.distance, c.line[:, :, 1].mean(axis=1)) for c in cuts]
        thicknesses.append(np.abs(values[0] - values[1]))
        heights.append(np.abs(middle[0] - middle[1]).max())
    thick = float(one.field("thickness", 0).mean())
    off = np.concatenate(thicknesses) / thick
    return Difference(max(rim), max(heights), float(off.max()), float(np.sqrt(np.mean(off**2))))


def largest_forces(run: Result) -> dict[str, float]:
    """Return the largest force of every punch [kN]."""
    names = [name for name in run.history if name.endswith("punch.force")]
    return {name.removesuffix(".force"): float(run.history[name].max()) / 1e3 for name in names}


def mean_forces(run: Result) -> dict[str, float]:
    """Return the mean force of every punch over the second half of its stroke [kN], by stroke, not by rows."""
    means = {}
    for name in (name.removesuffix(".force") for name in run.history if name.endswith("punch.force")):
        stroke, force = run.history[f"{name}.stroke"], run.history[f"{name}.force"]
        works = np.flatnonzero(np.diff(stroke, prepend=0.0) > 0)
        way = np.linspace(0.5, 0.98, 200) * stroke.max()
        means[name] = float(np.interp(way, stroke[works], force[works]).mean()) / 1e3
    return means


def print_differences(explicit: Result, implicit: Result, what: str) -> None:
    print(f"{what}: stage: rim [mm], height [mm], thickness at most, rms")
    for stage in dict.fromkeys(explicit.history["stage"]):
        off = compare(explicit, implicit, step_of(explicit, stage))
        print(f"{stage:18s} {off.rim:8.3f} {off.height:8.3f} {off.thickness:8.4f} {off.thickness_rms:8.4f}")
    for find, name in ((largest_forces, "largest"), (mean_forces, "mean over the second half")):
        forces = find(explicit), find(implicit)
        for punch in forces[0]:
            one, other = (f[punch] for f in forces)
            print(f"  {punch} {name}: {one:.2f} kN, implicit {other:.2f} kN ({100 * (one / other - 1):+.1f} %)")
    sys.stdout.flush()


if __name__ == "__main__":
    out, keys = Path(sys.argv[1]), sys.argv[2:]
    by_increments = run_line(out / "implicit", IMPLICIT, *keys)
    print(by_increments.summary.get("work"))
    print_differences(run_line(out / "explicit", *keys), by_increments, "explicit as packaged")
    print_differences(
        run_line(out / "alike", *ALIKE, *keys), by_increments, "explicit with shells as the implicit ones"
    )
