# SPDX-License-Identifier: Apache-2.0
"""Forward extrusion of a round bar: steady pressure against the slab method and Avitzur's upper bound.

The billet's nose fills the die from the start, so that the force is steady after some millimetres. The metal is as good
as perfectly plastic (500 + p MPa), the container frictionless, the bearing short.
Run: python -m validation.extrusion [--picture docs/img/extrusion.png] [--billets src/presswork/examples]
"""

from __future__ import annotations

import argparse
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import presswork
from validation.extrusion_theory import avitzur, slab_shear

YIELD = 500.0
"""Flow stress [MPa]."""
OVERLAP = 0.3
"""How far the die reaches up into the container [mm]: a node at the joint, where friction jumps, then has no choice."""
FROM = 0.6
"""Part of the stroke after which the force is steady."""


@dataclass(frozen=True)
class Die:
    """A die of exit radius `exit_` [mm] below a container of radius `entry`; the metal flows downwards."""

    entry: float
    exit_: float
    angle: float
    """Half the cone's angle [degrees]; 0 for the curved die."""
    length: float
    """Of the curved die [mm]."""
    fillet: float
    """Of the cone's two corners [mm]."""
    land: float
    """Length of the bearing [mm]."""

    @property
    def top(self) -> float:
        """Where the die begins to narrow [mm]."""
        return self.fillet * np.tan(np.radians(self.angle) / 2)

    @property
    def bottom(self) -> float:
        """Where the cone, or the curve, ends and the bearing begins, but for the fillet [mm]."""
        return -(self.entry - self.exit_) / np.tan(np.radians(self.angle)) if self.angle else -self.length

    def profile(self) -> list[Any]:
        """Return the profile as in a case, from OVERLAP inside the container down to a relief of 0.4 mm."""
        r0, rf, end = self.entry, self.exit_, self.bottom
        above = [r0, round(self.top + OVERLAP, 6)]
        if self.angle:
            body = [{"to": [r0, 0.0], "radius": self.fillet}, {"to": [rf, end], "radius": self.fillet}]
        else:
            arc, half = self._arc_radius(), [0.5 * (r0 + rf), 0.5 * end]
            body = [
                {"to": half, "centre": [r0 - arc, 0.0], "turn": "right"},
                {"to": [rf, end], "centre": [rf + arc, end], "turn": "left"},
            ]
            body.insert(0, [r0, 0.0])
        relief = [{"to": [rf, end - self.land], "radius": 0.2}, [rf + 0.4, end - self.land - 1], [rf + 0.4, -80.0]]
        return [above, *body, *relief]

    def _arc_radius(self) -> float:
        draft = self.entry - self.exit_
        return (self.length**2 + draft**2) / (4 * draft)

    def radius(self, y: float) -> float:
        """Return the die's radius at a height, fillets included [mm]."""
        r0, rf, end = self.entry, self.exit_, self.bottom
        if not self.angle:
            arc = self._arc_radius()
            if y >= 0 or y <= end:
                return r0 if y >= 0 else rf
            upper = r0 - arc + np.sqrt(arc**2 - y**2)
            lower = rf + arc - np.sqrt(arc**2 - (y - end) ** 2)
            return float(upper if y > 0.5 * end else lower)
        a, r = np.radians(self.angle), self.fillet
        reach = self.top
        if y >= reach or y <= end - reach:
            return r0 if y >= reach else rf
        if y > reach - r * np.sin(a):
            return float(r0 - r + np.sqrt(r**2 - (y - reach) ** 2))
        if y < end - reach + r * np.sin(a):
            return float(rf + r - np.sqrt(r**2 - (y - end + reach) ** 2))
        return float(r0 + y * np.tan(a))


def cone(angle: float, *, fillet: float = 1.0, land: float = 0.5) -> Die:
    """Return a die of 36 % reduction in area, from 20 mm to 16 mm, with a cone of half angle `angle` [degrees]."""
    return Die(10.0, 8.0, angle, 0.0, fillet, land)


def curve(length: float = 8.0, *, land: float = 0.5) -> Die:
    """Return a die of the same reduction of two arcs that leave container and bearing without a corner."""
    return Die(10.0, 8.0, 0.0, length, 0.0, land)


