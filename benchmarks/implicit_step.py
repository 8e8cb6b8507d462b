# SPDX-License-Identifier: Apache-2.0
"""Time per Newton iteration of the cylinder upsetting against freedoms, where it goes, and how far from the machine.

Every row is a fresh process (so that the peak memory is its own) that upsets the billet by a few per cent. An iteration
is one linear solve. What counts as `rest` is everything in the iteration but factorisation and back-substitution:
element loop, scatter into the matrix, constraints, contact, and Python. The analysis of the sparsity pattern is timed
and counted on its own. Beside the rows stand the machine's own memory bandwidth (a STREAM triad) and arithmetic peak
(fused multiply-adds), both by a small C++ program compiled on the spot, and what the assembly would take at these.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import statistics
import subprocess
import sys
from pathlib import Path
from time import perf_counter

from benchmarks.machine import measure_machine

ELEMENTS = {"tri3": (4.0, "4CST"), "quad4_fbar": (2.0, "quad4_fbar"), "quad8_2x2": (6.0, "quad8_2x2")}
"""Freedoms per cell of a large square grid, and the name in the table."""
POINT_FLOPS = {"tri3": 900, "quad4_fbar": 1100, "quad8_2x2": 900}
"""Kinematics, stress update, modulus and internal force of one point, counted by hand in the kernels; rough."""


# --- one row, in a process of its own --------------------------------------------------------------------------------


class Clock:
    """Sums of time and numbers of calls of wrapped functions."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.calls: dict[str, int] = {}

    def wrap(self, owner: object, name: str, label: str) -> None:
        """Replace owner.name by itself with a clock around it."""
        inner = getattr(owner, name)

        def timed(*args: object, **kwargs: object) -> object:
            started = perf_counter()
            try:
                return inner(*args, **kwargs)
            finally:
                key = f"phase{args[1]}" if label == "phase" else label  # a method of a class: self, phase, ...
                self.seconds[key] = self.seconds.get(key, 0.0) + perf_counter() - started
                self.calls[key] = self.calls.get(key, 0) + 1

        setattr(owner, name, timed)


def run_row(element: str, freedoms: int, threads: int, reduction: float) -> dict[str, object]:
    """Upset the billet and return the row's raw figures."""
    import importlib.resources

    from presswork.case import Case, build_model
    from presswork.implicit.linear.direct import Pardiso
    from presswork.implicit.stepping import GaveUpError, ImplicitProcedure

    n = max(1, round(math.sqrt(freedoms / ELEMENTS[element][0])))
    case = importlib.resources.files("presswork.examples") / "upsetting_4cst.toml"
    pattern = "crossed" if element == "tri3" else "quad"
    overrides = [f"workpiece.element={element}", f"workpiece.mesh.cells=[{n},{n}]", f"workpiece.mesh.pattern={pattern}"]
    overrides += [f"stages.0.tools.punch.stroke={15 * reduction}", "output.steps=1", "output.at=[]"]
    size = 0.01 * 0.6 / reduction  # the example's own first increment
    overrides += [f"solver.initial_increment={size}", f"solver.max_increment={2 * size}"]
    model = build_model(Case.from_toml(str(case), overrides=overrides))
    before_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    clock = Clock()
    clock.wrap(Pardiso, "_call", "phase")  # phase 11 analyses, once, when the solver is made
    started = perf_counter()
    procedure = ImplicitProcedure(model, threads=threads)
    setup = perf_counter() - started
    solver, mechanics = procedure.equilibrium.solver, procedure.mechanics
    clock.wrap(mechanics, "evaluate", "element loop")
    clock.wrap(mechanics, "assemble_stiffness", "scatter")
    if not isinstance(solver, Pardiso):  # else phase 22 factorises and 33 substitutes
        clock.wrap(solver, "factorise", "phase22")
        clock.wrap(solver, "solve", "phase33")
    phases_before = dict(procedure.timing.seconds)
    increments = cutbacks = 0
    rests: list[float] = []
    iterations_of: list[int] = []
    status = "completed"
    started = last = perf_counter()
    solved_last = solves_last = 0.0
    user = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    try:
        for report in procedure.advance():
            now = perf_counter()
            solving = sum(s for k, s in clock.seconds.items() if k in ("phase22", "phase33"))
            solves = clock.calls["phase33"]
            rests.append(((now - last) - (solving - solved_last)) / (solves - solves_last))
            last, solved_last, solves_last = now, solving, solves
            increments += 1
            cutbacks += len(report.cutbacks)
            iterations_of.append(len(report.log) - 1)
    except GaveUpError as error:
        status = f"gave up: {error}"
    wall = perf_counter() - started
    phases = {k: procedure.timing.seconds[k] - phases_before[k] for k in phases_before}
    block = model.mesh.blocks[0]
    cells, nodes = block.connectivity.shape
    return {
        "element": element,
        "threads": threads,
        "freedoms": 2 * len(model.mesh.points),
        "cells": cells,
        "nodes": nodes,
        "points": procedure.state.cells.eqps[0].shape[1],
        "nonzeros": len(procedure.equilibrium.system.data),
        "mesh_points": len(model.mesh.points),
        "status": status,
        "increments": increments,
        "cutbacks": cutbacks,
        "solves": clock.calls["phase33"],
        "factorisations": clock.calls["phase22"],
        "analyses": clock.calls.get("phase11", 0),
        "evaluations": clock.calls["element loop"],
        "iterations": iterations_of,
        "wall": wall,
        "user": resource.getrusage(resource.RUSAGE_SELF).ru_utime - user,
        "setup": setup,
        "analysis": clock.seconds.get("phase11", 0.0),
        "factorisation": clock.seconds["phase22"],
        "substitution": clock.seconds["phase33"],
        "element_loop": clock.seconds["element loop"],
        "scatter": clock.seconds["scatter"],
        "assembly": phases["assembly"],
        "contact": phases["contact"],
        "median_rest_per_solve": statistics.median(rests),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "before_mb": before_mb,
        "solver": solver.name,
    }


