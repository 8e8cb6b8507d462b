# SPDX-License-Identifier: Apache-2.0
"""Increments, iterations and cut-backs: of every shipped example, and of the upsetting by Newton variant and tangent.

The count of an increment here is that of linear solves; history.csv and summary.json count one more, the look at the
converged state. A run that gives up tells how far it came. A quasi-static equilibrium does not depend on the tangent:
the force at the end shows that every variant that arrives has found the same one.
"""

from __future__ import annotations

import argparse
import json
import statistics
import tomllib
from importlib.resources import as_file, files
from importlib.resources.abc import Traversable
from pathlib import Path
from time import perf_counter, process_time

THESIS = ["solver.tangent=thesis"]
CONSISTENT_D = ["solver.terms.modulus=consistent"]
VARIANTS: dict[str, list[str]] = {
    "full, consistent, symmetric": [],
    "full, consistent, unsymmetric": ["solver.symmetric=false"],
    "full, consistent, no line search": ["solver.line_search=false"],
    "modified, consistent": ["solver.newton=modified"],
    "modified, consistent, 60 iterations": ["solver.newton=modified", "solver.max_iterations=60"],
    "full, thesis B0, Ke Ku, continuum D": THESIS,
    "full, thesis B0, Ke Ku, consistent D": [*THESIS, *CONSISTENT_D],
    "full, thesis B0, Ku only": [*THESIS, "solver.terms.k_e=false"],
    "full, thesis B0, Ke only": [*THESIS, "solver.terms.k_u=false"],
    "full, thesis B0, neither": [*THESIS, "solver.terms.k_e=false", "solver.terms.k_u=false"],
    "full, thesis B0, Ke Ku Kv": [*THESIS, "solver.terms.k_v=true"],
    "full, thesis B0, all, consistent D": [*THESIS, "solver.terms.k_v=true", *CONSISTENT_D],
    "the same, unsymmetric": [*THESIS, "solver.terms.k_v=true", *CONSISTENT_D, "solver.symmetric=false"],
    "full, thesis Bbar, Ke Ku": [*THESIS, "solver.terms.strain_matrix=Bbar"],
    "full, thesis Bbar, neither": [
        *THESIS, "solver.terms.strain_matrix=Bbar", "solver.terms.k_e=false", "solver.terms.k_u=false",
    ],
    "full, thesis Bbar, Ku only": [*THESIS, "solver.terms.strain_matrix=Bbar", "solver.terms.k_e=false"],
    "modified, thesis B0, Ke Ku": ["solver.newton=modified", *THESIS],
    "modified, thesis B0, 60 iterations": ["solver.newton=modified", *THESIS, "solver.max_iterations=60"],
}  # fmt: skip


def list_implicit_solids() -> list[str]:
    """Return the names of the examples that the implicit procedure of solids computes."""
    cases = {p.name.removesuffix(".toml"): tomllib.loads(p.read_text("utf-8")) for p in list_examples()}
    solids = ("axisymmetric", "plane_strain")
    return sorted(n for n, c in cases.items() if c["analysis"] in solids and c.get("procedure") != "explicit")


def list_examples() -> list[Traversable]:
    """Return the case files that are shipped."""
    return [p for p in files("presswork.examples").iterdir() if p.name.endswith(".toml")]


def run_case(name: str, overrides: list[str], threads: int) -> dict[str, object]:
    """Compute an example without output and return its counts."""
    from presswork.case import Case, build_model
    from presswork.implicit.stepping import GaveUpError, ImplicitProcedure

    with as_file(files("presswork.examples") / f"{name}.toml") as path:
        model = build_model(Case.from_toml(path, overrides=overrides))
    procedure = ImplicitProcedure(model, threads=threads)
    factorisations = 0
    inner = procedure.equilibrium.solver.factorise

    def counted(*data: object) -> None:
        nonlocal factorisations
        factorisations += 1
        inner(*data)

    procedure.equilibrium.solver.factorise = counted
    solves: list[int] = []
    plain: list[int] = []
    reasons: list[str] = []
    status = "completed"
    started, user = perf_counter(), process_time()
    try:
        for report in procedure.advance():
            solves.append(len(report.log) - 1)
            reasons += report.cutbacks
            if not report.cutbacks and sum(report.log.contact_changes) == 0:
                plain.append(solves[-1])
    except GaveUpError as error:
        status = str(error).split(":")[0]
    contact = procedure.interactions.tools.contact
    forces, _ = contact.tool_forces(procedure.state, procedure.interactions.supports.fixed(len(model.stages) - 1))
    return {
        "name": name,
        "overrides": overrides,
        "status": status,
        "freedoms": 2 * len(model.mesh.points),
        "increments": len(solves),
        "solves": sum(solves),
        "factorisations": factorisations,
        "most": max(solves, default=0),
        "median": statistics.median(solves) if solves else 0,
        "plain_most": max(plain, default=0),
        "plain_median": statistics.median(plain) if plain else 0,
        "plain": len(plain),
        "over_6": sum(s > 6 for s in solves),
        "cutbacks": len(reasons),
        "reasons": reasons,
        "wall": perf_counter() - started,
        "cpu": process_time() - user,
        "force_kN": abs(float(forces[0, 1])) / 1000 if len(forces) else float("nan"),
        "solves_per_increment": solves,
    }


def print_table(title: str, rows: dict[str, dict]) -> None:
    print(f"\n{title}")
    head = (
        "incr",
        "solves",
        "factor.",
        "median",
        "most",
        "over 6",
        "no-change",
        "median",
        "most",
        "cut-backs",
        "cpu s",
    )
    print(f"{'':38s}" + "".join(f"{h:>10s}" for h in head) + f"{'kN':>9s}  status")
    for label, r in rows.items():
        cells = [r[k] for k in ("increments", "solves", "factorisations", "median", "most", "over_6", "plain")]
        cells += [r[k] for k in ("plain_median", "plain_most", "cutbacks")]
        print(
            f"{label:38s}" + "".join(f"{c:10g}" for c in cells) + f"{r['cpu']:10.2f}{r['force_kN']:9.1f}  {r['status']}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--case", default="upsetting_4cst", help="example for the variants")
    parser.add_argument("--examples-only", action="store_true", help="leave out the variants")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override in every variant")
    parser.add_argument("--json", type=Path, help="write the figures here")
    arguments = parser.parse_args()
    names = list_implicit_solids()
    run_case("upsetting_q4", ["stages.0.tools.punch.stroke=0.1"], arguments.threads)  # warm: load the solver
    shipped = {n: run_case(n, [], arguments.threads) for n in names}
    print("no-change: increments in which no node took or lost hold of a tool, and nothing was cut back")
    print_table("shipped examples, default settings", shipped)
    for name, row in shipped.items():
        for reason in row["reasons"]:
            print(f"  {name} cut back: {reason}")
    variants = {}
    if not arguments.examples_only:
        variants = {
            label: run_case(arguments.case, [*overrides, *arguments.set], arguments.threads)
            for label, overrides in VARIANTS.items()
        }
        print_table(f"{arguments.case} by Newton variant and tangent", variants)
    if arguments.json:
        arguments.json.write_text(json.dumps({"shipped": shipped, "variants": variants}, indent=1))


if __name__ == "__main__":
    main()
