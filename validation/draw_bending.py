# SPDX-License-Identifier: Apache-2.0
"""Draw bending of a strip (NUMISHEET'93, mild steel): what its springback converges to, and the theory of its wall.

    python -m validation.draw_bending [docs/img/draw_bending.png]

draws a slice of the strip with shells of several sizes, at several speeds and with several points through the
thickness, and strips of several widths with free edges, a quarter of an hour, and prints the angles of wall and
flange after springback and the radius of the wall's curl.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from presswork.case import StampingCase, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Model, PrescribedDisplacement
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.process.line.released_model import make_springback_model
from presswork.process.mesh_change.transfer import begin_with, carry_to_explicit
from presswork.recorder import run_model

LENGTH, THICKNESS, EDGE, STROKE, MU, HOLDER = 350.0, 0.78, 5.0, 70.0, 0.144, 70.0
"""Of the benchmark [mm]; HOLDER: 2.45 kN on 35 mm [N/mm]. Punch 50 mm, die opening 52 mm."""
YOUNG, POISSON, K, E0, N, R00, R90 = 206e3, 0.3, 565.32, 0.007117, 0.2589, 1.79, 2.27
"""Of its mild steel, as in the library."""
NO_WIDTH_STRAIN = {
    "young": YOUNG, "poisson": 0.0, "density": "7800 kg/m^3",
    "yield_function": {"law": "hill1948", "r00": 0.01, "r45": 0.5, "r90": 0.01},
    "hardening": {"law": "swift", "K": K, "e0": E0, "n": N},
}  # fmt: skip
"""The same steel in uniaxial tension, but that it does not narrow."""
ISOTROPIC = {key: NO_WIDTH_STRAIN[key] for key in ("young", "density", "hardening")} | {"poisson": POISSON}
"""The same steel with von Mises's law."""
MATERIALS = {"numisheet93_mild_steel": {}, "no_width_strain": NO_WIDTH_STRAIN, "isotropic": ISOTROPIC}
WIDTHS = ((35, 1, 3.5), (35, 1, 2.5), (35, 1.25, 1.25), (35, 1.25, 3.5), (15, 1.25, 1.25), (7.5, 1.25, 1.25),
          (2.5, 1.25, 1.25), (2.5, 0.625, 0.625), (2.5, 1.25, 0.3125), (1, 1.25, 0.5), (0.5, 1.25, 0.25))  # fmt: skip
"""Of strips with free edges, with the sides of their shells along and across [mm]."""
WALL = (40.0, 10.0)
"""From there on the blank, from its middle, and up to so far beyond the stroke [mm]: drawn over the die's shoulder and
off it again, whatever the mesh."""


@dataclass(frozen=True)
class Hat:
    """Half the strip, from its middle outwards."""

    formed: np.ndarray
    """Nodes (n, 2) before springback, x and z [mm]."""
    free: np.ndarray
    """After springback."""
    along: np.ndarray
    """Where they are on the blank (n,) [mm]."""
    tension: float
    """Mean punch force over the second half of the stroke, per width and wall [N/mm]."""
    stroke: float
    """Of the punch [mm]."""
    kinetic: float
    """Largest kinetic over internal energy while drawing, after a tenth of the stroke."""

    def slope(self, start: float, end: float) -> float:
        """Angle of the free strip between two places of the blank from the horizontal [degree], 0 to 180."""
        place = np.column_stack([np.interp((start, end), self.along, self.free[:, i]) for i in (0, 1)])
        return float(np.degrees(np.arctan2(*(place[1] - place[0])[::-1])))

    @property
    def angles(self) -> tuple[float, float]:
        """Between bottom and wall beside the punch, and between wall beside the die and flange; 90 as drawn."""
        return 180.0 - self.slope(35, 45), 180.0 + self.slope(130, 170) - self.slope(75, 85)

    @property
    def curl(self) -> float:
        """Radius of the wall [mm], by least squares."""
        wall = (self.along > WALL[0]) & (self.along < self.stroke + WALL[1])
        x, z = self.free[wall].T
        (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, z, np.ones_like(x)]), x**2 + z**2, rcond=None)
        return float(np.sqrt(c + 0.25 * (a**2 + b**2)))


