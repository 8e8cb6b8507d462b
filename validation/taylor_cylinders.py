# SPDX-License-Identifier: Apache-2.0
"""145 measured Taylor cylinders: one Johnson-Cook set a metal, of half of the shots, held against the other half.

Shots of 4340 steel, copper and 6061-T6 from HighRateExptData (`validation/measured/taylor_impact.csv`), 50 to 603 m/s,
294 to 1285 K. Half of each source's shots, next to each other in temperature and speed, are drawn by a seed. A, B, n, C
and m are fitted to their final lengths and foot diameters by robust least squares. Numbers that they do not determine
stay near the usual ones of the metal. The others are computed with that set alone.

    python -m validation.taylor_cylinders --fit                # five minutes: writes the sets and the results
    python -m validation.taylor_cylinders --picture docs/img/taylor_cylinders.png       # of the results
    python -m validation.taylor_cylinders --mesh               # the mesh's error on two shots
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import FloatArray, Hardening, Heating, Rate

FOLDER = Path(__file__).parent / "measured"
DATA = FOLDER / "taylor_impact.csv"
SETS = FOLDER / "taylor_sets.json"
RESULTS = FOLDER / "taylor_results.csv"
SEED = 50
CELLS = 4
"""Of quads over the radius, as long along the axis as wide."""
FLAT = 0.75
"""Lf/L0 below which quads turn inside out: crossed triangles, 3 over the radius, twice as long along the axis.

They are used where no foot is measured, since so few make the foot 3 to 4 % narrower.
"""
KELVIN, ROOM = 273.15, 20.0
FLOOR = ((-1.0, 0.0, 1e3, 0.0, 0.0, 0.0, 0.0),)
"""A wall along y = 0 below the cylinder, which cannot pull."""
NAMES = ("A", "B", "n", "C", "m")
COLUMNS = ("computed", "usual", "by_source")
"""What is computed of a shot: with the metal's fitted set, with the usual one, with that of TEMPERS."""
SPREAD = 0.5
"""Standard deviation of the logarithm of a parameter about the usual one."""
OF_LENGTH, OF_FOOT = 0.01, 0.03
"""Standard deviations of Lf/L0 and of Df/D0, by which the fit weighs them."""


@dataclass(frozen=True)
class Metal:
    """What is not fitted, and where the fit begins."""

    young: float
    poisson: float
    melting: float
    """[degrees C]"""
    capacity: float
    """[mm2/(s2 K)]"""
    usual: tuple[float, ...]
    """NAMES by Johnson & Cook (1983; 6061-T6: Lesuer et al. 2001, as commonly quoted)."""


METALS = {
    "4340 steel": Metal(206e3, 0.3, 1520.0, 4.77e8, (792.0, 510.0, 0.26, 0.014, 1.03)),
    "copper": Metal(124e3, 0.34, 1083.0, 3.83e8, (90.0, 292.0, 0.31, 0.025, 1.09)),
    "6061-T6": Metal(70e3, 0.33, 582.0, 8.75e8, (324.0, 114.0, 0.42, 0.002, 1.34)),
}


TEMPERS = {
    "CuHouse": "copper, House",
    "CuGust": "copper, Gust",
    "CuETPGust": "copper, Gust",
    "CuWilkins": "copper, Gust",
}
"""Sets of copper by source: its tempers differ, and are not in the file. Jones' eight shots contradict one another."""


@dataclass(frozen=True)
class Shot:
    """A measured shot."""

    source: str
    metal: str
    kelvin: float
    speed: float
    """[m/s]"""
    length: float
    diameter: float
    """Before, [mm]."""
    final_length: float
    foot: float | None
    """Diameter of the foot afterwards [mm]."""
    density: float
    """[t/mm3]"""


def read_shots() -> list[Shot]:
    """Return the measured shots in the order of the file."""
    rows = [line for line in DATA.read_text("utf-8").splitlines() if not line.startswith("#")]
    return [
        Shot(
            row["file"], "copper" if "copper" in row["material"] else row["material"], float(row["T_K"]),
            float(row["speed_m_s"]), float(row["L0_mm"]), float(row["D0_mm"]), float(row["Lf_mm"]),
            float(row["Df_mm"]) if row["Df_mm"] else None, 1e-12 * float(row["rho_kg_m3"]),
        )
        for row in csv.DictReader(rows)
    ]  # fmt: skip


