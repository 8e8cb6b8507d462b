# SPDX-License-Identifier: Apache-2.0
"""Ears of a cylindrical cup: tools of the ESAFORM 2021 benchmark, drawn through, sheets of different anisotropy.

    python validation/earing.py [docs/img/earing.png]

prints the height of the rim round the cup beside the theory of hoop compression, two minutes, and draws it.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from presswork.case import StampingCase, build_model
from presswork.run import run_model

BLANK, PUNCH, PUNCH_EDGE, DIE, DIE_EDGE, THICKNESS = 107.5, 60.0, 5.0, 62.4, 10.0, 1.0
"""Of the benchmark [mm]; friction 0.07."""
HOLDER = [[0, "8 kN"], [15, "4.4 kN"], [22, "1.6 kN"], [27, "0.4 kN"], [44, "0.4 kN"]]
"""Over the stroke, about 2 MPa on the flange that is left: a constant force would end on the tips of the ears alone.

The benchmark's holder stands 1.04 mm above the die; docs/verification.md has why it is pushed here.
"""

ALUMINIUM = {"young": "70 GPa", "poisson": 0.33,
             "hardening": {"law": "voce", "yield_stress": 140.2, "saturation_stress": 330.2, "rate": 12.4}}  # fmt: skip
STEEL = {"young": "206 GPa", "poisson": 0.3,
         "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}  # fmt: skip
HILL = {"aluminium": (0.526, 0.253, 0.601), "steel": (1.79, 1.51, 2.27), "turned": (0.253, 0.526, 0.253)}
"""r00, r45, r90: AA6016-T4 and NUMISHEET'93's mild steel; the first with its largest and smallest exchanged."""


@dataclass(frozen=True)
class Rim:
    """The edge of the drawn cup, over a quarter."""

    angle: np.ndarray
    """Of the undeformed blank, from the rolling direction [degree]."""
    height: np.ndarray
    """Above the bottom's middle [mm]."""
    thickness_strain: np.ndarray
    """Of the outermost cells, sorted by angle."""
    volume: float
    """Of the cup over that of the blank."""

    @property
    def ears(self) -> list[float]:
        """Angles of the highest points, all round [degree]."""
        around = np.concatenate([self.height, self.height[-2:0:-1]])
        around = np.concatenate([around, around])
        angle = np.concatenate([self.angle, 180 - self.angle[-2:0:-1]])
        angle = np.concatenate([angle, angle + 180])
        wide = max(3, len(self.angle) // 6)
        peaks = [i for i in range(len(around)) if around[i] >= np.roll(around, wide - i)[: 2 * wide + 1].max()]
        return [float(angle[i]) for i in peaks]

    def at(self, angle: float) -> float:
        """Height there [mm]."""
        return float(np.interp(angle, self.angle, self.height))

    @property
    def amplitude(self) -> float:
        """Highest less lowest over the mean."""
        return float(np.ptp(self.height) / self.height.mean())


def make_case(material: dict[str, Any] | str, size: float) -> dict[str, Any]:
    """Return the case of a quarter of the cup."""

    def tool(kind: str, diameter: float, edge: float) -> dict[str, Any]:
        return {"kind": kind, "shape": "round", "diameter": diameter, "edge_radius": edge, "mu": 0.07}

    own = {"materials": {"sheet": material}} if isinstance(material, dict) else {}
    return {
        "title": "cylindrical cup with ears",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": BLANK, "thickness": THICKNESS, "element_size": size,
                  "material": "sheet" if own else material, "symmetry": ["x", "y"]},
        **own,
        "tools": {"punch": tool("punch", PUNCH, PUNCH_EDGE), "die": tool("die", DIE, DIE_EDGE),
                  "holder": tool("holder", DIE, 3.0)},
        "stages": [{"name": "draw", "velocity": "5 m/s",
                    "tools": {"punch": {"stroke": 44}, "holder": {"force": HOLDER}}}],
        "output": {"steps": 1},
    }  # fmt: skip