def strip_case(
    size: float,
    speed: float,
    points: int = 9,
    *,
    width: float | None = None,
    across: float | None = None,
    material: str = "numisheet93_mild_steel",
    length: float = LENGTH,
    stroke: float = STROKE,
    thickness: float = THICKNESS,
    **explicit: Any,
) -> dict[str, Any]:
    """Return the case of a slice one shell wide, size [mm], or of a strip of a width, with free edges; speed [m/s].

    across: side of its shells across [mm]. material: of MATERIALS.
    explicit: keys of its settings.
    """
    breadth = 2 * size if width is None else width

    def tool(kind: str, opening: float) -> dict[str, Any]:
        return {"kind": kind, "shape": "strip", "width": opening, "edge_radius": EDGE, "mu": MU}

    return {
        "title": "draw bending",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [length, breadth], "thickness": thickness,
                  "element_size": [size, across or size], "points": points, "symmetry": ["x", "y"],
                  "material": material},
        "materials": {material: own} if (own := MATERIALS[material]) else {},
        "explicit": explicit,
        "boundary": {} if width else {"slice": {"set": "top", "hold": "symmetry_y"}},
        "tools": {"punch": tool("punch", 50), "die": tool("die", 52), "holder": tool("holder", 52)},
        "stages": [{"name": "draw", "velocity": f"{speed} m/s",
                    "tools": {"punch": {"stroke": stroke}, "holder": {"force": f"{HOLDER * breadth} N"}}}],
        "springback": {},
        "output": {"steps": 1, "rows": 100},
    }  # fmt: skip


def strip_model(case: dict[str, Any]) -> Model:
    """Return the Model of a case."""
    model = build_model(StampingCase.model_validate(case))
    return model


@cache
def draw_strip(size: float, speed: float, points: int = 9, *, stroke: float = STROKE, **what: Any) -> Hat:
    """Draw the strip of strip_case, and let it go."""
    model = strip_model(strip_case(size, speed, points, stroke=stroke, **what))
    with tempfile.TemporaryDirectory() as scratch:
        outcome = run_model(model, Path(scratch) / "out")
        assert outcome.status == "completed", outcome.reason
        result = outcome.result
        formed, free, history = result.points(-2), result.points(-1), result.history
    start = model.mesh.points
    row = np.flatnonzero(start[:, 1] < 1e-9)
    row = row[np.argsort(start[row, 0])]
    drawn = history["stage"] == "draw"
    done, force = history["punch.stroke"][drawn], history["punch.force"][drawn]
    late = (done > 0.5 * stroke) & (done < 0.97 * stroke)
    ratio = (history["kinetic_energy"][drawn] / history["internal_energy"][drawn])[done > 0.1 * stroke]
    tension = force[late].mean() / (2 * (what.get("width") or 2 * size))
    return Hat(formed[row][:, [0, 2]], free[row][:, [0, 2]], start[row, 0], float(tension), stroke, float(ratio.max()))


