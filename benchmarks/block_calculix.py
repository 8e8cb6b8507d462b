# SPDX-License-Identifier: Apache-2.0
"""The upsetting of a block in space on equal meshes in CalculiX and in presswork: force, iterations, processor time.

An eighth of a block of 20 x 20 x 20 mm (E 200 GPa, nu 0.3, flow stress 400 MPa rising by 300 MPa per unit of log
strain) is pressed by a flat die with Coulomb friction of 0.1. CalculiX gets presswork's mesh; its die is one brick
whose nodes are moved, and the block's faces touch it by CalculiX's own penalty contact, node to surface. Both take
full Newton, increments of at most 2 % of the stroke, and one thread. C3D8 has the mean dilatation of presswork's
hex8_fbar; C3D8I has incompatible modes.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import re
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.upsetting_calculix import Run, run_timed

SIDE = 10.0
FRICTION = 0.1
CASE = """
title = "Upsetting of a block"
analysis = "solid"
[workpiece]
material = "metal"
element = "hex8_fbar"
mesh = {{size = [10, 10, 10], cells = [{n}, {n}, {n}]}}
[materials.metal]
young = 200e3
poisson = 0.3
hardening = {{law = "table", points = [[0, 400], [10, 3400]]}}
[tools.die]
shape = "plane"
normal = [0, 0, -1]
position = [0, 0, 10]
contact = "coulomb"
mu = {mu}
[boundary]
x = {{set = "left", fix = ["x"]}}
y = {{set = "bottom", fix = ["y"]}}
z = {{set = "back", fix = ["z"]}}
[[stages]]
name = "press"
tools.die = {{stroke = {stroke}, direction = [0, 0, -1]}}
[output]
steps = 1
"""


def run_presswork(n: int, stroke: float, limit: float) -> Run:
    """Run the case by the command line."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "block.toml").write_text(CASE.format(n=n, mu=FRICTION, stroke=stroke))
        command = [sys.executable, "-c", "from presswork.cli import app; app()", "run", "block.toml", "--output", "out"]
        status, user, wall = run_timed([*command, "--threads", "1", "--no-plot", "--quiet"], folder, limit)
        if not (folder / "out" / "summary.json").exists():
            tail = (folder / "screen.txt").read_text()[-300:]
            return Run(f"failed: {tail}", user, wall, 0, 0, np.zeros(1), np.zeros(1))
        summary = json.loads((folder / "out" / "summary.json").read_text())
        with (folder / "out" / "history.csv").open() as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        solves = sum(int(r["iterations"]) - 1 for r in rows)
        travel = np.array([0.0, *(float(r["die.stroke"]) for r in rows)])
        force = np.array([0.0, *(float(r["die.force"]) for r in rows)])
        return Run("completed" if status == 0 else summary["status"], user, wall, len(rows), solves, travel, force)