@cache
def draw_cup(sheet: str, size: float = 2.0, folder: str = "") -> Rim:
    """Draw a cup: "aluminium", "steel", "turned" (Hill 1948), "isotropic" aluminium, or a material of the library."""
    material: dict[str, Any] | str = sheet
    if sheet in HILL:
        r = dict(zip(("r00", "r45", "r90"), HILL[sheet], strict=True))
        material = {**(STEEL if sheet == "steel" else ALUMINIUM), "yield_function": {"law": "hill1948", **r}}
    elif sheet == "isotropic":
        material = ALUMINIUM
    model = build_model(StampingCase.model_validate(make_case(material, size)))
    with tempfile.TemporaryDirectory() as scratch:
        outcome = run_model(model, Path(folder or scratch) / sheet, overwrite=True)
        assert outcome.status == "completed", f"{sheet}: {outcome.reason}"
        result = outcome.result
        start, now, cells = model.mesh.points, result.points(-1), model.mesh.blocks[0].connectivity
        strain = result.field("thickness_strain", -1)
    radius = np.hypot(start[:, 0], start[:, 1])
    rim = np.flatnonzero(radius > 0.5 * BLANK - 1e-6)
    angle = np.degrees(np.arctan2(start[rim, 1], start[rim, 0]))
    order = np.argsort(angle)
    outer = np.flatnonzero(np.isin(cells, rim).any(axis=1))
    middle = start[cells[outer]].mean(axis=1)
    outer = outer[np.argsort(np.arctan2(middle[:, 1], middle[:, 0]))]
    volume = (_areas(now[cells]) * np.exp(strain)).sum() / _areas(start[cells]).sum()
    height = now[rim, 2] - now[radius.argmin(), 2]
    return Rim(angle[order], height[order], strain[outer], float(volume))


def _areas(corners: np.ndarray) -> np.ndarray:
    diagonals = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return np.asarray(0.5 * np.linalg.norm(np.cross(*diagonals), axis=1))


def hill_r(angle: float | np.ndarray, r00: float, r45: float, r90: float) -> np.ndarray:
    """Return r in tension at an angle [degree] from the rolling direction (Hill 1950, XII.3)."""
    s, c = np.sin(np.radians(angle)) ** 2, np.cos(np.radians(angle)) ** 2
    f, g, h = r00 / r90, 1.0, r00
    n = (r00 + r90) * (1 + 2 * r45) / (2 * r90)
    return np.asarray((h + (2 * n - f - g - 4 * h) * s * c) / (f * s + g * c))


def height_by_hoop_compression(r: float | np.ndarray) -> np.ndarray:
    """Return the height [mm] if all the wall had come in under hoop stress alone, r that across the radius.

    Then a ring's radial strain is r/(1 + r) of its hoop strain ln(radius/cup's radius). That is so at the rim, whose
    edge is free; further in the radial tension stretches the sheet, and the cup is higher.
    """
    cup, corner = 0.5 * PUNCH + 0.5 * THICKNESS, PUNCH_EDGE + 0.5 * THICKNESS
    power = 1 + np.asarray(r) / (1 + np.asarray(r))
    return np.asarray(corner + cup / power * ((0.5 * BLANK / cup) ** power - (_bottom() / cup) ** power))


def height_by_constant_area() -> float:
    """Return the height [mm] of a cup whose sheet keeps its thickness."""
    return PUNCH_EDGE + 0.5 * THICKNESS + (0.25 * BLANK**2 - _bottom() ** 2) / (PUNCH + THICKNESS)


def _bottom() -> float:
    """Radius [mm] of the piece of the blank that has the area of the bottom with its corner."""
    flat, corner = 0.5 * PUNCH - PUNCH_EDGE, PUNCH_EDGE + 0.5 * THICKNESS
    return float(np.sqrt(flat**2 + np.pi * corner * flat + 2 * corner**2))


def draw_picture(path: str, rims: dict[str, Rim]) -> None:
    """Draw the height of the rim round a quarter of each cup."""
    from presswork.view.style import clean_axes, new_figure

    figure = new_figure(6.0, 3.8)
    axes = figure.add_subplot()
    for name, rim in rims.items():
        axes.plot(rim.angle, rim.height, ".-", markersize=3, linewidth=1.0, label=name)
    axes.set_xlabel("angle from the rolling direction [degree]")
    axes.set_ylabel("height of the rim [mm]")
    axes.set_xticks(range(0, 91, 15))
    axes.legend(frameon=False, fontsize=7)
    clean_axes(axes)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    cups = {name: draw_cup(name) for name in ("isotropic", "aluminium", "turned", "steel", "aa6016_t4")}
    print(f"constant area: {height_by_constant_area():.2f} mm; heights at 0, 45, 90 degrees [mm]")
    for name, rim in cups.items():
        print(f"{name:10s}", *(f"{rim.at(a):6.2f}" for a in (0, 45, 90)), f"mean {rim.height.mean():.2f},",
              f"{100 * rim.amplitude:.2f} %, ears at", *(f"{a:.0f}" for a in rim.ears),
              f"; volume {rim.volume:.4f}; rim's thickness strain {rim.thickness_strain.min():.3f} to "
              f"{rim.thickness_strain.max():.3f}")  # fmt: skip
        if name in HILL:
            theory = height_by_hoop_compression(hill_r(np.array([90, 45, 0]), *HILL[name]))
            print(" " * 10, *(f"{h:6.2f}" for h in theory), "by hoop compression")
    if len(sys.argv) > 1:
        draw_picture(sys.argv[1], cups)
