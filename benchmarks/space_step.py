# SPDX-License-Identifier: Apache-2.0
"""An implicit iteration of a body in space: seconds and memory against freedoms, by factors and by multigrid.

The first increments of the upsetting of a block under shear friction, which flows everywhere. Each row is a process of
its own, so that its peak of memory is its own; both solvers of a size run one after the other.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

from benchmarks.block_calculix import CASE


def measure(n: int, solver: str, threads: int, increments: int) -> dict[str, float | str]:
    """Compute increments and return seconds an iteration, their shares, and the peak of memory."""
    from presswork import build_model, read_case
    from presswork.implicit.stepping import ImplicitProcedure
    from presswork.memory import estimate_memory

    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "block.toml"
        text = CASE.format(n=n, mu=0.0, stroke=4.0).replace('"coulomb"\nmu = 0.0', '"shear"\nm = 0.3')
        path.write_text(f'{text}[solver]\nlinear_solver = "{solver}"\n')
        model = build_model(read_case(path))
    procedure = ImplicitProcedure(model, threads=threads)
    solves, linear = 0, []
    started, processor = perf_counter(), process_time()
    for number, report in enumerate(procedure.advance(), 1):
        solves += len(report.log) - 1
        linear += [int(s.split()[0]) for s in report.log.solutions if not s.startswith("factors")]
        if number == increments:
            break
    seconds = procedure.timing.seconds
    return {
        "freedoms": 3 * len(model.mesh.points),
        "solves": solves,
        "linear": sum(linear) / max(len(linear), 1),
        "wall": (perf_counter() - started) / solves,
        "processor": (process_time() - processor) / solves,
        "solve": seconds["solve"] / solves,
        "assembly": seconds["assembly"] / solves,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "estimate_mb": estimate_memory(model) / 1e6,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[14, 20, 31, 45], help="along each edge")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--increments", type=int, default=3)
    parser.add_argument("--solvers", nargs="+", default=["direct", "multigrid"])
    parser.add_argument("--one", nargs=2, metavar=("CELLS", "SOLVER"), help="print one row as JSON")
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(int(arguments.one[0]), arguments.one[1], arguments.threads, arguments.increments)))
        return
    head = (
        "freedoms",
        "solver",
        "solves",
        "linear",
        "s/iter",
        "cpu s/iter",
        "solve",
        "assembly",
        "peak MB",
        "estimate",
    )
    print("".join(f"{h:>11s}" for h in head))
    for n in arguments.cells:
        for solver in arguments.solvers:
            command = [sys.executable, "-m", "benchmarks.space_step", "--one", str(n), solver]
            command += ["--threads", str(arguments.threads), "--increments", str(arguments.increments)]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode:
                print(f"{n:11d}{solver:>11s}  {done.stderr.strip().splitlines()[-1]}")
                continue
            r = json.loads(done.stdout)
            cells = [r["freedoms"], solver, r["solves"], f"{r['linear']:.0f}"]
            cells += [f"{r[k]:.2f}" for k in ("wall", "processor", "solve", "assembly")]
            cells += [f"{r['peak_mb']:.0f}", f"{r['estimate_mb']:.0f}"]
            print("".join(f"{c!s:>11s}" for c in cells), flush=True)


if __name__ == "__main__":
    main()
