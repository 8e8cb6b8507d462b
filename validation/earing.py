# SPDX-License-Identifier: Apache-2.0
"""Ears of a cylindrical cup: sheets of different anisotropy, drawn through.

    python -m validation.earing [docs/img/earing.png]

prints the height of the rim round the cup beside the theory of hoop compression and what was measured, three minutes,
and draws it.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from presswork.case import StampingCase, build_model
from presswork.case.material.library import find_sheet
from presswork.material.predict import predict_tension
from presswork.recorder import run_model


@dataclass(frozen=True)
class Cup:
    """Tools and blank; diameters, radii, lengths [mm]."""

    blank: float
    thickness: float
    punch: float
    punch_edge: float
    die: float
    die_edge: float
    mu: float
    holder: Any
    """Its force, or rows of stroke [mm] and force; None: it stands at the gap."""
    stroke: float
    """By which the cup is drawn through."""
    size: float
    """Of the shells."""
    gap: float | None = None
    """Between holder and die."""
    ironing: bool = True
    """Whether tools squeeze the sheet thinner."""


ESAFORM = Cup(
    107.5, 1.0, 60.0, 5.0, 62.4, 10.0, 0.07,
    ((0, "8 kN"), (15, "4.4 kN"), (22, "1.6 kN"), (27, "0.4 kN"), (44, "0.4 kN")), 44, 2.0, ironing=False)  # fmt: skip
"""Tools of the benchmark of 2021, their holder pushed with about 2 MPa on the flange that is left.