def write_deck(path: Path, n: int, card: str, stroke: float, stiffness: float, slope: float) -> None:
    """Write the .inp on presswork's mesh."""
    from presswork import build_model, read_case

    case = path.with_suffix(".toml")
    case.write_text(CASE.format(n=n, mu=FRICTION, stroke=stroke))
    mesh = build_model(read_case(case)).mesh
    cells = mesh.blocks[0].connectivity
    first, brick = len(mesh.points) + 1, len(cells) + 1
    wide = 3.0 * SIDE
    corners = [(x, y, z) for z in (SIDE, SIDE + 2) for x, y in ((0, 0), (wide, 0), (wide, wide), (0, wide))]
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{i + 1}, " + ", ".join(f"{x:.12g}" for x in point) for i, point in enumerate(mesh.points)]
    lines += ["*NODE, NSET=DIE"] + [f"{first + i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(corners)]
    lines += [f"*ELEMENT, TYPE={card}, ELSET=BLOCK"]
    lines += [f"{e + 1}, " + ", ".join(str(k + 1) for k in cell) for e, cell in enumerate(cells)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=PLATE", f"{brick}, " + ", ".join(str(first + i) for i in range(8))]
    sides = np.union1d(mesh.node_sets["right"], mesh.node_sets["top"])
    sets = {"X": "left", "Y": "bottom", "Z": "back"}
    for name, nodes in ({k: mesh.node_sets[v] for k, v in sets.items()} | {
        "TOUCHING": np.union1d(mesh.node_sets["front"], sides)
    }).items():  # fmt: skip
        lines += [f"*NSET, NSET={name}", *(f"{k + 1}," for k in nodes)]
    lines += ["*MATERIAL, NAME=METAL", "*ELASTIC", "200000., 0.3", "*PLASTIC", "400., 0.", "3400., 10."]
    lines += ["*MATERIAL, NAME=TOOL", "*ELASTIC", "200000., 0.3"]
    lines += ["*SOLID SECTION, ELSET=BLOCK, MATERIAL=METAL", "*SOLID SECTION, ELSET=PLATE, MATERIAL=TOOL"]
    lines += ["*BOUNDARY", "X, 1, 1", "Y, 2, 2", "Z, 3, 3", "DIE, 1, 2"]
    lines += ["*SURFACE, NAME=SBLOCK, TYPE=NODE", "TOUCHING,", "*SURFACE, NAME=SDIE, TYPE=ELEMENT", f"{brick}, S1"]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness}"]
    lines += ["*FRICTION", f"{FRICTION}, {slope}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=NODE TO SURFACE", "SBLOCK, SDIE"]
    lines += ["*STEP, NLGEOM, INC=5000", "*STATIC", "0.01, 1., 1e-6, 0.02", "*BOUNDARY", f"DIE, 3, 3, {-stroke}"]
    lines += ["*NODE PRINT, NSET=Z, TOTALS=ONLY", "RF", "*END STEP", ""]
    path.write_text("\n".join(lines))


def run_calculix(ccx: str, n: int, card: str, arguments: argparse.Namespace) -> Run:
    """Run the deck; the force is that on the plane z = 0."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_deck(folder / "job.inp", n, card, arguments.stroke, arguments.contact_stiffness, arguments.stick_slope)
        status, user, wall = run_timed([ccx, "job"], folder, arguments.limit)
        screen = (folder / "screen.txt").read_text()
        table = folder / "job.sta"
        done = {c[1] for c in map(str.split, table.read_text().splitlines()[2:]) if len(c) >= 7}
        number = r"([-+.\dE]+)"
        totals = re.findall(
            rf"total force.*time\s+{number}\s*\n\s*\n\s*{number}\s+{number}\s+{number}",
            (folder / "job.dat").read_text(),
        )
        travel = np.array([0.0] + [arguments.stroke * float(t[0]) for t in totals])
        force = np.array([0.0] + [abs(float(t[3])) for t in totals])
        iterations = len(re.findall(r"^\s*iteration\s+\d+", screen, re.MULTILINE))
        told = {0: "completed", -9: f"stopped at {arguments.limit:.0f} s"}.get(status, f"failed ({status})")
        return Run(told, user, wall, len(done), iterations, travel, force)


def force_at(run: Run, stroke: float) -> float:
    """Return the force at a stroke [kN]; nan where the run did not come so far."""
    if len(run.stroke) < 2 or stroke > run.stroke[-1] + 1e-6:
        return math.nan
    return float(np.interp(stroke, run.stroke, run.force)) / 1000


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[6, 10], help="along each edge")
    parser.add_argument("--cards", nargs="+", default=["C3D8", "C3D8I"])
    parser.add_argument("--stroke", type=float, default=4.0, help="[mm], of a height of 10")
    parser.add_argument("--contact-stiffness", type=float, default=5e4, help="[MPa/mm]")
    parser.add_argument("--stick-slope", type=float, default=5e3, help="[MPa/mm]")
    parser.add_argument("--limit", type=float, default=1200.0, help="seconds for one run")
    arguments = parser.parse_args()
    ccx = shutil.which("ccx")
    if ccx is None:
        print("CalculiX (ccx) is not installed: skipped. On Debian: apt-get install calculix-ccx")
        return 0
    strokes = arguments.stroke * np.array([0.25, 0.5, 0.75, 1.0])
    for n in arguments.cells:
        print(f"\n{n} x {n} x {n} cells, {3 * (n + 1) ** 3} freedoms; force on a quarter [kN] at the stroke [mm]")
        print(f"{'':12s}{'':10s}{'user s':>9s}{'incr.':>7s}{'solves':>7s}" + "".join(f"{s:9.2f}" for s in strokes))
        runs = {"presswork": run_presswork(n, arguments.stroke, arguments.limit)}
        runs |= {card: run_calculix(ccx, n, card, arguments) for card in arguments.cards}
        mine = runs["presswork"]
        scale = {"presswork": 0.25}  # presswork tells the force on the whole die
        for name, run in runs.items():
            forces = [scale.get(name, 1.0) * force_at(run, s) for s in strokes]
            print(
                f"{name:12s}{run.status:10s}{run.user:9.1f}{run.increments:7d}{run.iterations:7d}"
                + "".join(f"{f:9.3f}" for f in forces)
            )
            if name != "presswork":
                off = [100 * (0.25 * force_at(mine, s) / f - 1) for s, f in zip(strokes, forces, strict=True)]
                ratio = f"time over presswork's {run.user / mine.user:.1f}"
                print(f"{'':12s}{ratio:33s}" + "".join(f"{d:+8.2f}%" for d in off))
    return 0


if __name__ == "__main__":
    sys.exit(main())
