# SPDX-License-Identifier: Apache-2.0
"""A hot billet, upset between sticking dies, dwells between them: CalculiX and presswork on the same deformed mesh.

A quarter of a billet of 10 x 15 mm (radius x half height) at 1200 degrees C is upset by 20 % in a microsecond, then
cools for 1 s: the die takes 5 kW/m2K at 200 degrees C, the barrelled side gives 1 kW/m2K to 20 degrees C. CalculiX
(*HEAT TRANSFER, CAX8 with mid-sides in the middle of presswork's edges) gets the deformed mesh of presswork, which has
films, mass and conduction from the deformed bodies of a run of forming. Plastic work heats in neither.

Run: python -m validation.hot_billet_calculix
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from presswork.case import build_model
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import BoolArray, FloatArray, IntArray
from validation.hot_billet import PLACES, make_billet, press

CELLS = (20, 32)


def has_calculix() -> bool:
    """Say whether CalculiX is installed."""
    return shutil.which("ccx") is not None


def run_presswork() -> ImplicitProcedure:
    """Return the billet after upsetting and dwell."""
    law = {"law": "linear", "yield_stress": 100, "modulus": 100}
    stages = [press(1e-6), {"name": "dwell", "duration": 1}]
    case = make_billet(CELLS, law, stages, 0.01, heat={"plastic_fraction": 0})
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def make_deck(points: FloatArray, cells: IntArray, face: BoolArray, side: BoolArray) -> str:
    """Return the input of CalculiX: nodes (n, 2), quadrilaterals (m, 4), and which of the nodes lie on die and side."""
    number: dict[tuple[int, ...], int] = {(k,): k + 1 for k in range(len(points))}
    places = list(points)
    elements, films = [], []
    for e, cell in enumerate(cells, 1):
        ring = [int(node) for node in cell]
        nodes = [node + 1 for node in ring]
        for k in range(4):
            a, b = ring[k], ring[(k + 1) % 4]
            key = (min(a, b), max(a, b))
            if key not in number:
                number[key] = len(number) + 1
                places.append(0.5 * (points[a] + points[b]))
            nodes.append(number[key])
            films += [f"{e}, F{k + 1}, 200., 5."] if face[a] and face[b] else []
            films += [f"{e}, F{k + 1}, 20., 1."] if side[a] and side[b] else []
        elements.append(", ".join(map(str, [e, *nodes])))
    lines = ["*NODE, NSET=NALL", *(f"{k}, {x:.10g}, {y:.10g}, 0." for k, (x, y) in enumerate(places, 1))]
    lines += ["*ELEMENT, TYPE=CAX8, ELSET=EALL", *elements]
    lines += ["*NSET, NSET=CORNERS, GENERATE", f"1, {len(points)}", "*MATERIAL, NAME=STEEL"]
    lines += ["*CONDUCTIVITY", "53., 20.", "27., 800.", "28., 1300.", "*DENSITY", "7.8e-9"]
    lines += ["*SPECIFIC HEAT", *(f"{c}e6, {t}" for t, c in ((20, 440), (700, 800), (1300, 650)))]
    lines += ["*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "NALL, 1200."]
    lines += ["*STEP, INC=1000", "*HEAT TRANSFER, DIRECT", "0.005, 1.", "*FILM", *films]
    return "\n".join([*lines, "*NODE PRINT, NSET=CORNERS, FREQUENCY=1000", "NT", "*END STEP", ""])


def run_calculix(done: ImplicitProcedure) -> FloatArray:
    """Return the temperatures of the nodes [degrees C] that CalculiX finds on the deformed mesh."""
    mesh = done.model.mesh
    on = {name: np.isin(np.arange(len(mesh.points)), mesh.node_sets[name]) for name in ("top", "right")}
    points = mesh.points + done.state.nodes.displacement
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "billet.inp").write_text(make_deck(points, mesh.blocks[0].connectivity, on["top"], on["right"]))
        subprocess.run(
            ["ccx", "billet"], cwd=folder, capture_output=True, env={**os.environ, "OMP_NUM_THREADS": "1"}, check=False
        )
        rows = [line.split() for line in (folder / "billet.dat").read_text().splitlines()]
    return np.array([float(row[1]) for row in rows if len(row) == 2 and row[0].isdigit()])


def compare() -> dict[str, tuple[float, float]]:
    """Return the temperatures at PLACES by presswork and by CalculiX [degrees C]."""
    done = run_presswork()
    own, other = done.state[HeatArrays].temperature, run_calculix(done)
    nearest = {name: int(np.argmin(np.hypot(*(done.model.mesh.points - at).T))) for name, at in PLACES.items()}
    return {name: (float(own[k]), float(other[k])) for name, k in nearest.items()}


if __name__ == "__main__":
    for place, (own, other) in compare().items():
        print(f"{place:8s} presswork {own:8.2f}  CalculiX {other:8.2f} degrees C")