The rim is not ironed, so that it may be held against the theory of a free edge.
"""
IRONED = replace(ESAFORM, holder=None, gap=1.04, mu=0.04, ironing=True)
"""The cup as the benchmark draws it, the holder at its gap; docs/verification/earing.md explains the friction."""
YOON = Cup(158.76, 1.6, 97.46, 12.7, 101.48, 12.7, 0.1, "22.2 kN", 60, 3.0)
"""That of AA2090-T3, Yoon, Barlat, Chung, Pourboghrat & Yang, Int. J. Plasticity 16 (2000) 1075, as commonly quoted."""

ALUMINIUM = {"young": "70 GPa", "poisson": 0.33,
             "hardening": {"law": "voce", "yield_stress": 140.2, "saturation_stress": 330.2, "rate": 12.4}}  # fmt: skip
STEEL = {"young": "206 GPa", "poisson": 0.3,
         "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}  # fmt: skip
HILL = {"aluminium": (0.526, 0.253, 0.601), "steel": (1.79, 1.51, 2.27), "turned": (0.253, 0.526, 0.253)}
"""r00, r45, r90: AA6016-T4 and NUMISHEET'93's mild steel; the first with its largest and smallest exchanged."""
ANGLES = np.arange(0.0, 91.0, 15.0)
MEASURED_R = {"aa2090_t3": (0.2115, 0.3269, 0.6923, 1.5769, 1.0385, 0.5384, 0.6923)}
"""In tension every 15 degrees from the rolling direction (Barlat et al., Int. J. Plasticity 19 (2003) 1297)."""


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
    ironed: float
    """Height [mm] that would be won if what is thicker than the gap between punch and die were thinned to it."""

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


def make_case(cup: Cup, material: dict[str, Any] | str, size: float) -> dict[str, Any]:
    """Return the case of a quarter of the cup."""

    def tool(kind: str, diameter: float, edge: float) -> dict[str, Any]:
        return {"kind": kind, "shape": "round", "diameter": diameter, "edge_radius": edge, "mu": cup.mu}

    own = {"materials": {"sheet": material}} if isinstance(material, dict) else {}
    tools = {"punch": tool("punch", cup.punch, cup.punch_edge), "die": tool("die", cup.die, cup.die_edge),
             "holder": tool("holder", cup.die, 3.0)}  # fmt: skip
    motions: dict[str, Any] = {"punch": {"stroke": cup.stroke}}
    if cup.gap is not None:
        tools["holder"]["gap"] = cup.gap
    else:
        motions["holder"] = {"force": cup.holder}
    return {
        "title": "cylindrical cup with ears",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": cup.blank, "thickness": cup.thickness, "element_size": size,
                  "material": "sheet" if own else material, "symmetry": ["x", "y"]},
        **own,
        "tools": tools,
        "explicit": {"ironing": cup.ironing},
        "stages": [{"name": "draw", "velocity": "5 m/s", "tools": motions}],
        "output": {"steps": 1},
    }  # fmt: skip


@cache
def draw_cup(sheet: str, cup: Cup = ESAFORM, size: float | None = None) -> Rim:
    """Draw a cup: "aluminium", "steel", "turned" (Hill 1948), "isotropic" aluminium, or a material of the library.

    size: of the shells, if not the cup's own [mm].
    """
    material: dict[str, Any] | str = sheet
    if sheet in HILL:
        r = dict(zip(("r00", "r45", "r90"), HILL[sheet], strict=True))
        material = {**(STEEL if sheet == "steel" else ALUMINIUM), "yield_function": {"law": "hill1948", **r}}
    elif sheet == "isotropic":
        material = ALUMINIUM
    return draw_material(material, cup, size or cup.size)


def draw_material(material: dict[str, Any] | str, cup: Cup, size: float) -> Rim:
    """Draw a cup of a material, by its table or by its name in the library; size: of the shells [mm]."""
    model = build_model(StampingCase.model_validate(make_case(cup, material, size)))
    with tempfile.TemporaryDirectory() as scratch:
        outcome = run_model(model, Path(scratch) / "cup")
        assert outcome.status == "completed", outcome.reason
        result = outcome.result
        start, now, cells = model.mesh.points, result.points(-1), model.mesh.blocks[0].connectivity
        strain = result.field("thickness_strain", -1)
    radius = np.hypot(start[:, 0], start[:, 1])
    rim = np.flatnonzero(radius > 0.5 * cup.blank - 1e-6)
    angle = np.degrees(np.arctan2(start[rim, 1], start[rim, 0]))
    order = np.argsort(angle)
    outer = np.flatnonzero(np.isin(cells, rim).any(axis=1))
    middle = start[cells[outer]].mean(axis=1)
    outer = outer[np.argsort(np.arctan2(middle[:, 1], middle[:, 0]))]
    volume = (_areas(now[cells]) * np.exp(strain)).sum() / _areas(start[cells]).sum()
    height = now[rim, 2] - now[radius.argmin(), 2]
    gap, round_quarter = 0.5 * (cup.die - cup.punch), 0.25 * np.pi * (cup.punch + cup.thickness)
    excess = np.maximum(cup.thickness * np.exp(strain) - gap, 0.0) @ _areas(now[cells])
    return Rim(angle[order], height[order], strain[outer], float(volume), float(excess / gap / round_quarter))


def _areas(corners: np.ndarray) -> np.ndarray:
    diagonals = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return np.asarray(0.5 * np.linalg.norm(np.cross(*diagonals), axis=1))


def hill_r(angle: float | np.ndarray, r00: float, r45: float, r90: float) -> np.ndarray:
    """Return r in tension at an angle [degree] from the rolling direction (Hill 1950, XII.3)."""
    s, c = np.sin(np.radians(angle)) ** 2, np.cos(np.radians(angle)) ** 2
    f, g, h = r00 / r90, 1.0, r00
    n = (r00 + r90) * (1 + 2 * r45) / (2 * r90)
    return np.asarray((h + (2 * n - f - g - 4 * h) * s * c) / (f * s + g * c))


def library_r(name: str, angle: float | np.ndarray) -> np.ndarray:
    """Return r in tension at an angle [degree] by the yield function of a material of the library."""
    return predict_tension(find_sheet(name).material.yield_function.build(), np.asarray(angle)).r


def height_by_hoop_compression(r: float | np.ndarray, cup: Cup = ESAFORM) -> np.ndarray:
    """Return the height [mm] if all the wall had come in under hoop stress alone, r that across the radius.

    Then a ring's radial strain is r/(1 + r) of its hoop strain ln(radius/cup's radius). That is so at the rim, whose
    edge is free; further in the radial tension stretches the sheet, and the cup is higher.
    """
    wall, corner = 0.5 * (cup.punch + cup.thickness), cup.punch_edge + 0.5 * cup.thickness
    power = 1 + np.asarray(r) / (1 + np.asarray(r))
    return np.asarray(corner + wall / power * ((0.5 * cup.blank / wall) ** power - (_bottom(cup) / wall) ** power))


def height_by_constant_area(cup: Cup = ESAFORM) -> float:
    """Return the height [mm] of a cup whose sheet keeps its thickness."""
    wall = cup.punch_edge + 0.5 * cup.thickness
    return wall + (0.25 * cup.blank**2 - _bottom(cup) ** 2) / (cup.punch + cup.thickness)


def _bottom(cup: Cup) -> float:
    """Radius [mm] of the piece of the blank that has the area of the bottom with its corner."""
    flat, corner = 0.5 * cup.punch - cup.punch_edge, cup.punch_edge + 0.5 * cup.thickness
    return float(np.sqrt(flat**2 + np.pi * corner * flat + 2 * corner**2))


def read_measured() -> np.ndarray:
    """Return angle from the rolling direction [degree] and height [mm] of the benchmark's rim as measured (n, 2)."""
    path = Path(__file__).parents[1] / "tests" / "data" / "ears_aa6016_t4.csv"
    return np.loadtxt(path, delimiter=",", skiprows=2)


