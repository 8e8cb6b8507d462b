# SPDX-License-Identifier: Apache-2.0
"""Steps of the tools' forces at new meshes, in every packaged example whose mesh changes.

At rest: by how much the largest force changes from mesh to mesh while the tools stand still, as run.log tells. In the
curve: the force of the increment before a new mesh against that of the next one, each carried to the same stroke with
its own slope, over the largest force so far. Beside it stands the same of increments without a new mesh: nodes that
land step the force, too.

Run: python -m validation.force_steps [EXAMPLE ...]
"""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from presswork import Case, build_model, run_model
from presswork.examples import copy_example
from presswork.model import FloatArray
from presswork.results import Result

IN_THE_PLANE = (
    "bimetal_upsetting",
    "can_extrusion",
    "combined_extrusion",
    "forging_h_section",
    "forging_hub",
    "gear_blank",
    "piercing",
    "upsetting_90",
)


@dataclass(frozen=True)
class Steps:
    """Steps of the force in one run, over the largest force."""

    at_rest: FloatArray
    """At each new mesh (n,)."""
    in_the_curve: tuple[FloatArray, FloatArray]
    """At new meshes, and at increments without one (m,), (k,)."""


def find_steps(folder: Path) -> Steps:
    """Return the steps of a finished run."""
    result = Result(folder)
    found = re.findall(r"force of a tool changes by ([\d.]+)%", (folder / "run.log").read_text())
    history = result.history
    forces = {name.removesuffix(".force"): history[name] for name in history if name.endswith(".force")}
    driven = {name: f"{name}.stroke" for name in forces if f"{name}.stroke" in history}
    cause, stage = np.asarray(history["remesh_cause"]), np.asarray(history["stage"])
    at_mesh, elsewhere = [], []
    for name, column in driven.items():
        stroke, force = np.asarray(history[column]), np.asarray(forces[name])
        largest = np.maximum.accumulate(np.abs(force))
        for i in range(2, len(force) - 1):
            own = slice(i - 2, i + 2)
            way = np.diff(stroke[own])
            if len(set(stage[own])) > 1 or (way == 0.0).any() or np.ptp(np.sign(way)) or largest[i - 1] == 0.0:
                continue
            slope = np.diff(force[own]) / way
            # half of the way with the slope before, half with that after
            step = force[i] - force[i - 1] - 0.5 * way[1] * (slope[0] + slope[2])
            (at_mesh if cause[i] else elsewhere).append(abs(step) / largest[i])
    return Steps(np.array(found, float) / 100, (np.array(at_mesh), np.array(elsewhere)))


def run_example(name: str, folder: Path) -> Steps:
    """Run a packaged example and return its steps."""
    folder.mkdir(parents=True, exist_ok=True)
    run_model(build_model(Case.from_toml(str(copy_example(name, folder)))), folder / "run", threads=1, overwrite=True)
    return find_steps(folder / "run")


def main() -> None:
    """Print a line for each example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("examples", nargs="*", default=IN_THE_PLANE)
    arguments = parser.parse_args()
    print("| example | new meshes | at rest, most | in the curve, 95 of 100 | without a new mesh, 95 of 100 |")
    print("|---|---|---|---|---|")
    with TemporaryDirectory() as temporary:
        for name in arguments.examples:
            steps = run_example(name, Path(temporary) / name)
            parts = [np.quantile(values, 0.95) if len(values) else 0.0 for values in steps.in_the_curve]
            told = (steps.at_rest.max(initial=0.0), *parts)
            print(f"| {name} | {len(steps.at_rest)} | {' | '.join(f'{100 * v:.2f} %' for v in told)} |", flush=True)


if __name__ == "__main__":
    main()
