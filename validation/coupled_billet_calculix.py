# SPDX-License-Identifier: Apache-2.0
"""A hot billet, upset between sticking dies, softer where it is hot: forming and heat together, by CalculiX too.

A quarter of a billet of 10 x 15 mm (radius x half height) at 1200 degrees C is upset by 20 % in 0.5 s. Its flow stress
falls evenly to nothing at 1500 degrees C, so the chilled face flows less and the billet barrels more. The die takes
5 kW/m2K at 200 degrees C, the side gives 1 kW/m2K to 20 degrees C, 0.9 of the plastic work heats.

CalculiX conducts heat on the body as it was at the start, in *COUPLED TEMPERATURE-DISPLACEMENT as well (version 2.20;
`measure_squeezed_bar` shows it), and makes no heat of plastic work. So its two procedures are joined here: the stroke
is divided into slabs, *STATIC takes the temperatures at their ends, *HEAT TRANSFER the body in the middle of a slab,
the temperatures of the slab before and the plastic work of the cells. Both are repeated until temperatures stay.

Run: python -m validation.coupled_billet_calculix
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from presswork.case import build_model
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray, IntArray
from validation.hot_billet import HEIGHT, PLACES, RADIUS, STROKE, make_billet, press

CELLS, TIME, SLABS, SWEEPS = (16, 24), 0.5, 10, 3
YIELD, HARDENING, COLD, MELTING = 280.0, 180.0, 200.0, 1500.0
"""Flow stress YIELD + HARDENING times strain at COLD, falling evenly to nothing at MELTING [MPa, degrees C]."""
WEDGE = np.pi / 90
"""Angle of the wedge that CalculiX makes of an axisymmetric body."""
DENSITY = ["*DENSITY", "7.8e-9"]
CONDUCTIVITY = ["*CONDUCTIVITY", "53., 20.", "27., 800.", "28., 1300."]
SPECIFIC_HEAT = ["*SPECIFIC HEAT", "440.e6, 20.", "800.e6, 700.", "650.e6, 1300."]
SECTION = "*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL"


def run_presswork(element: str = "quad4_fbar", largest: float = 0.02) -> tuple[dict[str, float], float]:
    """Return temperatures at PLACES [degrees C] and the force of the die [N]."""
    law = {"law": "linear", "yield_stress": YIELD, "modulus": HARDENING}
    heating = {"reference": COLD, "melting": MELTING, "exponent": 1}
    case = make_billet(CELLS, law, [press(TIME)], largest, element=element, heating=heating)
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    forces = procedure.interactions.tools.contact.forces(procedure.state, procedure.interactions.supports.fixed(0))
    found = at_places(procedure.model.mesh.points, procedure.state[HeatArrays].temperature)
    return found, float(-forces.force[:, 1].sum())


def at_places(points: FloatArray, values: FloatArray) -> dict[str, float]:
    """Return the values of the nodes at PLACES."""
    return {name: float(values[np.argmin(np.hypot(*(points - at).T))]) for name, at in PLACES.items()}


class Billet:
    """Meshes and decks of CalculiX, of quadratic cells with reduced integration."""

    def __init__(self, folder: Path, cells: tuple[int, int] = CELLS, size: tuple[float, float] = (RADIUS, HEIGHT)):
        self._folder = folder
        columns, rows = cells
        number: dict[tuple[int, int], int] = {}
        ring = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        self.cells: IntArray = np.array(
            [
                [number.setdefault((2 * i + k, 2 * j + m), len(number)) for k, m in ring]
                for j in range(rows)
                for i in range(columns)
            ],
            dtype=np.int32,
        )
        self.points: FloatArray = np.array(list(number)) * np.array(size) / (2 * np.array(cells))
        self._elements = self._rows("*ELEMENT, TYPE=CAX8R, ELSET=EALL", (self.cells + 1).tolist())
        ends = {"AXIS": (0, 0.0), "MIDDLE": (1, 0.0), "FACE": (1, size[1])}
        self._sets = [
            line
            for name, (axis, at) in ends.items()
            for line in (f"*NSET, NSET={name}", *(str(k + 1) for k in np.flatnonzero(self.points[:, axis] == at)))
        ]
        face, side = range(columns * (rows - 1), columns * rows), range(columns - 1, columns * rows, columns)
        self._films = [*(f"{e + 1}, F3, 200., 5." for e in face), *(f"{e + 1}, F2, 20., 1." for e in side)]

    @staticmethod
    def _rows(title: str, rows: list[list[float]]) -> list[str]:
        return [title, *(", ".join(f"{v:.12g}" for v in (k, *row)) for k, row in enumerate(rows, 1))]

    def run(self, points: FloatArray, lines: list[str]) -> dict[str, list[FloatArray]]:
        """Return the tables that CalculiX prints, by the first word of their titles, one for each step."""
        nodes = self._rows("*NODE, NSET=NALL", np.column_stack([points, np.zeros(len(points))]).tolist())
        (self._folder / "billet.inp").write_text("\n".join([*nodes, *self._elements, *self._sets, *lines, ""]))
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        subprocess.run(["ccx", "billet"], cwd=self._folder, capture_output=True, env=environment, check=False)
        found: dict[str, list[list[list[float]]]] = {}
        for line in (self._folder / "billet.dat").read_text().splitlines():
            if re.match(r"\s*[a-z]", line):
                found.setdefault(line.split()[0], []).append([])
                last = found[line.split()[0]][-1]
            elif line.strip():
                last.append([float(word) for word in line.split()])
        return {title: [np.array(table) for table in tables] for title, tables in found.items()}

    def form(self, temperatures: list[FloatArray]) -> tuple[list[FloatArray], list[FloatArray], float]:
        """Return displacements (n, 2) [mm] and plastic work of the cells (m,) [MPa] of each slab, and the last force.

        temperatures: of the nodes at the end of each slab (n,).
        """
        curve = [
            f"{f * (YIELD + HARDENING * e):.8g}, {e}, {t}"
            for t in (200, 1400)
            for f in [(MELTING - t) / (MELTING - COLD)]
            for e in (0.0, 2.0)
        ]
        lines = ["*MATERIAL, NAME=STEEL", "*ELASTIC", "100000., 0.35", "*PLASTIC", *curve, SECTION]
        lines += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "NALL, 1200."]
        lines += ["*BOUNDARY", "AXIS, 1, 1", "MIDDLE, 2, 2", "FACE, 1, 1"]
        for k, temperature in enumerate(temperatures, 1):
            lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.25, 1.", "*BOUNDARY"]
            lines += [f"FACE, 2, 2, {-STROKE * k / SLABS}"]
            lines += self._rows("*TEMPERATURE", temperature[:, None].tolist())
            lines += ["*NODE PRINT, NSET=NALL, FREQUENCY=1000", "U"]
            lines += ["*NODE PRINT, NSET=FACE, TOTALS=ONLY, FREQUENCY=1000", "RF"]
            lines += ["*EL PRINT, ELSET=EALL, FREQUENCY=1000", "S, PEEQ", "*END STEP"]
        found = self.run(self.points, lines)
        stress = [find_mises(table[:, 2:]) for table in found["stresses"]]
        strain = [table[:, 2] for table in found["equivalent"]]
        work = [
            (0.5 * (stress[max(k - 1, 0)] + now) * (strain[k] - (strain[k - 1] if k else 0.0)))
            .reshape(len(self.cells), -1)
            .mean(axis=1)
            for k, now in enumerate(stress)
        ]
        force = -2 * np.pi / WEDGE * float(found["total"][-1][0, 1])
        return [table[:, 1:3] for table in found["displacements"]], work, force

    def conduct(self, points: FloatArray, temperature: FloatArray, power: FloatArray, dt: float) -> FloatArray:
        """Return temperatures (n,) after dt [s] in which the cells make so much heat (m,) [N mm/(mm3 s)]."""
        lines = ["*MATERIAL, NAME=STEEL", *CONDUCTIVITY, *DENSITY, *SPECIFIC_HEAT, SECTION]
        lines += self._rows("*INITIAL CONDITIONS, TYPE=TEMPERATURE", temperature[:, None].tolist())
        lines += ["*STEP, INC=1000", "*HEAT TRANSFER, DIRECT", f"{dt / 4}, {dt}", "*FILM", *self._films, "*DFLUX"]
        lines += [f"{e}, BF, {q:.10g}" for e, q in enumerate(power, 1)]
        lines += ["*NODE PRINT, NSET=NALL, FREQUENCY=1000", "NT", "*END STEP"]
        return np.asarray(self.run(points, lines)["temperatures"][0][:, 1])


def find_mises(stress: FloatArray) -> FloatArray:
    """Return the effective stress (n,) of stresses xx, yy, zz, xy, xz, yz (n, 6)."""
    between = stress[:, :3] - np.roll(stress[:, :3], 1, axis=1)
    return np.asarray(np.sqrt(0.5 * (between**2).sum(axis=1) + 3.0 * (stress[:, 3:] ** 2).sum(axis=1)))


def run_calculix() -> tuple[dict[str, float], float]:
    """Return what run_presswork does, by CalculiX; the force of its wedge is taken round."""
    with tempfile.TemporaryDirectory() as name:
        billet = Billet(Path(name))
        start, dt = np.full(len(billet.points), 1200.0), TIME / SLABS
        temperatures = [start] * SLABS
        for _ in range(SWEEPS):
            ways, works, force = billet.form(temperatures)
            before, now, temperatures = np.zeros_like(billet.points), start, []
            for way, work in zip(ways, works, strict=True):
                now = billet.conduct(billet.points + 0.5 * (before + way), now, 0.9 * work / dt, dt)
                temperatures.append(now)
                before = way
        return at_places(billet.points, temperatures[-1]), force


def measure_squeezed_bar(part: float) -> float:
    """Return the heat that CalculiX conducts through a bar squeezed to a part of its length, over k A ΔT / L at rest.

    Its volume stays and its ends are at 0 and 100 degrees C: 1 / part² in truth.
    """
    radius, length, conductivity = 1.0, 10.0, 30.0
    with tempfile.TemporaryDirectory() as name:
        bar = Billet(Path(name), (1, 10), (radius, length))
        lines = ["*MATERIAL, NAME=STEEL", "*ELASTIC", "100000., 0.3", "*CONDUCTIVITY", f"{conductivity}", *DENSITY]
        lines += ["*SPECIFIC HEAT", "6.e8", SECTION, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "NALL, 0."]
        lines += ["*STEP, NLGEOM", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY"]
        for k, (x, y) in enumerate(bar.points, 1):
            lines += [f"{k}, 1, 1, {x * (part**-0.5 - 1)}", f"{k}, 2, 2, {y * (part - 1)}"]
        lines += ["MIDDLE, 11, 11, 0.", "FACE, 11, 11, 100.", "*NODE PRINT, NSET=FACE, TOTALS=ONLY", "RFL"]
        lines += ["*NODE PRINT, NSET=FACE", "U", "*END STEP"]
        found = bar.run(bar.points, lines)
    assert np.allclose(found["displacements"][0][:, 2], length * (part - 1)), "the bar was squeezed"
    at_rest = conductivity * 0.5 * WEDGE * radius**2 * 100.0 / length
    return float(found["total"][0][0, 0]) / at_rest


if __name__ == "__main__":
    (own, own_force), (other, other_force) = run_presswork(), run_calculix()
    for place in PLACES:
        print(f"{place:8s} presswork {own[place]:8.2f}  CalculiX {other[place]:8.2f} degrees C")
    print(f"force    presswork {own_force:8.0f}  CalculiX {other_force:8.0f} N")
    print(f"heat through a bar squeezed to a half, over that at rest: CalculiX {measure_squeezed_bar(0.5):.4f}, true 4")
