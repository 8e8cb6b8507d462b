# SPDX-License-Identifier: Apache-2.0
"""The square cup of NUMISHEET'93 beside the draw-in that was measured, with its sensitivity to friction and mesh.

    python -m validation.numisheet93_cup OUT

draws the cup of aluminium and of mild steel, with shells of 3 mm and with one thing changed at a time, and prints
draw-in along x (rolling direction), y and the diagonal, and the punch force; six minutes on one core.

The process (blank of 150 mm, 0.81 mm of aluminium, holder 19.6 kN, friction 0.162, 40 mm deep) and the means of the
measurements are read in the manual of DEFORM-3D, "Sheet Forming in DEFORM 3D", table 1. It names aluminium for both
depths. It shows the tools in a picture alone, so their dimensions are those commonly quoted from the benchmark; they
were not seen in the proceedings. The scatter of the measurements is not given there.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.post.section import measure_draw_in
from presswork.recorder import run_model

DEPTHS = (15.0, 40.0)
"""Of the punch where draw-in was measured [mm]."""
MEASURED = {"side": (5.3, 28.5), "diagonal": (3.3, 15.0)}
"""Mean draw-in at the depths [mm]; x and y are given as one."""
OTHER_PROGRAM = {"side": (5.5, 26.9), "diagonal": (3.3, 15.5)}
"""What the manual's own run of aluminium, isotropic, with bricks found [mm]."""
MATERIALS = {"aluminium": ("numisheet93_aluminium", 0.81, 0.162), "steel": ("numisheet93_mild_steel", 0.78, 0.144)}
"""Name in the library, thickness [mm], friction."""
DIRECTIONS = {"x": 0.0, "y": 90.0, "diagonal": 45.0}


def cup_case(material: str, size: float = 3.0, **change: Any) -> dict[str, Any]:
    """Return the case of a quarter of the cup; change: mu, holder (N), isotropic, procedure, velocity, explicit."""
    name, thickness, mu = MATERIALS[material]
    mu = change.get("mu", mu)

    def tool(kind: str, width: float, corner: float, edge: float) -> dict[str, Any]:
        shape = {"shape": "rectangular", "size": [width, width], "corner_radius": corner, "edge_radius": edge}
        return {"kind": kind, **shape, "mu": mu}

    case = {
        "title": f"square cup of NUMISHEET'93, {material}",
        "analysis": "stamping",
        "procedure": change.get("procedure", "explicit"),
        "blank": {"shape": "rectangle", "size": [150, 150], "thickness": thickness, "element_size": size,
                  "material": name, "symmetry": ["x", "y"]},
        "tools": {"punch": tool("punch", 70, 10, 8), "die": tool("die", 74, 12, 5),
                  "holder": tool("holder", 74, 12, 1)},
        "stages": [{"name": "draw", "velocity": change.get("velocity", "4 m/s"),
                    "tools": {"punch": {"stroke": DEPTHS[-1]}, "holder": {"force": change.get("holder", 19600.0)}}}],
        "output": {"steps": 16, "rows": 100},
    }  # fmt: skip
    if change.get("isotropic"):
        case["materials"] = {"isotropic": make_isotropic(material)}
        case["blank"]["material"] = "isotropic"
    return case


def make_isotropic(material: str) -> dict[str, Any]:
    """Return the material of the library with von Mises' yield function."""
    young, poisson, density, law = {
        "aluminium": (71e3, 0.33, "2700 kg/m^3", (576.79, 0.01658, 0.3593)),
        "steel": (206e3, 0.3, "7850 kg/m^3", (565.32, 0.007117, 0.2589)),
    }[material]
    hardening = {"law": "swift", **dict(zip(("K", "e0", "n"), law, strict=True))}
    return {"young": young, "poisson": poisson, "density": density, "hardening": hardening}


def draw_cup(folder: Path, material: str, size: float = 3.0, **change: Any) -> Result:
    """Draw the cup to the last depth."""
    model = build_model(StampingCase.model_validate(cup_case(material, size, **change)))
    outcome = run_model(model, folder, overwrite=True, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def measure(cup: Result) -> dict[str, np.ndarray]:
    """Return draw-in in each direction, and punch force, at the depths [mm, kN]."""
    steps = range(len(cup.times))
    stroke = [float(np.linalg.norm(cup.surface_displacement("punch", step))) for step in steps]
    ways = {
        name: np.interp(DEPTHS, stroke, [measure_draw_in(cup, np.radians(angle), step) for step in steps])
        for name, angle in DIRECTIONS.items()
    }
    force = np.interp(DEPTHS, cup.history["punch.stroke"], cup.history["punch.force"]) / 1e3
    return {**ways, "force": force}


VARIANTS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("aluminium", "as given", {}),
    ("steel", "as given", {}),
    ("steel", "friction 0.18", {"mu": 0.18}),
    ("aluminium", "friction 0.20", {"mu": 0.20}),
    ("steel", "shells of 5 mm", {"size": 5.0}),
    ("aluminium", "shells of 5 mm", {"size": 5.0}),
    ("steel", "isotropic", {"isotropic": True}),
    ("aluminium", "isotropic", {"isotropic": True}),
    ("steel", "friction 0.11", {"mu": 0.11}),
    ("aluminium", "friction 0.13", {"mu": 0.13}),
)


if __name__ == "__main__":
    print("draw-in at 15 and 40 mm [mm]: x, y, diagonal; punch force at both and at most [kN]; thickness strain")
    print(f"{'measured':28s} {MEASURED['side']} {MEASURED['diagonal']}")
    for material, what, change in VARIANTS:
        result = draw_cup(Path(sys.argv[1]), material, **change)
        found = measure(result)
        row = "  ".join(f"{name} {values[0]:6.2f} {values[1]:6.2f}" for name, values in found.items())
        thin, thick = result.summary["extremes"]["thickness_strain"]
        most = result.history["punch.force"].max() / 1e3
        print(f"{material + ', ' + what:28s} {row}  {most:6.2f}  {thin:.3f} {thick:.3f}", flush=True)
