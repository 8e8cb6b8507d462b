# SPDX-License-Identifier: Apache-2.0
"""A formed sheet as an Abaqus input file: shells with thickness and axes of their own, stress and hardening by layer.

Section points count from the bottom, the face that the normal leaves (SNEG), to the top (SPOS); the normal is by the
right-hand rule about the nodes (Abaqus Analysis User's Guide, Shell elements: overview). Stresses are 11, 22, 12 in the
axes of *ORIENTATION (Keywords, *INITIAL CONDITIONS, TYPE=STRESS, SECTION POINTS, which wants every section point).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.mesh.files.formed.layers import Rule, in_layers, lamina_frames, lamina_stress
from presswork.model import FloatArray, FormedSheet, IntArray

_RULES = {"simpson": "SIMPSON", "gauss": "GAUSS"}
_MOST_GAUSS = 15
"""Points that Abaqus has of Gauss's rule."""


def write_abaqus(sheet: FormedSheet, title: str) -> str:
    """Return the text of an input file without material, steps and supports."""
    rules: tuple[Rule, ...] = ("simpson", "gauss") if len(sheet.heights) <= _MOST_GAUSS else ("simpson",)
    sheet, rule = in_layers(sheet, rules)
    frames, nodes, shells = lamina_frames(sheet), sheet.nodes_in_files, sheet.shells_in_files
    lines = ["*HEADING", title[:80] or "presswork", "** mm, t, s, N, MPa; give *MATERIAL, NAME=SHEET and the steps"]
    lines += ["*NODE, NSET=SHEET", *(f"{i}, {_row(x)}" for i, x in zip(nodes, sheet.points, strict=True))]
    is_triangle = sheet.cells[:, 2] == sheet.cells[:, 3]
    for kind, own, corners in (("S4R", ~is_triangle, 4), ("S3R", is_triangle, 3)):
        if own.any():
            lines.append(f"*ELEMENT, TYPE={kind}, ELSET=SHEET")
            for i in np.flatnonzero(own):
                lines.append(", ".join(str(n) for n in (shells[i], *nodes[sheet.cells[i, :corners]])))
    lines += _per_element("THICKNESS", "LENGTH", (float(sheet.thickness.mean()),), sheet.thickness[:, None], shells)
    lines += _per_element("AXES", "COORD3D, COORD3D", (1, 0, 0, 0, 1, 0), frames[:, :2].reshape(-1, 6), shells)
    lines += ["*ORIENTATION, NAME=MATERIAL_AXES, SYSTEM=RECTANGULAR", "AXES", "3, 0."]
    lines.append(
        "*SHELL SECTION, ELSET=SHEET, MATERIAL=SHEET, ORIENTATION=MATERIAL_AXES, SHELL THICKNESS=THICKNESS, "
        f"SECTION INTEGRATION={_RULES[rule]}"
    )
    lines.append(f"{sheet.thickness.mean():.9g}, {len(sheet.heights)}")
    lines.append("*INITIAL CONDITIONS, TYPE=STRESS, SECTION POINTS")
    lines += _by_layer(lamina_stress(sheet, frames), shells)
    lines.append("*INITIAL CONDITIONS, TYPE=HARDENING, SECTION POINTS")
    lines += _by_layer(sheet.plastic_strain[..., None], shells)
    return "\n".join([*lines, ""])


def _per_element(name: str, kind: str, usual: tuple[float, ...], values: FloatArray, shells: IntArray) -> Iterator[str]:
    """Yield a *DISTRIBUTION: `usual`, which elements have that are not named, and a row of values an element."""
    yield f"*DISTRIBUTION TABLE, NAME={name}_TABLE"
    yield kind
    yield f"*DISTRIBUTION, NAME={name}, LOCATION=ELEMENT, TABLE={name}_TABLE"
    yield f", {_row(np.array(usual))}"
    yield from (f"{i}, {_row(row)}" for i, row in zip(shells, values, strict=True))


def _by_layer(values: FloatArray, shells: IntArray) -> Iterator[str]:
    """Yield element, section point from the bottom and values (n, k, m)."""
    for i, layers in zip(shells, values, strict=True):
        yield from (f"{i}, {k}, {_row(row)}" for k, row in enumerate(layers, 1))


def _row(values: FloatArray) -> str:
    return ", ".join(f"{value:.9g}" for value in values)
