# SPDX-License-Identifier: Apache-2.0
"""Explicit runs whose cycles ranks share, beside the same runs whole on each rank: what differs.

    mpiexec -n 3 python -m tests.problems.divided_loops

Rank 0 prints a line of JSON: by run, the largest difference of an array of its state over that array's size; of runs
that fail, what each of both has said.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import numpy as np

from presswork import build_model, read_case
from presswork.explicit.input_checks import ExplicitError
from presswork.model import Model
from presswork.process.stamping import ExplicitStamping
from presswork.ranks.world import World, find_world
from tests.problems.square_cup import describe_cup

SHARES = (
    "loop.work", "run.energy", "contact.damping", "contact.drag", "contact.external", "contact.friction",
    "contact.squeeze",
)  # fmt: skip
"""Of these each rank has a share, and the sum is rounded."""


def read(text: str) -> Model:
    """Return the model of a case's text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        path.write_text(text)
        return build_model(read_case(path))


def compare(text: str, world: World, rows: int = 2) -> dict[str, float]:
    """Compute rows of a case whole and shared; return by array how far the states are apart."""
    found = []
    for each in (None, world):
        run = ExplicitStamping(read(text), threads=1, world=each)
        on = run.advance()
        for _ in range(rows):
            next(on)
        found.append(run.to_arrays())
    whole, shared = found
    assert set(whole) == set(shared)
    apart = {}
    for name, values in whole.items():
        one, two = (np.nan_to_num(np.asarray(v, dtype=float), posinf=0.0) for v in (values, shared[name]))
        scale = max(float(np.abs(one).max(initial=0.0)), 1e-300)
        apart[name] = float(np.abs(one - two).max(initial=0.0)) / scale
    return apart


def fail(text: str, world: World, speed: float, longer: float) -> list[str]:
    """Return what a run says, whole and shared, with random speeds [mm/s] and a step longer by a factor."""
    said = []
    for each in (None, world):
        run = ExplicitStamping(read(text), threads=1, world=each)
        loop = run.shells
        loop.velocity = np.random.default_rng(3).normal(0.0, speed, loop.velocity.shape)
        loop.dt *= longer
        try:
            loop.advance(200)
            said.append("no error")
        except ExplicitError as error:
            said.append(str(error))
    return said


def main() -> None:
    """Compute all runs."""
    world = find_world()
    assert world is not None
    runs = {
        "mitc": compare(describe_cup(8) + '[explicit]\nelement = "shell4_mitc_plus"\n', world),
        "single": compare(describe_cup(8) + '[explicit]\nprecision = "single"\n', world),
        "scaled": compare(describe_cup(8) + "[explicit]\ntarget_step = 2e-6\n", world),
    }
    failed = fail(describe_cup(8), world, 5e3, 4.0)
    if world.rank == 0:
        print(json.dumps({"apart": runs, "failed": failed}))


if __name__ == "__main__":
    main()