def write_billet(path: Path, die: Die, across: int, length: float) -> float:
    """Write the mesh of a billet whose nose fills the die, as Abaqus .inp; return the height of its upper end [mm].

    `across`: cells along the radius; `length`: of the cylindrical part [mm]. Rows of quadrilaterals are level.
    """
    top = die.top + length
    rows = round((top - die.bottom) / (die.entry / across))
    heights = np.linspace(die.bottom, top, rows + 1)
    shrink = 1 - 2e-7  # clear of the die by less than the contact tolerance
    x = np.array([[shrink * die.radius(y) * i / across for i in range(across + 1)] for y in heights])
    points = np.column_stack([x.ravel(), np.repeat(heights, across + 1)])
    first = (np.arange(rows)[:, None] * (across + 1) + np.arange(across)[None, :] + 1).ravel()
    cells = np.column_stack([first, first + 1, first + across + 2, first + across + 1])
    lines = ["** Billet whose nose fills the die, from validation/extrusion.py", "*NODE"]
    lines += [f"{i}, {p[0]:.7f}, {p[1]:.7f}" for i, p in enumerate(points, 1)]
    lines += ["*ELEMENT, TYPE=CAX4, ELSET=BILLET"]
    lines += [f"{i}, " + ", ".join(map(str, c)) for i, c in enumerate(cells, 1)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return float(f"{top:.7f}")


@dataclass(frozen=True)
class Steady:
    """What one extrusion gives when it is steady; pressures over the flow stress."""

    stroke: np.ndarray
    """[mm], at every increment."""
    pressure: np.ndarray
    """At every increment."""
    mean: float
    low: float
    high: float
    strain: float
    """Equivalent plastic strain of the product, mean over its cross-section."""
    volume_error: float
    """Change of volume beyond the elastic part [%]."""
    energy_error: float
    """[%]"""
    counts: tuple[int, int, int]
    """Increments, iterations, cut-backs."""


@cache
def extrude(die: Die, m: float, across: int = 16, element: str = "quad4_fbar", stroke: float = 9.0) -> Steady:
    """Extrude with constant shear m at the die, a tenth of a millimetre an increment at most."""
    with tempfile.TemporaryDirectory() as folder:
        billet = Path(folder) / "billet.inp"
        top = write_billet(billet, die, across, 22.0)
        profile = die.profile()
        case = presswork.Case(
            title="extrusion",
            analysis="axisymmetric",
            workpiece={"material": "metal", "element": element, "mesh": {"path": str(billet)}},
            materials={
                "metal": {
                    "young": 200e3,
                    "poisson": 0.3,
                    "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": 1.0},
                }
            },
            tools={
                "ram": {"profile": [[0, top], [die.entry + 1, top]], "contact": "frictionless"},
                "container": {"profile": [[die.entry, 80], [die.entry, die.top + 1e-3]], "contact": "frictionless"},
                "die": {"profile": profile, "contact": "shear", "m": m},
            },
            boundary={"axis": {"set": "left", "fix": ["x"]}},
            stages=[{"name": "extrude", "tools": {"ram": {"stroke": stroke, "direction": [0, -1]}}}],
            solver={"max_increment": 0.1 / stroke, "initial_increment": 1e-3},
        )
        outcome = presswork.run(case, Path(folder) / "out", threads=1)
        if outcome.status != "completed":
            raise RuntimeError(f"{die}, m = {m}: {outcome.reason}")
        return _read_steady(outcome.result, die)


def _read_steady(result: presswork.Result, die: Die) -> Steady:
    """Return the figures of the steady part of a run."""
    history, summary = result.history, result.summary
    stroke, pressure = history["ram.stroke"], history["ram.force"] / (YIELD * np.pi * die.entry**2)
    steady = pressure[stroke > FROM * stroke[-1]]
    return Steady(
        stroke,
        pressure,
        float(steady.mean()),
        float(steady.min()),
        float(steady.max()),
        product_strain(result, die),
        summary["volume"]["change_percent"] - summary["volume"]["elastic_part_percent"],
        summary["energy"]["error_percent"],
        (summary["increments"], summary["iterations"], summary["cutbacks"]),
    )


def product_strain(result: presswork.Result, die: Die) -> float:
    """Return the equivalent plastic strain of the metal that has just left the die, mean over the cross-section.

    Cells whose centre lies within 1.5 mm below the bearing, weighted by their volume.
    """
    points, cells = result.points(-1), result.mesh.blocks[0].connectivity
    x, y = points[cells].transpose(2, 0, 1)
    area = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1))
    below = die.bottom - die.land - y.mean(axis=1)
    weight = np.where((below > 0) & (below < 1.5), area * x.mean(axis=1), 0.0)
    return float((weight * result.field("eqps", -1)).sum() / weight.sum()) if weight.any() else float("nan")


CASES: tuple[tuple[float, float], ...] = tuple(
    (angle, m) for angle in (10.0, 15.0, 20.0, 30.0) for m in (0.0, 0.1, 0.2)
)
"""Half angle [degrees] and friction factor; angle 0 is the curved die."""
CURVED = ((0.0, 0.0), (0.0, 0.1), (0.0, 0.2))


def make_die(angle: float) -> Die:
    """Return the cone of an angle [degrees], or for 0 the curved die."""
    return cone(angle) if angle else curve()


def theory(angle: float, m: float) -> tuple[float, float]:
    """Return p/sigma0 of the slab method, and of Avitzur's upper bound (NaN for the curved die)."""
    die = make_die(angle)
    slab = slab_shear(die.radius, die.top, die.bottom - die.land, m)
    upper = avitzur(die.entry, die.exit_, np.radians(angle), m, die.land) if angle else float("nan")
    return slab, upper