def split(shots: Sequence[Shot], seed: int = SEED) -> list[bool]:
    """Return which shots are fitted: of two neighbours in source, temperature and speed one, by chance."""
    rng = np.random.default_rng(seed)
    order = sorted(
        range(len(shots)), key=lambda i: (shots[i].source, round(shots[i].kelvin, -2), shots[i].speed, shots[i].length)
    )
    fitted = [False] * len(shots)
    for first in range(0, len(order), 2):
        pair = order[first : first + 2]
        fitted[pair[int(rng.integers(len(pair)))]] = True
    return fitted


@dataclass(frozen=True)
class Found:
    """What is computed of a shot [mm]; nan where the run fails."""

    length: float
    foot: float


def strike(shot: Shot, numbers: Sequence[float], mesh: tuple[str, int, int] | None = None) -> Found:
    """Compute a shot with Johnson and Cook's numbers, until the cylinder flies back.

    mesh: element, cells over the radius, their length over their width; without it as FLAT explains.
    """
    is_flat = shot.foot is None and shot.final_length < FLAT * shot.length
    element, cells, stretch = mesh or (("tri3", 3, 2) if is_flat else ("quad4_1pt", CELLS, 1))
    metal, (a, b, n, c, m) = METALS[shot.metal], numbers
    start = max(shot.kelvin - KELVIN, ROOM)
    material = SolidMaterial(
        young=metal.young, poisson=metal.poisson, density=shot.density,
        hardening=Hardening("ludwik", np.array([a, b, n])), rate=Rate("johnson_cook", {"C": c, "reference_rate": 1.0}),
        heating=Heating(melting=metal.melting, exponent=m, heat_capacity=metal.capacity, reference=ROOM, start=start),
    )  # fmt: skip
    radius = 0.5 * shot.diameter
    along = round(cells * shot.length / radius / stretch)
    lines = np.linspace(0.0, radius, cells + 1), np.linspace(0.0, shot.length, along + 1)
    run = ExplicitSolids(mesh_rectangle(*lines, element=element), [material], axisymmetric=True)
    run.fix("left", "u")
    run.set_velocity("all", (0.0, -1e3 * shot.speed))
    run.add_wall("anvil", FLOOR)
    step = 0.1 * shot.length / (1e3 * shot.speed)
    try:
        for count in range(1, 40):
            run.run_to(count * step)
            if float(run.mass @ run.velocity[:, 1]) > 0.0:
                break
        run.run_to((count + 1) * step)
    except ExplicitError as error:  # a cell that is turned inside out ends a run
        print(f"{shot.source} {shot.speed:g} m/s, {shot.kelvin:g} K: {error}")
        return Found(float("nan"), float("nan"))
    return Found(float(np.ptp(run.position[:, 1])), 2.0 * float(run.position[:, 0].max()))


def compare(shot: Shot, found: Found) -> list[float]:
    """Return what is off in Lf/L0 and, where it was measured, in Df/D0, over what the fit takes as scatter."""
    off = [(found.length - shot.final_length) / shot.length / OF_LENGTH]
    if shot.foot is not None:
        off.append((found.foot - shot.foot) / shot.diameter / OF_FOOT)
    return off


def fit(name: str, shots: Sequence[Shot]) -> list[float]:
    """Return Johnson and Cook's numbers of a metal from shots."""
    from scipy.optimize import least_squares

    usual = np.array(METALS[shots[0].metal].usual)

    def residuals(x: FloatArray) -> FloatArray:  # x near 1, so that relative differences are of all alike
        numbers = usual * np.exp(x - 1.0)
        off = [value for shot in shots for value in compare(shot, strike(shot, numbers))]
        print(name, np.round(numbers, 4), f"{np.sqrt(np.nanmean(np.square(off))):.3f}", flush=True)
        return np.concatenate([np.nan_to_num(off, nan=3.0), (x - 1.0) / SPREAD])

    found = least_squares(residuals, np.ones(len(usual)), loss="soft_l1", f_scale=2.0, diff_step=0.03, max_nfev=10)
    return [float(f"{value:.4g}") for value in usual * np.exp(found.x - 1.0)]


