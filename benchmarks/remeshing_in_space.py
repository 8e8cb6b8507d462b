# SPDX-License-Identifier: Apache-2.0
"""What new meshes cost in a run in space: their share of its time, and what that is spent on.

A new mesh counts all from the decision on, as in benchmarks.remeshing: skin and inside (MMG), transfer, a procedure of
its own, equilibrium with the tools at rest, and meshes that are refused; looking whether one is due stands beside it.

Run: python -m benchmarks.remeshing_in_space [--case CASE.toml | --die SEED] [--profile]
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from presswork import build_model, read_case
from presswork.examples import copy_example
from presswork.model import Model
from presswork.process.implicit import new_meshes
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.process.mesh_change import bodies_in_space, carrying
from presswork.remesh.space.mmg_process import MMG
from validation.closed_dies_in_space import draw_die, make_case

PARTS = {
    "looking": (NewMeshes, "_find_reason"),
    "skin and inside": (bodies_in_space, "remesh_body"),
    "transfer": (carrying, "carry_state"),
    "peaks": (new_meshes, "carry_peaks"),
    "balance": (new_meshes, "balance_new_mesh"),
    "all of new meshes": (NewMeshes, "_try_mesh"),
}


def _tell_time() -> float:
    """Return the processor time of this process and of MMG's [s]."""
    return process_time() + MMG.seconds


class Clock:
    """Process time spent in functions."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PARTS, 0.0)
        self.calls = dict.fromkeys(PARTS, 0)

    def watch(self, part: str, inner: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function that does the same and is counted."""

        def timed(*args: Any, **kwargs: Any) -> Any:
            started = _tell_time()
            try:
                return inner(*args, **kwargs)
            finally:
                self.seconds[part] += _tell_time() - started
                self.calls[part] += 1

        return timed


def measure(title: str, model: Model) -> str:
    """Return the table of a model."""
    clock = Clock()
    for part, (place, name) in PARTS.items():
        setattr(place, name, clock.watch(part, getattr(place, name)))
    recording = begin_forming(model, threads=1)
    started = _tell_time()
    increments = sum(1 for _ in recording.advance())
    whole = _tell_time() - started
    cells = sum(len(block.connectivity) for block in recording.model.mesh.blocks)
    rows = [f"{title}: {increments} increments, {recording.epoch} new meshes, {cells} cells at the end"]
    for part, seconds in clock.seconds.items():
        rows.append(f"  {part}: {clock.calls[part]} times, {seconds:.1f} s, {seconds / whole:.1%} of {whole:.0f} s")
    return "\n".join(rows)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", type=Path, help="without it: the example deep_spike_forging")
    parser.add_argument("--die", type=int, metavar="SEED", help="a die of validation.closed_dies_in_space")
    parser.add_argument("--profile", action="store_true", help="print where the time goes")
    arguments = parser.parse_args()
    with TemporaryDirectory() as folder:
        if arguments.die is None:
            path = arguments.case or copy_example("deep_spike_forging", Path(folder))
            title, model = path.stem, build_model(read_case(path))
        else:
            title = f"die {arguments.die}"
            model = build_model(make_case(draw_die(arguments.die), Path(folder)))
        profile = cProfile.Profile()
        if arguments.profile:
            profile.enable()
        print(measure(title, model))
        if arguments.profile:
            profile.disable()
            pstats.Stats(profile).sort_stats("tottime").print_stats(25)


if __name__ == "__main__":
    main()
