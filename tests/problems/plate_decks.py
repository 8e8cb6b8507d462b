# SPDX-License-Identifier: Apache-2.0
"""Small decks of Abaqus, LS-DYNA and OpenRadioss: a sheet of four shells between a flat punch and a flat die."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray
from tests.problems.dyna_deck import Grid, grid_of, row

THICKNESS = 1.0


def make_plates() -> dict[str, Grid]:
    """Return a sheet of 20 x 20 mm at z = 0, and a punch and a die half a thickness from it."""
    plates = {}
    for name, size, height, n in (("sheet", 10.0, 0.0, 3), ("punch", 4.0, 0.5, 2), ("die", 12.0, -0.5, 2)):
        u, v = (each.ravel() for each in np.meshgrid(*[np.linspace(-size, size, n)] * 2, indexing="ij"))
        plates[name] = grid_of(np.column_stack([u, v, np.full(n * n, height)]), n, n)
    return plates


def _abaqus_part(name: str, grid: Grid, points: FloatArray, kind: str) -> list[str]:
    label = len(points) + 1
    return [
        f"*Part, name={name}",
        "*Node",
        *(f"{i}, {p[0]:g}, {p[1]:g}, {p[2]:g}" for i, p in enumerate(points, 1)),
        f"*Element, type={kind}, elset=All",
        *(f"{i}, {', '.join(str(n + 1) for n in cell)}" for i, cell in enumerate(grid.cells, 1)),
        "*Node, nset=Ref",
        f"{label}, 0., 0., 0.",
        *(["*Shell Section, elset=All, material=m", f"{THICKNESS:g}, 5"] if kind == "S4R" else []),
        "*End Part",
    ]


ABAQUS_TAIL = """*Material, name=m
*Density
7.8e-9
*Elastic
200000., 0.3
*Plastic
200., 0.
300., 0.1
*Surface Interaction, name=I
*Friction
0.1,
*Contact Pair, interaction=I
Sheet, Punch
Sheet, Die
*Boundary
die-1.Ref, ENCASTRE
*Step, name=press, nlgeom=YES
*Static
0.01, 1.
*Boundary
punch-1.Ref, 1, 2
punch-1.Ref, 3, 3, -5.
punch-1.Ref, 4, 6
*End Step
"""


def write_abaqus(tail: str = ABAQUS_TAIL, tools: str = "R3D4") -> str:
    """Return the deck of Abaqus; tools: the kind of their elements, of which S4R have sections of their own."""
    lines, assembly = ["*Heading", "plates"], ["*Assembly, name=A"]
    for name, grid in make_plates().items():
        lines += _abaqus_part(name, grid, grid.points, "S4R" if name == "sheet" else tools)
        assembly += [f"*Instance, name={name}-1, part={name}", "*End Instance"]
    for name in ("sheet", "die", "punch"):
        assembly += [f"*Elset, elset=E{name}, instance={name}-1", "All,"]
        assembly += [f"*Surface, type=ELEMENT, name={name.capitalize()}", f"E{name}, SPOS"]
        if name != "sheet":
            assembly += [f"*Rigid Body, ref node={name}-1.Ref, elset=E{name}"]
    return "\n".join([*lines, *assembly, "*End Assembly", tail])


DYNA_TAIL = """*MAT_024
         1   7.85E-9  207000.       0.3      200.      500.



*MAT_RIGID
         2   7.85E-9  207000.       0.3
       1.0         4         7

*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE
         1         2         3         3
       0.1

*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE
         1         3         3         3
       0.1

*BOUNDARY_PRESCRIBED_MOTION_RIGID
         2         3         2         1      -1.0
*DEFINE_CURVE
         1
                 0.0                 0.0
                0.02                 4.0
*CONTROL_TERMINATION
      0.02
*END
"""


def write_dyna(tail: str = DYNA_TAIL) -> str:
    """Return the deck of LS-DYNA."""
    lines, first = ["*KEYWORD", "*TITLE", "plates"], 1
    lines += ["*SECTION_SHELL", row(1, 2, 1.0, 5), row(*[THICKNESS] * 4)]
    lines += ["*SECTION_SHELL", row(2, 2), row(*[1.0] * 4)]
    for number, (name, grid) in enumerate(make_plates().items(), start=1):
        lines += ["*PART", name, row(number, min(number, 2), min(number, 2))]
        lines += ["*NODE", *(f"{first + i:8d}" + "".join(f"{x:16.8E}" for x in p) for i, p in enumerate(grid.points))]
        lines += ["*ELEMENT_SHELL"]
        lines += [
            f"{first + i:8d}{number:8d}" + "".join(f"{first + n:8d}" for n in cell) for i, cell in enumerate(grid.cells)
        ]
        first += len(grid.points)
    return "\n".join(lines) + "\n" + tail


RAD_HEAD = """#RADIOSS STARTER
/BEGIN
plates
      2022         0
                  Mg                  mm                   s
                  Mg                  mm                   s
/TITLE
plates
/MAT/PLAS_TAB/1
steel
            7.85E-09
            207000.0                 0.3
         1
         0                 0.0         0                 0.0                 0.0
         1
                 1.0
                 0.0
/PROP/SHELL/1
the sheet
        24         0         0         0

         5         0                 1.0                 0.0
/FUNCT/1
flow stress
                 0.0               200.0
                 0.1               300.0
/FUNCT/2
the punch
                 0.0                 0.0
                0.02                 4.0
"""
RAD_TAIL = """/IMPDISP/1
the punch
         2         Z         0         0      2002
                 1.0                -1.0                 0.0                 0.0
/BCS/1
the die
   111 111         0      2003
/RUN/plates/1
                0.02
/END
"""
RAD_CONTACT = """/INTER/TYPE7/{0}
contact
      1001       10{0}         0         0         0                   0         0         0         0


                 1.0                 0.1                 0.0                 0.0                 0.0
   000
         0         0                 0.0         0         0         0                 0.0         0
"""


def write_rad() -> str:
    """Return the starter's deck of OpenRadioss."""
    lines, first = [], 1
    for number, (name, grid) in enumerate(make_plates().items(), start=1):
        lines += [f"/PART/{number}", name, row(1, 1, 0), "/NODE"]
        lines += [f"{first + i:10d}" + "".join(f"{x:20.12E}" for x in p) for i, p in enumerate(grid.points)]
        lines += [f"/SHELL/{number}"]
        lines += [f"{first + i:10d}" + "".join(f"{first + n:10d}" for n in cell) for i, cell in enumerate(grid.cells)]
        lines += [f"/GRNOD/PART/{1000 + number}", name, f"{number:10d}"]
        lines += [f"/SURF/PART/{100 + number}", name, f"{number:10d}"]
        if name != "sheet":
            main = 900 + number
            lines += ["/NODE", f"{main:10d}" + f"{0.0:20}" * 3]
            lines += [f"/GRNOD/NODE/{2000 + number}", "main", f"{main:10d}"]
            lines += [f"/RBODY/{number}", name, row(main, 0, 0, 0) + f"{0.0:20}" + row(1000 + number, 0, 0, 0)]
        first += len(grid.points)
    contacts = "".join(RAD_CONTACT.format(number) for number in (2, 3))
    return RAD_HEAD + "\n".join(lines) + "\n" + contacts + RAD_TAIL
