# SPDX-License-Identifier: Apache-2.0
"""The cylinder upsetting on equal meshes in CalculiX and in presswork: time, iterations, force.

Quarter of a billet 10 x 15 mm (radius x half height), E 200 GPa, nu 0.3, yield 0.7 GPa, linear hardening 0.3 GPa in
true stress against log plastic strain, pressed to 60 % between sticking platens. CalculiX gets presswork's own mesh.

What is the same: mesh, material, punch, full Newton, default tolerances, automatic increments of at most 2 % of the
stroke, one thread. Two rows of presswork stand beside CalculiX: the case as shipped, run by the command line with all
its output (time, force); and `face held`, in which every node of the end face is held in both directions as in
CalculiX's deck, while a case as shipped lets a node go that pulls (force only). What else differs:
- the side that folds onto the punch is held by CalculiX with node-to-surface penalty contact (linear, stiffness
  --contact-stiffness) and Coulomb friction (--friction, stick slope --stick-slope), by presswork exactly;
- CalculiX's law is Simo's hyperelastic one in Kirchhoff stress, presswork's is in Cauchy stress on log increments;
- CalculiX turns axisymmetric elements into 3D wedges of 2 degrees (CAX8R: C3D20R, CAX4: C3D8).
The forces of the wedge are multiplied by 180. --check verifies this on the elastic bar, which has a closed form.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from time import perf_counter

import numpy as np

WEDGES = 180.0  # CalculiX's axisymmetric elements are wedges of 2 degrees
REDUCTIONS = (10, 20, 30, 40, 50, 60)
CARDS = {"quad8_2x2": "CAX8R", "quad8": "CAX8", "quad4": "CAX4", "quad4_fbar": "CAX4", "tri6_7pt": "CAX6"}
CARDS |= {"quad4_1pt": "CAX4R", "tri6_6pt": "CAX6"}
PAIRS = ("15x22:quad8_2x2", "15x22:quad4", "15x22:quad4_fbar", "15x22:tri6_7pt", "30x44:quad4", "30x44:quad4_fbar")
PAIRS += ("60x88:quad4", "60x88:quad4_fbar")


@dataclass(frozen=True)
class Run:
    """What one program did."""

    status: str
    user: float
    wall: float
    increments: int
    iterations: int
    stroke: np.ndarray
    force: np.ndarray

    def force_at(self, reduction: float) -> float:
        """Force [kN] at a reduction [%] of the half height of 15 mm; nan where the run did not come so far."""
        from scipy.interpolate import PchipInterpolator

        stroke = 0.15 * reduction
        if len(self.stroke) < 2 or stroke > self.stroke[-1] + 1e-6:
            return math.nan
        return float(PchipInterpolator(self.stroke, self.force)(stroke)) / 1000


def run_timed(command: list[str], folder: Path, limit: float) -> tuple[int, float, float]:
    """Run single-threaded and return exit status, user and wall seconds; status -9 if stopped at the time limit."""
    names = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "CCX_NPROC_STIFFNESS", "CCX_NPROC_EQUATION_SOLVER")
    threads = dict.fromkeys(names, "1")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    started = perf_counter()
    with (folder / "screen.txt").open("w") as screen:
        try:
            status = subprocess.run(
                command, cwd=folder, env={**os.environ, **threads}, stdout=screen, stderr=screen, timeout=limit
            ).returncode
        except subprocess.TimeoutExpired:
            status = -9
    return status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, perf_counter() - started


# --- presswork -------------------------------------------------------------------------------------------------------


def case_overrides(element: str, cells: tuple[int, int]) -> list[str]:
    pattern = "right" if element.startswith("tri") else "quad"
    overrides = [f"workpiece.element={element}", f"workpiece.mesh.cells=[{cells[0]},{cells[1]}]"]
    return [*overrides, f"workpiece.mesh.pattern={pattern}", f"output.at={[r / 60 for r in REDUCTIONS]}"]


def example() -> Path:
    return Path(str(files("presswork.examples") / "upsetting_4cst.toml"))


def run_presswork(element: str, cells: tuple[int, int], folding: bool, limit: float) -> Run:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        overrides = case_overrides(element, cells)
        if not folding:  # the punch ends where the billet does, so that the side finds nothing to fold onto
            overrides += ["tools.punch.profile=[[0,15],[10,15]]"]
        command = [
            sys.executable,
            "-c",
            "from presswork.cli import app; app()",
            "run",
            str(example()),
            "--output",
            "out",
        ]
        command += ["--threads", "1"]
        command += ["--no-plot", "--quiet", *(x for o in overrides for x in ("--set", o))]
        status, user, wall = run_timed(command, folder, limit)
        if not (folder / "out" / "summary.json").exists():
            tail = (folder / "screen.txt").read_text()[-300:]
            return Run(f"failed: {tail}", user, wall, 0, 0, np.zeros(1), np.zeros(1))
        summary = json.loads((folder / "out" / "summary.json").read_text())
        with (folder / "out" / "history.csv").open() as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        # an increment's count includes the look at its converged state: one more than its linear solves
        solves = sum(int(r["iterations"]) - 1 for r in rows)
        stroke = [0.0, *(float(r["punch.stroke"]) for r in rows)]
        force = [0.0, *(float(r["punch.force"]) for r in rows)]
        told = "completed" if status == 0 else summary["status"]
        return Run(told, user, wall, len(rows), solves, np.array(stroke), np.array(force))


def run_held(element: str, cells: tuple[int, int], folding: bool) -> Run:
    """Run presswork with the end face's nodes held on the punch for good, as CalculiX's deck does."""
    from presswork.case import Case, build_model
    from presswork.implicit.stepping import GaveUpError, ImplicitProcedure

    overrides = [*case_overrides(element, cells), 'boundary.face={set="top",fix=["x"]}']
    overrides += ['stages.0.displacement=[{set="top",component="y",value=-9.0}]']
    if not folding:
        overrides += ["tools.punch.profile=[[0,15],[10,15]]"]
    model = build_model(Case.from_toml(example(), overrides=overrides))
    procedure = ImplicitProcedure(model, threads=1)
    middle = model.mesh.node_sets["bottom"]
    stroke, force, solves, status = [0.0], [0.0], 0, "completed"
    started, user = perf_counter(), resource.getrusage(resource.RUSAGE_SELF).ru_utime
    try:
        for report in procedure.advance():
            solves += len(report.log) - 1
            stroke.append(9.0 * report.fraction)
            force.append(float(procedure.state.nodes.reaction[middle, 1].sum()))
    except GaveUpError:
        status = "gave up"
    user = resource.getrusage(resource.RUSAGE_SELF).ru_utime - user
    return Run(status, user, perf_counter() - started, len(stroke) - 1, solves, np.array(stroke), np.array(force))


# --- CalculiX --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Deck:
    """What goes into the CalculiX input beside the mesh."""

    folding: bool = True
    friction: float = 1.0
    contact_stiffness: float = 5e4
    stick_slope: float = 1e3
    elastic: bool = False
    frictionless: bool = False
    stroke: float = 9.0
    max_increment: float = 0.02
    young: float = 200000.0


def write_deck(path: Path, element: str, cells: tuple[int, int], deck: Deck) -> None:
    """Write the .inp on presswork's mesh."""
    from presswork.case import Case, build_model

    model = build_model(Case.from_toml(example(), overrides=case_overrides(element, cells)))
    mesh = model.mesh
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{i + 1}, {x:.12g}, {y:.12g}, 0." for i, (x, y) in enumerate(mesh.points)]
    lines.append(f"*ELEMENT, TYPE={CARDS[element]}, ELSET=BILLET")
    lines += [f"{e + 1}, " + ", ".join(str(n + 1) for n in cell) for e, cell in enumerate(mesh.blocks[0].connectivity)]

    def add_set(name: str, nodes: np.ndarray) -> None:
        lines.append(f"*NSET, NSET={name}")
        lines.extend(f"{n + 1}," for n in nodes)

    sets = mesh.node_sets
    add_set("AXIS", sets["left"])
    add_set("MIDDLE", sets["bottom"])
    add_set("FACE", sets["top"])
    hardening = [] if deck.elastic else ["*PLASTIC", "700., 0.", "3700., 10."]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{deck.young}, 0.3", *hardening]
    lines += ["*SOLID SECTION, ELSET=BILLET, MATERIAL=STEEL"]
    lines += ["*BOUNDARY", "AXIS, 1, 1", "MIDDLE, 2, 2"]
    if not deck.frictionless:
        lines += ["*BOUNDARY", "FACE, 1, 1"]
    if deck.folding:
        first, cell = len(mesh.points) + 1, len(mesh.blocks[0].connectivity) + 1
        corners = [(0.0, 15.0), (30.0, 15.0), (30.0, 17.0), (0.0, 17.0)]
        lines += ["*NODE, NSET=PUNCH"] + [f"{first + i}, {x}, {y}, 0." for i, (x, y) in enumerate(corners)]
        lines += ["*ELEMENT, TYPE=CAX4, ELSET=PUNCH", f"{cell}, {first}, {first + 1}, {first + 2}, {first + 3}"]
        lines += ["*SOLID SECTION, ELSET=PUNCH, MATERIAL=TOOL", "*MATERIAL, NAME=TOOL", "*ELASTIC", "200000., 0.3"]
        add_set("SIDE", np.setdiff1d(sets["right"], sets["top"]))
        lines += ["*SURFACE, NAME=SSIDE, TYPE=NODE", "SIDE,", "*SURFACE, NAME=SPUNCH, TYPE=ELEMENT", f"{cell}, S1"]
        lines += ["*SURFACE INTERACTION, NAME=STICK", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
        lines += [f"{deck.contact_stiffness}", "*FRICTION", f"{deck.friction}, {deck.stick_slope}"]
        lines += ["*CONTACT PAIR, INTERACTION=STICK, TYPE=NODE TO SURFACE", "SSIDE, SPUNCH", "*BOUNDARY", "PUNCH, 1, 1"]
    lines += [
        "*STEP, NLGEOM, INC=5000",
        "*STATIC",
        f"{deck.max_increment / 2}, 1., 1e-6, {deck.max_increment}",
        "*BOUNDARY",
        f"FACE, 2, 2, {-deck.stroke}",
    ]
    if deck.folding:
        lines += [f"PUNCH, 2, 2, {-deck.stroke}"]
    lines += ["*NODE PRINT, NSET=MIDDLE, TOTALS=ONLY", "RF", "*END STEP", ""]
    path.write_text("\n".join(lines))


def run_calculix(ccx: str, element: str, cells: tuple[int, int], deck: Deck, limit: float, keep: Path | None) -> Run:
    with tempfile.TemporaryDirectory() as name:
        folder = keep or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        write_deck(folder / "job.inp", element, cells, deck)
        for old in ("job.dat", "job.sta"):
            (folder / old).unlink(missing_ok=True)
        status, user, wall = run_timed([ccx, "job"], folder, limit)
        screen = (folder / "screen.txt").read_text()
        # STEP INC ATT ITRS TOT TIME STEP TIME INC TIME; the count of iterations is that of the increment
        sta = [line.split() for line in (folder / "job.sta").read_text().splitlines()[2:]]
        done = {int(c[1]): c for c in sta if len(c) >= 7}
        totals = re.findall(
            r"total force.*time\s+([-+.\dE]+)\s*\n\s*\n\s*([-+.\dE]+)\s+([-+.\dE]+)\s+([-+.\dE]+)",
            (folder / "job.dat").read_text(),
        )
        stroke = np.array([0.0] + [deck.stroke * float(t[0]) for t in totals])
        force = np.array([0.0] + [WEDGES * float(t[2]) for t in totals])
        # ccx says "iteration N" for every one that it computes, those of failed attempts included
        iterations = len(re.findall(r"^\s*iteration\s+\d+", screen, re.MULTILINE))
        told = {0: "completed", -9: f"stopped at {limit:.0f} s"}.get(status)
        if told is None:
            told = "gave up: too many cutbacks" if "too many cutbacks" in screen else f"failed ({status})"
        if status == 0 and stroke[-1] < deck.stroke * (1 - 1e-6):
            told = "gave up"
        return Run(told, user, wall, len(done), iterations, stroke, force)


def check_wedge(ccx: str, limit: float) -> bool:
    """Compress the elastic billet a little without friction; the force has a closed form."""
    stroke = 0.003
    deck = Deck(folding=False, elastic=True, frictionless=True, stroke=stroke)
    run = run_calculix(ccx, "quad8_2x2", (15, 22), deck, limit, None)
    expected = 200000 * stroke / 15 * math.pi * 10**2
    error = 100 * (run.force[-1] / expected - 1)
    print(f"elastic bar without friction: {run.force[-1]:.2f} N, closed form {expected:.2f} N, {error:+.3f} %")
    return abs(error) < 0.1


def describe_forces(label: str, run: Run) -> None:
    print(f"{label:34s}" + "".join(f"{run.force_at(r):9.1f}" for r in REDUCTIONS))


def median_run(runs: list[Run]) -> Run:
    return sorted(runs, key=lambda r: r.user)[len(runs) // 2]


def compare(arguments: argparse.Namespace, element: str, cells: tuple[int, int], folding: bool, theirs: Run) -> dict:
    """Run presswork several times and print it beside CalculiX's run."""
    mine = [run_presswork(element, cells, folding, arguments.limit) for _ in range(arguments.repeats)]
    held = run_held(element, cells, folding)
    middle, users = median_run(mine), [r.user for r in mine]
    name = f"{cells[0]}x{cells[1]} {element} | {CARDS[element]}" + ("" if folding else ", side passes through")
    print(f"\n{name}")
    for who, r in (("presswork", middle), ("CalculiX", theirs)):
        times = f"user {r.user:7.2f} s  wall {r.wall:7.2f} s  {r.increments:4d} increments {r.iterations:5d} solves"
        print(f"  {who:10s} {r.status:28s} {times}")
    print(f"  presswork's user seconds: median of {len(users)}, from {min(users):.2f} to {max(users):.2f}")
    print(f"  ratio of user times, CalculiX over presswork: {theirs.user / middle.user:.1f}")
    print(f"  {'force [kN] at reduction [%]':32s}" + "".join(f"{r:9d}" for r in REDUCTIONS))
    describe_forces("  CalculiX", theirs)
    differences = {}
    for label, run in (("presswork", middle), ("presswork, face held", held)):
        describe_forces(f"  {label}", run)
        differences[label] = [100 * (run.force_at(r) / theirs.force_at(r) - 1) for r in REDUCTIONS]
        print(f"  {'  difference [%]':32s}" + "".join(f"{d:+9.2f}" for d in differences[label]))
    runs = {"presswork": middle, "presswork, face held": held, "CalculiX": theirs}
    return {"pair": name, "user_seconds": users, "difference_percent": differences} | {
        who: {**vars(r), "stroke": r.stroke.tolist(), "force": r.force.tolist()} for who, r in runs.items()
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", nargs="+", default=list(PAIRS), metavar="CELLS:ELEMENT", help="e.g. 15x22:quad8_2x2")
    parser.add_argument("--no-folding", action="store_true", help="without contact of the side, instead of with it")
    parser.add_argument("--both", action="store_true", help="with and without contact of the side")
    parser.add_argument("--friction", type=float, default=Deck.friction)
    parser.add_argument("--contact-stiffness", type=float, default=Deck.contact_stiffness, help="[MPa/mm]")
    parser.add_argument("--stick-slope", type=float, default=Deck.stick_slope, help="[MPa/mm]")
    parser.add_argument("--max-increment", type=float, default=Deck.max_increment, help="CalculiX's; of the stroke")
    parser.add_argument("--repeats", type=int, default=3, help="presswork runs per mesh; the median counts")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for one run")
    parser.add_argument("--keep", type=Path, help="keep CalculiX's files in this folder")
    parser.add_argument("--check", action="store_true", help="only check the factor of the wedge's force")
    parser.add_argument("--json", type=Path, help="write the figures here")
    arguments = parser.parse_args()
    ccx = shutil.which("ccx")
    if ccx is None:
        print("CalculiX (ccx) is not installed: skipped. On Debian: apt-get install calculix-ccx")
        return 0
    if not check_wedge(ccx, arguments.limit):
        return 1
    results = []
    done: dict[tuple, Run] = {}
    for pair in () if arguments.check else arguments.pairs:
        size, element = pair.split(":")
        cells = (int(size.split("x")[0]), int(size.split("x")[1]))
        for folding in (True, False) if arguments.both else (not arguments.no_folding,):
            key = (CARDS[element], cells, folding)
            if key not in done:
                deck = Deck(
                    folding,
                    arguments.friction,
                    arguments.contact_stiffness,
                    arguments.stick_slope,
                    max_increment=arguments.max_increment,
                )
                keep = arguments.keep / "_".join(map(str, key)).replace(" ", "") if arguments.keep else None
                done[key] = run_calculix(ccx, element, cells, deck, arguments.limit, keep)
            results.append(compare(arguments, element, cells, folding, done[key]))
    if arguments.json and results:
        arguments.json.write_text(json.dumps(results, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
