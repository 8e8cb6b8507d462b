# SPDX-License-Identifier: Apache-2.0
"""A formed sheet as Nastran bulk data: GRID, CQUAD4 and CTRIA3 with thickness and material angle of their own.

Ti of an element's continuation is the thickness at its corners, THETA the angle from G1-G2 to x of the material, the
normal is by the right-hand rule about the nodes (Quick Reference Guide, CQUAD4, CTRIA3). No entry for stress or plastic
strain is common to the programs that read bulk data: both stand in comments, a row a layer.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.mesh.files.dynain import material_angle
from presswork.model import FormedSheet

LAYER = "$LAYER"
"""Begins the row of a layer."""


def write_nastran(sheet: FormedSheet, title: str) -> str:
    """Return the text of a bulk data file without case control and loads."""
    nodes, shells = sheet.nodes_in_files, sheet.shells_in_files
    lines = [f"$ {title[:70]}", "$ presswork; mm, t, s, N, MPa; give MAT1 or another material 1", "BEGIN BULK"]
    lines += [_field("PSHELL", 1, 1, float(sheet.thickness.mean()), 1, "", 1)]
    for i, (x, y, z) in zip(nodes, sheet.points, strict=True):
        lines.append(f"{'GRID*':8}{i:16d}{'':16}{x:16.9E}{y:16.9E}*")
        lines.append(f"{'*':8}{z:16.9E}")
    for i, cell, t, angle in zip(shells, sheet.cells, sheet.thickness, material_angle(sheet), strict=True):
        n = 3 if cell[2] == cell[3] else 4
        lines.append(_field("CTRIA3" if n == 3 else "CQUAD4", i, 1, *nodes[cell[:n]], float(angle)))
        lines.append(_field("+", "", "", *([float(t)] * n)))
    return "\n".join([*lines, *_layers(sheet), "ENDDATA", ""])


def _layers(sheet: FormedSheet) -> Iterator[str]:
    """Yield the comments that hold what no entry does."""
    yield "$ Layers, bottom first: element, height of half the thickness, stress xx yy zz xy yz zx in basic axes [MPa],"
    yield "$ equivalent plastic strain"
    for i, stresses, plastic in zip(sheet.shells_in_files, sheet.stress, sheet.plastic_strain, strict=True):
        for height, stress, strain in zip(sheet.heights, stresses, plastic, strict=True):
            yield f"{LAYER} {i} " + " ".join(f"{value:.8g}" for value in (height, *stress, strain))


def _field(name: str, *values: float | str) -> str:
    """Return an entry in small fields of 8 columns."""
    return (f"{name:8}" + "".join(_small(value) for value in values)).rstrip()


def _small(value: float | str) -> str:
    """Return a value in 8 columns, a real with its point and as many digits as fit."""
    if isinstance(value, str | int | np.integer):
        return f"{value!s:>8}"
    for digits in range(6, -1, -1):
        text = f"{round(value, digits) + 0.0:.{digits}f}"
        if len(text) <= 8:
            break
    return f"{text if '.' in text else text + '.':>8}"