def fold(profile: np.ndarray) -> np.ndarray:
    """Return a rim measured all round (n, 2) in the first quarter: each angle as far as its mirror images."""
    away = np.abs((profile[:, 0] + 90.0) % 180.0 - 90.0)
    return np.column_stack([away, profile[:, 1]])[np.argsort(away)]


def mean_quarters() -> np.ndarray:
    """Return the measured height [mm] at ANGLES, the mean of the quarters."""
    angle, height = fold(read_measured()).T
    return np.array([height[np.abs(angle - a) < 8].mean() for a in ANGLES])


def draw_picture(path: str, cups: dict[str, Rim], ironed: Rim, six: Rim) -> None:
    """Draw the height of the rim round a quarter of each cup."""
    from presswork.view.style import clean_axes, new_figure

    figure = new_figure(9.0, 3.8)
    left, right = figure.subplots(1, 2)
    for name, rim in cups.items():
        left.plot(rim.angle, rim.height, ".-", markersize=3, linewidth=1.0, label=name)
    left.plot(ironed.angle, ironed.height, linewidth=1.6, color="black", label="aa6016_t4, ironed")
    left.plot(*fold(read_measured()).T, "kx", markersize=4, label="AA6016-T4, measured")
    left.set_title("ESAFORM 2021", fontsize=8)
    right.plot(six.angle, six.height, ".-", markersize=3, linewidth=1.0, label="presswork, Yld2000-2d")
    angle = np.linspace(0.0, 90.0, 91)
    ruled = height_by_hoop_compression(library_r("aa2090_t3", 90.0 - angle), YOON)
    right.plot(angle, ruled, linewidth=1.0, label="hoop compression, r by Yld2000-2d")
    ruled = height_by_hoop_compression(np.array(MEASURED_R["aa2090_t3"])[::-1], YOON)
    right.plot(np.arange(0.0, 91.0, 15.0), ruled, "kx:", markersize=4, linewidth=0.7, label="the same, r measured")
    right.set_title("AA2090-T3", fontsize=8)
    for axes in (left, right):
        axes.set_xlabel("angle from the rolling direction [degree]")
        axes.set_ylabel("height of the rim [mm]")
        axes.set_xticks(range(0, 91, 15))
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.3 * (high - low))  # room for the legend
        axes.legend(frameon=False, fontsize=7, ncols=2, loc="upper center")
        clean_axes(axes)
    figure.savefig(path, dpi=130)


def describe(name: str, rim: Rim) -> str:
    """Return the line that is printed of a cup."""
    strain = rim.thickness_strain
    return (
        f"{name:10s} {rim.at(0):6.2f} {rim.at(45):6.2f} {rim.at(90):6.2f} mean {rim.height.mean():.2f}, "
        f"{100 * rim.amplitude:.2f} %, ears at {', '.join(f'{a:.0f}' for a in rim.ears)}; volume {rim.volume:.4f}; "
        f"rim's thickness strain {strain.min():.3f} to {strain.max():.3f}; ironing would add {rim.ironed:.2f} mm"
    )


if __name__ == "__main__":
    cups = {name: draw_cup(name) for name in ("isotropic", "aluminium", "turned", "steel", "aa6016_t4")}
    print(f"constant area: {height_by_constant_area():.2f} mm; heights at 0, 45, 90 degrees [mm]")
    for name, rim in cups.items():
        print(describe(name, rim))
        if name in HILL:
            theory = height_by_hoop_compression(hill_r(np.array([90, 45, 0]), *HILL[name]))
            print(" " * 10, *(f"{h:6.2f}" for h in theory), "by hoop compression")
    ironed = draw_cup("aa6016_t4", IRONED)
    print(describe("the same, ironed", ironed))
    means = mean_quarters()
    print("measured, mean of the quarters at 0, 15 ... 90 degrees:", *(f"{h:.2f}" for h in means))
    for name, rim in (("not ironed", cups["aa6016_t4"]), ("ironed", ironed)):
        heights = np.array([rim.at(a) for a in ANGLES])
        off = 100 * (heights / means - 1)
        print(f"{name}:", *(f"{h:.2f}" for h in heights), "mm, off by", *(f"{d:+.1f}" for d in off), "%")
    six = draw_cup("aa2090_t3", YOON)
    print(f"AA2090-T3, constant area {height_by_constant_area(YOON):.2f} mm:")
    print(describe("aa2090_t3", six))
    angle = np.arange(0.0, 91.0, 15.0)
    print("computed at 0, 15 ... 90 degrees:", *(f"{six.at(a):.2f}" for a in angle))
    for said, r in (("Yld2000-2d", library_r("aa2090_t3", angle)), ("measured", np.array(MEASURED_R["aa2090_t3"]))):
        print(
            f"by hoop compression, r {said:10s}:",
            *(f"{h:.2f}" for h in height_by_hoop_compression(r[::-1], YOON)),
        )
    if len(sys.argv) > 1:
        draw_picture(sys.argv[1], cups, ironed, six)