def run_case(angle: float, m: float) -> Steady:
    """Run one of CASES or CURVED until metal that was in the container leaves the die."""
    die = make_die(angle)
    return extrude(die, m, stroke=round(6.0 - 0.82 * die.bottom, 1))


def print_table(runs: dict[tuple[float, float], Steady]) -> None:
    """Print the table of docs/verification/forward_extrusion.md."""
    print("| die | m | slab | presswork | range | Avitzur | over slab | under Avitzur | strain of the product |")
    print("|---|---|---|---|---|---|---|---|---|")
    for (angle, m), run in runs.items():
        slab, upper = theory(angle, m)
        name = f"cone {angle:g}°" if angle else "curved"
        bound = f"{upper:.3f}" if angle else ""
        below = f"{100 * (run.mean / upper - 1):+.1f} %" if angle else ""
        print(
            f"| {name} | {m:g} | {slab:.3f} | {run.mean:.3f} | {run.low:.3f}-{run.high:.3f} | {bound} | "
            f"{100 * (run.mean / slab - 1):+.1f} % | {below} | {run.strain:.3f} |"
        )
    print(f"volume beyond elastic, at most {max(abs(r.volume_error) for r in runs.values()):.4f} %,", end=" ")
    print(f"energy, at most {max(abs(r.energy_error) for r in runs.values()):.2f} %;", end=" ")
    counts = np.array([r.counts for r in runs.values()])
    print(
        "increments, iterations, cut-backs: "
        + ", ".join(f"{a}-{b}" for a, b in zip(counts.min(0), counts.max(0), strict=True))
    )


def draw(path: str, runs: dict[tuple[float, float], Steady]) -> None:
    """Draw pressure against stroke, and steady pressure against the cone's angle with both theories."""
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), layout="constrained")
    angles, fine = sorted({a for a, _ in runs if a}), np.linspace(8, 32, 60)
    for i, m in enumerate((0.0, 0.1, 0.2)):
        colour = f"C{i}"
        left.plot(runs[15.0, m].stroke, runs[15.0, m].pressure, color=colour, lw=1.2, label=f"cone 15°, m = {m:g}")
        left.plot(runs[0.0, m].stroke, runs[0.0, m].pressure, "--", color=colour, lw=1.0, label=f"curved, m = {m:g}")
        right.plot(fine, [theory(a, m)[1] for a in fine], "-", color=colour, lw=1.0)
        right.plot(fine, [theory(a, m)[0] for a in fine], ":", color=colour, lw=1.2)
        means = np.array([[runs[a, m].mean, runs[a, m].low, runs[a, m].high] for a in angles])
        spread = np.abs(means[:, 1:] - means[:, :1]).T
        right.errorbar(
            angles, means[:, 0], spread, fmt="o", ms=4, capsize=3, color=colour, label=f"presswork, m = {m:g}"
        )
    right.plot([], [], "-", color="0.4", label="Avitzur's upper bound")
    right.plot([], [], ":", color="0.4", label="slab method")
    left.set(xlabel="ram stroke [mm]", ylabel="ram pressure / flow stress", ylim=(0, None), xlim=(0, None))
    right.set(xlabel="half angle of the cone [degrees]", ylabel="steady pressure / flow stress", ylim=(0.3, 1.1))
    for axis in (left, right):
        axis.legend(frameon=False, fontsize=7)
        axis.grid(True, color="0.92", lw=0.8)
        axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=130)


def write_packaged_billets(folder: Path) -> None:
    """Write the billets of the packaged examples of PACKAGED."""
    for name, die in PACKAGED.items():
        print(f"{name}: the billet's upper end is at y = {write_billet(folder / f'{name}.inp', die, 12, 25.0):.4f} mm")


PACKAGED = {
    "extrusion_cone": cone(15.0, fillet=3.0, land=2.0),
    "extrusion_curved": curve(8.0, land=2.0),
    "warm_extrusion": Die(10.0, 7.5, 15.0, 0.0, 3.0, 2.0),
}


def main() -> None:
    """Print the table; draw, or write the packaged billets, if asked to."""
    parser = argparse.ArgumentParser(description="Forward extrusion against slab method and upper bound")
    parser.add_argument("--picture", help="PNG file to draw")
    parser.add_argument(
        "--billets", type=Path, help="folder for the meshes of the packaged examples; runs nothing else"
    )
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    if arguments.billets:
        write_packaged_billets(arguments.billets)
        return
    cases = CASES + CURVED
    with ProcessPoolExecutor(arguments.jobs) as pool:
        found = list(pool.map(run_case, *zip(*cases, strict=True)))
    runs = dict(zip(cases, found, strict=True))
    print_table(runs)
    if arguments.picture:
        draw(arguments.picture, runs)


if __name__ == "__main__":
    main()
