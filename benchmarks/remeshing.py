# SPDX-License-Identifier: Apache-2.0
"""What a new mesh costs, over an increment on the same mesh: in forgings, and in an upsetting meshed anew all along.

A new mesh counts all from the decision on: sizes, boundary, cells, transfer, a procedure of its own, the order and
pattern of its matrix, equilibrium with the tools at rest, and meshes that are refused. The rest of the run, which asks
after every increment whether the mesh may stay, counts as increments.

Run: python -m benchmarks.remeshing [--forgings] [--profile]
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

from presswork import Case, build_model, read_case
from presswork.examples import copy_example
from presswork.model import Model
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.new_meshes import NewMeshes

CELLS = (16, 32, 64, 100)
FORGINGS = ("forging_hub", "forging_h_section", "can_extrusion")
EVERY = 1 / 31
"""Of the stroke: 30 new meshes."""


def upsetting(n: int) -> Case:
    """A cylinder of 10 by 10 mm, to 30 % of its height, n by n cells."""
    hardening = {"law": "swift", "K": 700, "e0": 0.015, "n": 0.2}
    return Case(
        title="upsetting",
        analysis="axisymmetric",
        workpiece={"material": "steel", "element": "quad4_fbar", "mesh": {"size": [10, 10], "cells": [n, n]}},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": hardening}},
        tools={"punch": {"profile": [[0, 10], [80, 10]], "contact": "shear", "m": 0.15}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"stroke": 3, "direction": [0, -1]}}}],
        solver={"max_increment": 0.02},
        remesh={"every": EVERY},
    )


def measure(model: Model, name: str = "") -> str:
    """Return a row of the table; it begins with a name, or with the number of cells at the end."""
    recording = begin_forming(model, threads=1)
    meshes = recording.observers.find(NewMeshes)
    made = remesh = 0.0
    inner = meshes._try_mesh

    def timed(*args: object, **kwargs: object) -> object:
        nonlocal made, remesh
        started = process_time()
        try:
            return inner(*args, **kwargs)  # type: ignore[arg-type]
        finally:
            remesh += process_time() - started
            made += 1

    meshes._try_mesh = timed  # type: ignore[method-assign, assignment]
    started = process_time()
    increments = sum(1 for _ in recording.advance())
    whole = process_time() - started
    cells = len(recording.model.mesh.blocks[0].connectivity)
    per_mesh, per_increment = remesh / made, (whole - remesh) / increments
    return (
        f"| {name or f'{cells:,}'} | {increments} | {made:.0f} | {per_increment:.3f} | {per_mesh:.3f} | "
        f"{per_mesh / per_increment:.2f} | {whole:.1f} |"
    )


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="*", default=CELLS, help="along each side")
    parser.add_argument("--forgings", action="store_true", help="examples, each with its own increments")
    parser.add_argument("--profile", action="store_true", help="of the last mesh")
    arguments = parser.parse_args()
    print("| cells | increments | new meshes | increment [s] | new mesh [s] | ratio | whole [s] |")
    print("|---|---|---|---|---|---|---|")
    if arguments.forgings:
        with TemporaryDirectory() as folder:
            for name in FORGINGS:
                print(measure(build_model(read_case(copy_example(name, Path(folder)))), name), flush=True)
        return
    profile = cProfile.Profile()
    for n in arguments.cells:
        if arguments.profile:
            profile.enable()
        print(measure(build_model(upsetting(n))), flush=True)
    if arguments.profile:
        pstats.Stats(profile).sort_stats("tottime").print_stats(25)


if __name__ == "__main__":
    main()
