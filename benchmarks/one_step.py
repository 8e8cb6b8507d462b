# SPDX-License-Identifier: Apache-2.0
"""Time of the one-step solver against the number of elements, first guess included.

Run: python -m benchmarks.one_step [THREADS] [quads]

A round cup of triangles, or of triangles and quadrilaterals beside each other, with holder and friction. Wall and CPU
seconds of the whole solution, and of the first guess alone; iterations and passes of friction; largest memory of the
process so far.
"""

from __future__ import annotations

import resource
import sys
from time import perf_counter, process_time

import numpy as np

from presswork.onestep import solve_one_step
from tests.problems.one_step import NO_QUADS, cup_profile, fan, make_model, revolve

AROUND = (60, 130, 172, 270, 386, 546)
BESIDE = ((172, False), (245, True), (172, True))
"""About 20,000 triangles, as many quadrilaterals, and quadrilaterals with the nodes of the triangles."""


def main() -> None:
    threads = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    runs = BESIDE if "quads" in sys.argv[2:] else [(around, False) for around in AROUND]
    print("triangles   quads   wall [s]   CPU [s]   first guess [s]   iterations   passes   memory [MB]")
    for around, with_quads in runs:
        points, quads = revolve(cup_profile(25.0, 5.0, 18.0, 38.0, 2.0 * np.pi * 25.0 / around), around)
        triangles = fan(around)
        if not with_quads:
            triangles, quads = np.concatenate([triangles, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)]), NO_QUADS
        model = make_model(points, triangles, quads, layers=3, holder_force=1e4, mu=0.1)
        wall, cpu = perf_counter(), process_time()
        result = solve_one_step(model, threads=threads)
        wall, cpu = perf_counter() - wall, process_time() - cpu
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        guess = result.seconds["flatten"]
        times = f"{wall:8.2f}   {cpu:7.2f}   {guess:15.2f}"
        counts = f"{result.iterations:10d}   {result.passes:6d}   {memory:11.0f}"
        print(f"{len(triangles):9d}   {len(quads):5d}   {times}   {counts}", flush=True)


if __name__ == "__main__":
    main()
