# SPDX-License-Identifier: Apache-2.0
"""The elastic-plastic Scordelis-Lo roof as a solid for CalculiX; tests/data/roof_elastic_plastic.csv is the answer.

Run: python -m validation.roof_calculix roof.inp [cells along, around, through], then ccx roof; about 3 minutes.
"""

from __future__ import annotations

import itertools
import sys
from pathlib import Path

import numpy as np

RADIUS, LENGTH, THICKNESS, ANGLE = 7600.0, 15200.0, 76.0, np.radians(40)
YOUNG, YIELD, LOAD = 21000.0, 4.2, 5e-3
CORNERS = [(0, 0), (2, 0), (2, 2), (0, 2)]
MIDDLES = [(1, 0), (2, 1), (1, 2), (0, 1)]
HEXAHEDRON = [(*c, k) for k in (0, 2) for c in CORNERS] + [(*m, k) for k in (0, 2) for m in MIDDLES] + [
    (*c, 1) for c in CORNERS]  # fmt: skip
"""Places of a C3D20R's nodes on the grid of half cells."""


def rows(numbers: list[int]) -> str:
    return "\n".join(", ".join(map(str, numbers[i : i + 10])) for i in range(0, len(numbers), 10))


def deck(n_along: int, n_around: int, n_through: int) -> str:
    """A quarter of the roof from its diaphragm to the middle, from the crown to the free edge."""
    number: dict[tuple[int, int, int], int] = {}
    cells = [
        [number.setdefault((2 * i + a, 2 * j + b, 2 * k + c), len(number) + 1) for a, b, c in HEXAHEDRON]
        for i, j, k in itertools.product(range(n_along), range(n_around), range(n_through))
    ]
    lines = ["*NODE, NSET=NALL"]
    for (i, j, k), n in number.items():
        x, angle, z = (
            LENGTH / 2 * i / (2 * n_along),
            ANGLE * j / (2 * n_around),
            THICKNESS * (k / (2 * n_through) - 0.5),
        )
        y, height = (RADIUS + z) * np.sin(angle), (RADIUS + z) * np.cos(angle) - RADIUS
        lines.append(f"{n}, {x:.10g}, {y:.10g}, {height:.10g}")
    lines.append("*ELEMENT, TYPE=C3D20R, ELSET=EALL")
    for n, cell in enumerate(cells, 1):
        lines += [", ".join(map(str, [n, *cell[:12]])) + ",", ", ".join(map(str, cell[12:]))]
    sets = {
        "DIAPHRAGM": [n for (i, _, _), n in number.items() if i == 0],
        "MIDDLE": [n for (i, _, _), n in number.items() if i == 2 * n_along],
        "CROWN": [n for (_, j, _), n in number.items() if j == 0],
        "A": [number[2 * n_along, 2 * n_around, 0], number[2 * n_along, 2 * n_around, 2 * n_through]],
    }
    for name, nodes in sets.items():
        lines += [f"*NSET, NSET={name}", rows(nodes)]
    lines += [
        "*MATERIAL, NAME=C",
        "*ELASTIC",
        f"{YOUNG}, 0.",
        "*PLASTIC",
        f"{YIELD}, 0.",
        f"{YIELD}, 10.",
        "*DENSITY",
        "1.",
    ]
    lines += ["*SOLID SECTION, ELSET=EALL, MATERIAL=C"]
    lines += ["*BOUNDARY", "DIAPHRAGM, 2, 3", "MIDDLE, 1, 1", "CROWN, 2, 2"]
    lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.02, 1., 1e-6, 0.02"]
    lines += ["*DLOAD", f"EALL, GRAV, {LOAD / THICKNESS:.10g}, 0., 0., -1.", "*NODE PRINT, NSET=A", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    counts = [int(c) for c in sys.argv[2:5]] or [12, 12, 3]
    Path(sys.argv[1]).write_text(deck(*counts), encoding="utf-8")