def write_results(shots: Sequence[Shot], fitted: Sequence[bool], sets: dict[str, list[float]]) -> None:
    """Compute every shot with the fitted and with the usual numbers, and write them down."""
    kinds = ("measured", *COLUMNS)
    head = ["source", "metal", "T_K", "speed_m_s", "L0_mm", "D0_mm", "fitted"]
    head += [f"{size}_{kind}" for size in ("Lf", "Df") for kind in kinds]
    rows = [f"# python -m validation.taylor_cylinders --fit: numbers of {SETS.name}", ",".join(head)]
    for shot, is_fitted in zip(shots, fitted, strict=True):
        own = strike(shot, sets[shot.metal])
        temper = strike(shot, sets[TEMPERS[shot.source]]) if shot.source in TEMPERS else own
        found = (own, strike(shot, METALS[shot.metal].usual), temper)
        facts = [shot.source, shot.metal, *(f"{x:g}" for x in (shot.kelvin, shot.speed, shot.length, shot.diameter))]
        lengths = [f"{shot.final_length:g}", *(f"{one.length:.3f}" for one in found)]
        feet = ["" if shot.foot is None else f"{shot.foot:g}", *(f"{one.foot:.3f}" for one in found)]
        rows.append(",".join([*facts, str(int(is_fitted)), *lengths, *feet]))
    RESULTS.write_text("\n".join(rows) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class Result:
    """A shot with what was computed of it, of the results as written."""

    source: str
    metal: str
    kelvin: float
    speed: float
    fitted: bool
    length: tuple[float, ...]
    """Lf/L0 measured, and by COLUMNS."""
    foot: tuple[float, ...] | None
    """Df/D0, the same."""


def read_results() -> list[Result]:
    """Return what was written by --fit."""
    rows = [line for line in RESULTS.read_text("utf-8").splitlines() if not line.startswith("#")]
    results = []
    for row in csv.DictReader(rows):
        kinds = ("measured", *COLUMNS)
        length = tuple(float(row[f"Lf_{kind}"]) / float(row["L0_mm"]) for kind in kinds)
        foot = tuple(float(row[f"Df_{kind}"]) / float(row["D0_mm"]) for kind in kinds) if row["Df_measured"] else None
        facts = (row["source"], row["metal"], float(row["T_K"]), float(row["speed_m_s"]), row["fitted"] == "1")
        results.append(Result(*facts, length, foot))
    return results


def measure(results: Sequence[Result], column: int = 1) -> dict[str, float]:
    """Return root mean squares and means of what is off, in per cent.

    length: of Lf/L0; shortening: of 1 - Lf/L0, over the measured one; foot: of Df over the measured one. column: of
    COLUMNS, from 1.
    """
    known = [one for one in results if np.isfinite(one.length[column])]
    if not known:
        return {"count": 0.0, "failed": float(len(results))}
    length = np.array([(one.length[0], one.length[column]) for one in known])
    off = length[:, 1] - length[:, 0]
    foot = np.array([one.foot[column] / one.foot[0] - 1.0 for one in known if one.foot])
    found = {
        "count": float(len(known)),
        "failed": float(len(results) - len(known)),
        "length": float(np.sqrt((off**2).mean())),
        "bias": float(off.mean()),
        "shortening": float(np.sqrt((off**2).sum() / ((1.0 - length[:, 0]) ** 2).sum())),
        "worst": float(np.abs(off).max()),
    }
    if len(foot):
        found |= {"feet": float(len(foot)), "foot": float(np.sqrt((foot**2).mean())), "foot bias": float(foot.mean())}
    return {name: value if name in ("count", "failed", "feet") else 100.0 * value for name, value in found.items()}


def print_tables(results: Sequence[Result]) -> None:
    """Print errors of predicted shots by metal, source, speed and temperature."""

    def show(name: str, chosen: Sequence[Result], column: int = 1) -> None:
        if chosen:
            print(f"{name:40s}", ", ".join(f"{key} {value:.4g}" for key, value in measure(chosen, column).items()))

    predicted = [one for one in results if not one.fitted]
    for metal in METALS:
        own = [one for one in predicted if one.metal == metal]
        show(f"{metal}, fitted shots", [one for one in results if one.metal == metal and one.fitted])
        show(f"{metal}, predicted shots", own)
        show(f"{metal}, predicted, usual numbers", own, 2)
        show(f"{metal}, predicted, by source's set", [one for one in own if one.source in TEMPERS], 3)
        show(f"{metal}, the same, one set", [one for one in own if one.source in TEMPERS])
        for source in sorted({one.source for one in own}):
            show(f"  {source}", [one for one in own if one.source == source])
        for low, high in ((0, 150), (150, 200), (200, 300), (300, 700)):
            show(f"  {low} to {high} m/s", [one for one in own if low <= one.speed < high])
        for low, high in ((0, 400), (400, 1000), (1000, 1400)):
            show(f"  {low} to {high} K", [one for one in own if low <= one.kelvin < high])


def draw(path: Path) -> None:
    """Draw computed over measured lengths and feet; hollow: fitted, full: predicted."""
    from presswork.view.style import clean_axes, new_figure, save_picture

    figure = new_figure(10.0, 4.8)
    left, right = figure.subplots(1, 2)
    results = read_results()
    for k, metal in enumerate(METALS):
        own = [one for one in results if one.metal == metal]
        for ax, pairs in (
            (left, [(one.length, one) for one in own]),
            (right, [(one.foot, one) for one in own if one.foot]),
        ):
            for fitted in (True, False):
                points = np.array([pair[:2] for pair, one in pairs if one.fitted == fitted])
                if len(points):
                    face = {"markerfacecolor": "none"} if fitted else {}
                    label = metal if not fitted else None
                    ax.plot(points[:, 0], points[:, 1], "o", markersize=5, color=f"C{k}", label=label, **face)
    for ax, title in ((left, "final length over length"), (right, "diameter of the foot over diameter")):
        low, high = ax.get_xlim()
        ax.plot([low, high], [low, high], color="0.4", linewidth=0.8)
        ax.set_xlabel(f"{title}, measured")
        ax.set_ylabel("computed")
        clean_axes(ax)
    left.legend(frameon=False)
    figure.suptitle("Taylor cylinders: full points predicted, hollow ones fitted", fontsize="medium")
    save_picture(figure, path)


def print_mesh() -> None:
    """Print two shots on finer and finer meshes, quads and crossed triangles."""
    shots = read_shots()
    sets = json.loads(SETS.read_text("utf-8"))
    for source, speed in (("AlHouse", 263.0), ("CuETPGust", 225.0)):
        shot = next(one for one in shots if one.source == source and one.speed == speed)
        numbers = list(sets[shot.metal].values())
        for mesh in (("quad4_1pt", 4, 1), ("quad4_1pt", 8, 1), ("quad4_1pt", 16, 1), ("tri3", 3, 2), ("tri3", 8, 1)):
            found = strike(shot, numbers, mesh)
            print(
                f"{source}, {speed:g} m/s, {mesh[0]}, {mesh[1]} over the radius, {mesh[2]} as long: "
                f"Lf/L0 {found.length / shot.length:.4f}, Df/D0 {found.foot / shot.diameter:.4f}"
            )


def main() -> None:
    """Fit, print the results, measure the mesh's error, or draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--mesh", action="store_true")
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    shots = read_shots()
    if arguments.mesh:
        print_mesh()
    if arguments.fit:
        fitted = split(shots)
        sets = {}
        for metal in METALS:
            own = [shot for shot, is_own in zip(shots, fitted, strict=True) if is_own and shot.metal == metal]
            sets[metal] = fit(metal, own)
        for temper in sorted(set(TEMPERS.values())):
            own = [
                shot
                for shot, is_own in zip(shots, fitted, strict=True)
                if is_own and TEMPERS.get(shot.source) == temper
            ]
            sets[temper] = fit(temper, own)
        named = {name: dict(zip(NAMES, one, strict=True)) for name, one in sets.items()}
        SETS.write_text(json.dumps(named, indent=1) + "\n", encoding="utf-8")
        write_results(shots, fitted, sets)
    if not arguments.mesh:
        print_tables(read_results())
    if arguments.picture:
        draw(arguments.picture)


if __name__ == "__main__":
    main()
