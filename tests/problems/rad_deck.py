# SPDX-License-Identifier: Apache-2.0
"""A starter's and an engine's deck of OpenRadioss: the cup of dyna_deck.py."""

from __future__ import annotations

import numpy as np

from tests.problems.dyna_deck import HOLDING, STROKE, THICKNESS, make_grids, row

HEAD = """#RADIOSS STARTER
/BEGIN
cup
      {version}         0
                  Mg                  mm                   s
                  Mg                  mm                   s
/TITLE
a round cup
"""
MATERIAL = """/MAT/BARLAT3/1
steel
#              RHO_I
            7.85E-09
#                  E                  NU
            207000.0                 0.3
#  fct_IDE                          Einf                  CE
         0                           0.0                 0.0
#                r00                 r45                 r90              C_hard                   m
                1.79                1.51                2.27                 0.0                 6.0
#           EPSP_max               EPS_t               EPS_m
                 0.0                 0.0                 0.0
# func_IDi                      Fscale_i           EPS_dot_i
         1                           1.0                 0.0
"""
PROPERTY = """/PROP/SH_ORTH/1
the sheet
#   Ishell    Ismstr     Ish3n    Idrill
        24         0         0         0

#        N   Istrain               Thick              Ashear              Ithick     Iplas
         5         0{thickness:>20}                 0.0                   1         1
#                 Vx                  Vy                  Vz                 Phi
                 1.0                 0.0                 0.0                 0.0
"""
TAIL = """/FUNCT/1
flow stress
                 0.0               200.0
                 0.1               300.0
                 0.5               400.0
/FUNCT/2
speed of the punch
                 0.0                 0.0
              0.0001                 0.0
              0.0012                 1.0
              0.0062                 1.0
              0.0073                 0.0
/FUNCT/3
force
                 0.0                 0.0
              0.0001                 1.0
                 1.0                 1.0
/IMPVEL/1
the punch
         2         Z         0         0      2002
                 1.0{speed:>20}                 0.0                 0.0
/CLOAD/1
the holder
         3         Z         0         0      2003                           1.0{force:>20}
/BCS/1
the die
   111 111         0      2004
/TH/NODE/1
output
DEF
/END
"""
ENGINE = "/RUN/cup/1\n{end:>20}\n/VERS/2022\n/TFILE\n1.0e-5\n/ANIM/DT\n0.0 1.0e-3\n/DT/NODA/CST\n0.9 1.0e-7\n"
INTERFACE = """/INTER/{kind}/{number}
blank with a tool
{sides}         0         0         0                   0         0         0         0


                 1.0                 0.1                 0.0                 0.0                 0.0
   000
         0         0                 0.0         0         0         0                 0.0         0
"""


def write_deck(material: str = MATERIAL, sheet: str = PROPERTY, tail: str = TAIL, version: int = 2022) -> str:
    """Return the starter's deck: punch and holder by TYPE21, the die by TYPE7."""
    parts = [HEAD.format(version=version), material, sheet.format(thickness=THICKNESS)]
    first = 1
    for number, (name, grid) in enumerate(make_grids().items(), start=1):
        lines = [f"/PART/{number}", name, row(min(number, 2), 1, 0), "/NODE"]
        lines += [f"{first + i:10d}" + "".join(f"{x:20.12E}" for x in p) for i, p in enumerate(grid.points)]
        lines += [f"/SHELL/{number}", "#shell_ID  node_ID1  node_ID2  node_ID3  node_ID4"]
        lines += [f"{first + i:10d}" + "".join(f"{first + n:10d}" for n in cell) for i, cell in enumerate(grid.cells)]
        if name == "blank":
            for axis, fixed in enumerate(("100 011", "010 101")):
                nodes = first + np.flatnonzero(np.abs(grid.points[:, axis]) < 1e-9)
                lines += [f"/GRNOD/NODE/{axis + 1}", f"edge {axis}"]
                lines += [row(*nodes[i : i + 10]) for i in range(0, len(nodes), 10)]
                lines += [f"/BCS/{axis + 11}", f"symmetry {axis}", f"   {fixed}{0:10d}{axis + 1:10d}"]
        else:
            main = 90000 + number
            lines += ["/NODE", f"{main:10d}" + f"{0.0:20}" * 3]
            lines += [f"/GRNOD/PART/{1000 + number}", name, f"{number:10d}"]
            lines += [f"/GRNOD/NODE/{2000 + number}", "the main node", f"{main:10d}"]
            lines += [f"/RBODY/{number}", name, row(main, 0, 0, 0) + f"{0.0:20}" + row(1000 + number, 0, 0, 0)]
        lines += [f"/SURF/PART/{100 + number}", name, f"{number:10d}"]
        first += len(grid.points)
        parts.append("\n".join(lines) + "\n")
    parts += ["/GRNOD/PART/1001\nblank\n         1\n"]
    for tool in (2, 3, 4):
        kind, second = ("TYPE7", 1001) if tool == 4 else ("TYPE21", 101)
        parts.append(INTERFACE.format(kind=kind, number=tool, sides=row(second, 100 + tool)))
    return "".join(parts) + tail.format(speed=f"{-STROKE / 6.1e-3:.9g}", force=f"{-HOLDING / 4:g}")
