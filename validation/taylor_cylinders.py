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


def fit(metal: str, shots: Sequence[Shot]) -> list[float]:
    """Return Johnson and Cook's numbers of a metal from shots."""
    from scipy.optimize import least_squares

    usual = np.array(METALS[metal].usual)

    def residuals(x: FloatArray) -> FloatArray:  # x near 1, so that relative differences are of all alike
        numbers = usual * np.exp(x - 1.0)
        off = [value for shot in shots for value in compare(shot, strike(shot, numbers))]
        print(metal, np.round(numbers, 4), f"{np.sqrt(np.nanmean(np.square(off))):.3f}", flush=True)
        return np.concatenate([np.nan_to_num(off, nan=3.0), (x - 1.0) / SPREAD])

    found = least_squares(residuals, np.ones(len(usual)), loss="soft_l1", f_scale=2.0, diff_step=0.03, max_nfev=6)
    return [float(f"{value:.4g}") for value in usual * np.exp(found.x - 1.0)]


def write_results(shots: Sequence[Shot], fitted: Sequence[bool], sets: dict[str, list[float]]) -> None:
    """Compute every shot with the fitted and with the usual numbers, and write them down."""
    head = "source,metal,T_K,speed_m_s,L0_mm,D0_mm,fitted,Lf_measured,Lf_computed,Lf_usual,"
    head += "Df_measured,Df_computed,Df_usual"
    rows = [f"# python -m validation.taylor_cylinders --fit: numbers of {SETS.name}, and the usual ones", head]
    for shot, is_fitted in zip(shots, fitted, strict=True):
        own, usual = strike(shot, sets[shot.metal]), strike(shot, METALS[shot.metal].usual)
        foot = "" if shot.foot is None else f"{shot.foot:g}"
        rows.append(
            f"{shot.source},{shot.metal},{shot.kelvin:g},{shot.speed:g},{shot.length:g},{shot.diameter:g},"
            f"{int(is_fitted)},{shot.final_length:g},{own.length:.3f},{usual.length:.3f},{foot},{own.foot:.3f},"
            f"{usual.foot:.3f}"
        )
    RESULTS.write_text("\n".join(rows) + "\n", encoding="utf-8")


def main() -> None:
    """Fit, measure the mesh's error, or draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", action="store_true")
    shots = read_shots()
    if parser.parse_args().fit:
        fitted = split(shots)
        sets = {}
        for metal in METALS:
            own = [shot for shot, is_own in zip(shots, fitted, strict=True) if is_own and shot.metal == metal]
            sets[metal] = fit(metal, own)
        named = {name: dict(zip(NAMES, one, strict=True)) for name, one in sets.items()}
        SETS.write_text(json.dumps(named, indent=1) + "\n", encoding="utf-8")
        write_results(shots, fitted, sets)


if __name__ == "__main__":
    main()
