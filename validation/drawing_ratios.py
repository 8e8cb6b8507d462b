# SPDX-License-Identifier: Apache-2.0
"""Limiting drawing ratios of the grades of the library: by the theory of `check`, and by explicit quarter cups.

`python -m validation.drawing_ratios` prints the table of docs/verification/drawing_ratios.md; with names of grades
behind it, cups of these grades are drawn at several ratios (minutes each).
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import presswork
from presswork.case.any_case import build_model
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.yield_function import Yld2000
from presswork.case.stamping.schema import StampingCase
from presswork.law.elastic_plastic import make_yield_function
from presswork.law.wall import find_drawing_ratio, find_flow_stress, find_strengths, find_wall_force
from presswork.material import NamedSheet, find_sheet, list_sheets

PUNCH, THICKNESS = 50.0, 0.8
RATIOS = (1.8, 2.0, 2.1, 2.2, 2.3, 2.4)


def list_grades() -> Iterator[NamedSheet]:
    """Yield the grades whose flow stress depends on strain alone, with a forming limit, as sheets have it."""
    for sheet in list_sheets():
        if not isinstance(sheet.material.hardening, HotLaw) and sheet.material.forming_limit is not None:
            yield sheet


def find_ratio_by_hill(sheet: NamedSheet) -> float | None:
    """Return the ratio with Hill's function of the same r-values; None where the grade has none."""
    function = sheet.material.yield_function
    hill = function.find_hill() if isinstance(function, Yld2000) else None
    if hill is None:
        return None
    return find_drawing_ratio(sheet.material.model_copy(update={"yield_function": hill}).to_model(sheet.key))


def make_cup(grade: str, ratio: float, size: float = 4.0) -> StampingCase:
    """Return a quarter of a round cup drawn through: punch 50 mm, 0.8 mm thick, mu 0.08, holder pressure 2 MPa."""
    blank = PUNCH * ratio
    area = np.pi / 4 * (blank**2 - PUNCH**2)
    tool = {"shape": "round", "mu": 0.08}
    return StampingCase.model_validate({
        "title": f"cup of {grade}, ratio {ratio:g}", "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": blank, "thickness": THICKNESS, "element_size": size,
                  "material": grade, "symmetry": ["x", "y"]},
        "tools": {
            "punch": {**tool, "kind": "punch", "diameter": PUNCH, "edge_radius": 6.4},
            "die": {**tool, "kind": "die", "diameter": PUNCH + 2.5 * THICKNESS, "edge_radius": 6.4},
            "holder": {**tool, "kind": "holder", "diameter": PUNCH + 4 * THICKNESS, "edge_radius": 1},
        },
        "stages": [{"name": "draw", "tools": {"punch": {"stroke": 0.42 * (blank - PUNCH) + 10.0},
                                               "holder": {"force": 2.0 * area}}}],
    })  # fmt: skip


def find_bearable(sheet: NamedSheet) -> float:
    """Return the force that the wall of the cup bears [N]."""
    material = sheet.material.to_model(sheet.key)
    strengths = find_strengths(make_yield_function(material.yield_function))
    return np.pi * PUNCH * THICKNESS * find_wall_force(strengths, find_flow_stress(material))


def draw_cup(grade: str, ratio: float) -> tuple[float, float, float]:
    """Draw a cup; return its largest force [N], its least thickness over the first, and its least forming margin."""
    with tempfile.TemporaryDirectory() as folder:
        result = presswork.run(build_model(make_cup(grade, ratio)), Path(folder) / "out", threads=1).result
        force = float(np.abs(result.history["punch.force_z"]).max())
        thin = min(float(result.field("thickness", step).min()) for step in range(len(result.times))) / THICKNESS
        margin = min(float(result.field("forming_limit_margin", step).min()) for step in range(len(result.times)))
    return force, thin, margin


def main(grades: list[str]) -> None:
    """Print the table of theory, then the cups that are asked for."""
    print("grade                    yield function  ratio  with Hill's")
    for sheet in list_grades():
        ratio, hill = find_drawing_ratio(sheet.material.to_model(sheet.key)), find_ratio_by_hill(sheet)
        law = sheet.material.yield_function.law
        print(f"{sheet.key:24s} {law:14s} {ratio:6.2f}  {'' if hill is None else f'{hill:.2f}'}")
    for grade in grades:
        bears = find_bearable(find_sheet(grade))
        for ratio in RATIOS:
            force, thin, margin = draw_cup(grade, ratio)
            print(f"{grade} at {ratio:g}: force {force / 1000:.1f} kN, {100 * force / bears:.0f} % of what the wall "
                  f"bears, thickness {thin:.2f}, margin {margin:.2f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main(sys.argv[1:])