def release_slowly(
    fade: float = 0.032, rest: float = 0.016, damping: float = 450.0, *, thicker: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Let a strip of 7.5 mm go by the implicit procedure, and by explicit dynamics; returns both displacements (n, 3).

    thicker: part by which the strip is thicker. Explicit: from the same state, with one-point shells; the force that
    they begin with fades in so long [s], and they rest for so long, under a damping [1/s] of half the critical one of
    the strip's first mode.
    """
    thickness = THICKNESS * (1.0 + thicker)
    forming = ExplicitStamping(
        strip_model(strip_case(1.25, 2, 7, width=7.5, length=200, stroke=45, thickness=thickness))
    )
    for _ in forming.advance():
        pass
    sheet, model = forming.sheet(), make_springback_model(forming.model, forming.mesh)
    implicit = ImplicitProcedure(model)
    begin_with(sheet, implicit)
    shells = carry_to_explicit(implicit)
    for support in model.supports:
        held = "".join(letter for letter, fixed in zip("uvwpqr", support.fix, strict=True) if fixed)
        shells.fix(model.mesh.node_sets[support.node_set], held)
    shells.force = shells.internal_force
    cycles = int((fade + rest) / shells.dt)
    scale = np.maximum(0.0, 1.0 - np.arange(cycles) * shells.dt / fade)
    shells.advance(cycles, force_scale=scale, damping=damping)
    for _ in implicit.advance():
        pass
    way = implicit.state.nodes.displacement[:, :3] + model.mesh.points - sheet.position
    return way, shells.position - sheet.position


def bend_and_straighten(width: float | None = None, half: float = 8.0) -> float:
    """Turn the end of half a strip [mm] until it has the shoulder's curvature, and back, without tools or tension.

    Returns the curvature that it gives up when it is let go [1/mm]; width: of a strip with free edges; else a slice.
    """
    side = half / 8
    case = strip_case(side, 2, 15, width=width, across=width and width / 2, length=2 * half)
    ways = {"bend": half / (EDGE + 0.5 * THICKNESS), "straighten": -half / (EDGE + 0.5 * THICKNESS)}
    case |= {
        "tools": {},
        "stages": [{"name": name, "duration": "20 ms"} for name in ways],
        "explicit": {"damping": 2e3},
    }
    model = strip_model(case)
    stages = (replace(s, prescribed=(PrescribedDisplacement("right", 4, ways[s.name]),)) for s in model.stages)
    model = replace(model, stages=tuple(stages))
    with tempfile.TemporaryDirectory() as scratch:
        outcome = run_model(model, Path(scratch) / "out")
        assert outcome.status == "completed", outcome.reason
        shapes = [outcome.result.points(step) for step in (-2, -1)]
    row = np.flatnonzero(model.mesh.points[:, 1] < 1e-9)
    row = row[np.argsort(model.mesh.points[row, 0])][:6]  # away from the end, where the strip is free to curl across
    slopes = [np.arctan2(*np.diff(shape[row][:, [2, 0]], axis=0).T) for shape in shapes]
    bent, free = ((slope[-1] - slope[0]) / (4 * side) for slope in slopes)
    return float(abs(free - bent))


def curl_by_theory(tension: float, layers: int = 201, steps: int = 150, *, beam: bool = False) -> float:
    """Return the radius [mm] of a sheet in plane strain bent round the shoulder and straightened under tension [N/mm].

    Layers stay plane and under no stress across; Hill 1948, isotropic hardening, the sheet thins by its mean strain;
    springback by M/(E' I). No element, no contact, no dynamics. The sheet is taken to fit the shoulder. beam: of layers
    in uniaxial stress, free to narrow, and springback by M/(E I).
    """
    h = R00 / (1 + R00)
    ratio = 1.0 if beam else 1 / np.sqrt(1 - h**2 / (h + h / R90))
    modulus = YOUNG if beam else YOUNG / (1 - POISSON**2)
    height = THICKNESS * ((np.arange(layers) + 0.5) / layers - 0.5)
    stress, plastic, mean, before = np.zeros(layers), np.zeros(layers), 0.0, 0.0

    def update(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        trial = stress + modulus * strain
        flow = np.zeros(layers)
        for _ in range(6):
            base = E0 + plastic + ratio * flow
            excess = np.abs(trial) - modulus * flow - ratio * K * base**N
            flow = np.maximum(flow + excess / (modulus + ratio**2 * K * N * base ** (N - 1)), 0.0)
        return np.sign(trial) * (np.abs(trial) - modulus * flow), plastic + ratio * flow

    tightest = 1 / (EDGE + 0.5 * THICKNESS)
    bend = np.linspace(0, tightest, steps + 1)[1:]
    for number, curvature in enumerate([*bend, *(tightest - bend)], 1):
        thinned = np.exp(-mean)
        bending = (curvature - before) * height * thinned
        pull = tension * min(1.0, number / 10) / (THICKNESS * thinned)
        more = brentq(lambda e, b=bending, p=pull: update(e + b)[0].mean() - p, -0.05, 0.05, xtol=1e-12)
        stress, plastic = update(more + bending)
        mean, before = mean + more, curvature
    moment = (stress * height).mean() * THICKNESS * np.exp(-2 * mean)
    return float(-modulus * (THICKNESS * np.exp(-mean)) ** 3 / 12 / moment)


def draw_picture(path: str, hats: dict[str, Hat]) -> None:
    """Draw the free strips."""
    from presswork.view.style import clean_axes, new_figure

    figure = new_figure(6.0, 4.0)
    axes = figure.add_subplot()
    last = next(reversed(hats.values()))
    axes.plot(*last.formed.T, "k--", linewidth=0.8, label="as drawn")
    for name, hat in hats.items():
        axes.plot(*hat.free.T, linewidth=1.1, label=name)
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("z [mm]")
    axes.legend(frameon=False, fontsize=7)
    clean_axes(axes)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    runs = [(4, 2, 9), (2.8, 2, 9), (2, 2, 9), (1.4, 2, 9), (1, 2, 9), (0.7, 2, 9),
            (1, 5, 9), (1, 1, 9), (0.7, 5, 9), (2, 5, 9), (2, 1, 9), (1, 5, 5), (1, 5, 7), (1, 5, 15)]  # fmt: skip
    print("shell [mm], m/s, points: bottom-wall, wall-flange [degree], curl, rise of the end [mm], kinetic, tension")
    for size, speed, points in runs:
        hat = draw_strip(size, speed, points)
        print(f"{size:8.1f} {speed:6} {points:6} {hat.angles[0]:12.2f} {hat.angles[1]:12.2f} {hat.curl:18.1f} "
              f"{hat.free[-1, 1] - hat.formed[-1, 1]:14.2f} {100 * hat.kinetic:10.2f} % {hat.tension:8.1f}",
              flush=True)  # fmt: skip
    print("260 mm long, 60 mm deep, 2 m/s, 7 points: width, sides of shells [mm]: way of the end [mm], curl, theory")
    strips = [*((None, s, s, True) for s in (1.25, 1, 0.625)), (None, 1.25, 1.25, False),
              (2.5, 1.25, 1.25, False), (0.5, 1.25, 0.25, False)]  # fmt: skip
    for width, size, across, narrows in [*strips, *((*strip, True) for strip in WIDTHS)]:
        steel = "numisheet93_mild_steel" if narrows else "no_width_strain"
        hat = draw_strip(size, 2, 7, width=width, across=across, material=steel, length=260, stroke=60)
        way, beam = np.hypot(*(hat.free[-1] - hat.formed[-1])), width is not None or not narrows
        print(f"{width or 'slice':>8} {size:6} {across:7} {'' if narrows else 'no width strain':15} {way:8.2f} "
              f"{hat.curl:8.1f} {curl_by_theory(hat.tension, beam=beam):8.1f}", flush=True)  # fmt: skip
    ways = [np.linalg.norm(way, axis=1).max() for way in release_slowly()]
    print("7.5 mm wide, 45 mm deep, let go: implicit {:.2f} mm, explicit {:.2f} mm".format(*ways), flush=True)
    print(*(f"theory under {t} N/mm: {curl_by_theory(t):.1f} mm;" for t in (10, 35, 50)))
    if len(sys.argv) > 1:
        draw_picture(sys.argv[1], {f"shells of {s} mm": draw_strip(s, 2) for s in (4, 2, 1, 0.7)})