# --- the machine's limit ---------------------------------------------------------------------------------------------


def limit_of_assembly(row: dict, machine: dict[str, float]) -> dict[str, float]:
    """Return bytes and flops of one evaluation and one assembly, and the seconds they take at the machine's limit.

    Counted once each: the element matrices written (and the line read first) and read back by the gather, its indices,
    the matrix's values written and swept by the constraints with their column indices, state and nodal arrays.
    """
    m, n, q = 2 * row["nodes"], row["nodes"], row["points"]
    matrices = 8.0 * m * m * row["cells"]
    pairs = row["nonzeros"] / 4
    sources = row["cells"] * n * (n + 1) / 2
    state = 8.0 * row["cells"] * q * (4 + 1 + 2 * (4 + 1 + 1)) + row["cells"] * (4.0 * n + 3 * 8 * m)
    element_loop = 2 * matrices + state + 4 * 16.0 * row["mesh_points"]
    scatter = matrices + 4 * sources + 12 * pairs + 16.0 * row["nonzeros"]
    constrain = 12.0 * row["nonzeros"]
    flops = row["cells"] * q * (POINT_FLOPS[row["element"]] + n * (43 + 20 * n))
    return {
        "bytes": element_loop + scatter + constrain,
        "element_bytes": element_loop,
        "scatter_bytes": scatter,
        "flops": flops,
        "element_limit": max(element_loop / machine["bandwidth"], flops / machine["peak"]),
        "element_memory": element_loop / machine["bandwidth"],
        "element_arithmetic": flops / machine["peak"],
        "scatter_limit": scatter / machine["bandwidth"],
        "limit": element_loop / machine["bandwidth"] + (scatter + constrain) / machine["bandwidth"],
    }


# --- tables ----------------------------------------------------------------------------------------------------------


def print_rows(rows: list[dict]) -> None:
    head = ("element", "freedoms", "thr", "incr", "solves", "analyses", "analysis", "ms/iter", "factor", "subst")
    head += ("elements", "scatter", "other asm", "contact", "Python", "rest %", "median %", "MB")
    print("\nmilliseconds per iteration (one linear solve); analysis: once, in ms; rest: all but factor and subst")
    print("".join(f"{h:>11s}" for h in head))
    for r in rows:
        per = 1000.0 / r["solves"]
        solve = r["factorisation"] + r["substitution"]
        iteration = r["wall"]
        other = iteration - solve - r["assembly"] - r["contact"]
        median = r["median_rest_per_solve"]
        r["rest_percent"] = 100 * (iteration - solve) / iteration
        r["median_rest_percent"] = 100 * median / (median + solve / r["solves"])
        r["ms_per_iteration"] = per * iteration
        cells = [ELEMENTS[r["element"]][1], r["freedoms"], r["threads"], r["increments"], r["solves"], r["analyses"]]
        cells += [f"{1000 * r['analysis']:.0f}", f"{per * iteration:.1f}"]
        cells += [f"{per * r[k]:.1f}" for k in ("factorisation", "substitution", "element_loop", "scatter")]
        cells += [f"{per * (r['assembly'] - r['element_loop'] - r['scatter']):.1f}", f"{per * r['contact']:.2f}"]
        cells += [f"{per * other:.1f}", f"{r['rest_percent']:.0f}", f"{r['median_rest_percent']:.0f}"]
        cells += [f"{r['peak_mb']:.0f}"]
        print("".join(f"{c!s:>11s}" for c in cells) + ("" if r["status"] == "completed" else f"  {r['status']}"))


