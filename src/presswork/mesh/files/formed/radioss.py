# SPDX-License-Identifier: Apache-2.0
"""A formed sheet as a starter's deck of OpenRadioss: shells with thickness, /INISHE and /INISH3 with stress by layer.

STRS_F/GLOB has stresses in the global frame, plastic strain and the place of each layer between -1 and 1, the first
layer at the bottom (Starter Input, /INISHE/STRS_F/GLOB). One point in the plane (npg = 1), as of Ishell 1 to 4 and
Ish3n 1 and 2; N of the property is the number of layers. Fields are 10 columns for whole numbers, 20 for reals.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.model import BoolArray, FormedSheet

_UNITS = f"{'Mg':>20}{'mm':>20}{'s':>20}"


def write_radioss(sheet: FormedSheet, title: str) -> str:
    """Return the text of a starter's deck without material and property, which are number 1 of part 1."""
    labels, shells = sheet.nodes_in_files, sheet.shells_in_files
    is_triangle = sheet.cells[:, 2] == sheet.cells[:, 3]
    lines = [
        "#RADIOSS STARTER",
        "# presswork; give /MAT and /PROP number 1, N layers as below, Ishell 1 to 4",
        "/BEGIN",
    ]
    lines += [title[:80] or "presswork", f"{2022:10d}{0:10d}", _UNITS, _UNITS, "/TITLE", title[:80] or "presswork"]
    lines += ["/PART/1", "sheet", f"{1:10d}{1:10d}{0:10d}", "/NODE"]
    lines += [f"{i:10d}" + "".join(f"{v:20.12E}" for v in x) for i, x in zip(labels, sheet.points, strict=True)]
    for name, own, corners in (("SHELL", ~is_triangle, 4), ("SH3N", is_triangle, 3)):
        if own.any():
            lines.append(f"/{name}/1")
            for i in np.flatnonzero(own):
                nodes = "".join(f"{node:10d}" for node in labels[sheet.cells[i, :corners]])
                lines.append(f"{shells[i]:10d}{nodes}".ljust(60) + f"{0.0:20.1f}{sheet.thickness[i]:20.12E}")
    for name, own in (("INISHE", ~is_triangle), ("INISH3", is_triangle)):
        if own.any():
            lines += [f"/{name}/STRS_F/GLOB", *_stresses(sheet, own)]
    return "\n".join([*lines, "/END", ""])


def _stresses(sheet: FormedSheet, own: BoolArray) -> Iterator[str]:
    """Yield number, layers, points in the plane and thickness of each shell, its energies, and two rows a layer."""
    for i in np.flatnonzero(own):
        yield f"{sheet.shells_in_files[i]:10d}{len(sheet.heights):10d}{1:10d}{sheet.thickness[i]:20.12E}"
        yield "".join(f"{0.0:20.1f}" for _ in range(5))
        for height, stress, plastic in zip(sheet.heights, sheet.stress[i], sheet.plastic_strain[i], strict=True):
            yield "".join(f"{value:20.12E}" for value in stress[:3])
            yield "".join(f"{value:20.12E}" for value in (*stress[3:], plastic, height))