def print_limits(rows: list[dict], machine: dict[str, dict[str, float]]) -> None:
    for threads, m in machine.items():
        rate = f"triad {m['bandwidth'] / 1e9:.1f} GB/s, peak {m['peak'] / 1e9:.0f} Gflop/s"
        print(f"machine, {threads} thread(s): {rate}")
    print("\nelement loop and scatter against the machine: ms as measured, ms at its limit, ratio")
    head = ("element", "freedoms", "thr", "MB moved", "loop", "by memory", "by flops", "ratio", "scatter", "limit")
    print("".join(f"{h:>11s}" for h in (*head, "ratio", "ns/point")))
    for r in rows:
        limit = r["limit"] = limit_of_assembly(r, machine.get(str(r["threads"]), machine["1"]))
        loop, scatter = r["element_loop"] / r["evaluations"], r["scatter"] / r["factorisations"]
        cells = [ELEMENTS[r["element"]][1], r["freedoms"], r["threads"], f"{limit['bytes'] / 1e6:.1f}"]
        cells += [f"{1000 * loop:.2f}", f"{1000 * limit['element_memory']:.2f}"]
        cells += [f"{1000 * limit['element_arithmetic']:.2f}", f"{loop / limit['element_limit']:.1f}"]
        cells += [f"{1000 * scatter:.2f}", f"{1000 * limit['scatter_limit']:.2f}"]
        cells += [f"{scatter / limit['scatter_limit']:.1f}", f"{1e9 * loop / r['cells'] / r['points']:.0f}"]
        print("".join(f"{c!s:>11s}" for c in cells))


def run_alone(*arguments: str) -> dict:
    """Run this file in a process of its own and return what it prints."""
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.implicit_step", *arguments], capture_output=True, text=True
    )
    if done.returncode:
        sys.exit(f"{' '.join(arguments)} failed:\n{done.stderr[-2000:]}")
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--freedoms", type=int, nargs="+", default=[5000, 20000, 80000, 300000])
    parser.add_argument("--elements", nargs="+", choices=list(ELEMENTS), default=list(ELEMENTS))
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--reduction", type=float, default=0.03, help="of the height, default 0.03")
    parser.add_argument("--json", type=Path, help="write every raw figure here")
    parser.add_argument("--repeats", type=int, default=3, help="runs per row; the median one counts, default 3")
    parser.add_argument("--row", help=argparse.SUPPRESS)
    parser.add_argument("--machine", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.row:
        print(json.dumps(run_row(*json.loads(arguments.row))))
        return
    if arguments.machine:
        print(json.dumps(measure_machine()))
        return
    machine = run_alone("--machine")
    rows = []
    for element in arguments.elements:
        for freedoms in arguments.freedoms:
            for threads in arguments.threads:
                row = json.dumps([element, freedoms, threads, arguments.reduction])
                print(f"{element} {freedoms} freedoms, {threads} thread(s) ...", file=sys.stderr, flush=True)
                runs = [run_alone("--row", row) for _ in range(arguments.repeats)]
                runs.sort(key=lambda r: r["wall"])
                rows.append({**runs[len(runs) // 2], "walls": [r["wall"] for r in runs]})
    if machine is not None:  # the better of before and after: another process may have held a core
        after = run_alone("--machine")
        machine = {t: {k: max(v, after[t][k]) for k, v in m.items()} for t, m in machine.items()}
    else:
        print("no C++ compiler: the machine's limit is not measured")
    print_rows(rows)
    once = all(r["analyses"] == 1 for r in rows)
    print(f"\nsparsity pattern analysed once per run: {'yes, in every row' if once else 'NO'}")
    if machine is not None:
        print_limits(rows, machine)
    if arguments.json:
        arguments.json.write_text(json.dumps({"machine": machine, "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
