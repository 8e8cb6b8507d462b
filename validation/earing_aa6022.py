# SPDX-License-Identifier: Apache-2.0
"""Ears of AA6022-T4: a measured rim beside cups of that sheet, drawn with two sets of tools.

The rim is that of Tian, Brownell, Baral & Korkolis, Int. J. Material Forming 10 (2017) 329, and the sheet's yield
stresses and r-values are theirs, both as transcribed in S. C. Soare's PolyN (`validation/measured/`). The tools are not
public. So the cup is drawn with two drawing ratios, each with the blank that makes a cup of the measured mean height at
constant thickness, and what is compared is the rim over its mean.

    python -m validation.earing_aa6022 --picture docs/img/earing_aa6022.png
"""

from __future__ import annotations

import argparse
from functools import cache
from pathlib import Path

import numpy as np

from presswork.case.material.yld2000_fit import YieldData, Yld2000Fit, fit_yld2000
from validation.earing import Cup, Rim, draw_material, fold, height_by_constant_area

DATA = Path(__file__).parent / "measured" / "ears_aa6022_t4_tian2016.csv"
ANGLES = np.arange(0.0, 91.0, 15.0)
STRESS = (1.0, 1.0, 1.001, 0.973, 0.962, 0.954, 0.955)
R = (0.8, 0.74, 0.54, 0.37, 0.41, 0.47, 0.54)
BIAXIAL = 0.929
"""Yield stress over that at 0 degrees and r-value at ANGLES, and balanced biaxial stress, at large strain."""
TIAN = (0.919, 1.072, 1.204, 1.109, 0.992, 0.892, 0.957, 1.098)
"""Their own parameters of Yld2000-2d, exponent 8."""
VOCE = {"law": "voce", "yield_stress": 214.0, "saturation_stress": 436.0, "rate": 6.75}
PUNCHES = {"1.75": 104.0, "1.95": 77.0}
"""Diameter of the punch [mm] by drawing ratio, roughly."""
NEAR = 6.0


@cache
def fit_sheet() -> Yld2000Fit:
    """Return Yld2000-2d fitted to the fifteen numbers."""
    return fit_yld2000(YieldData(ANGLES, np.array(STRESS), np.array(R), BIAXIAL), 8)


def read_rim() -> np.ndarray:
    """Return angle [degree] and height [mm] of the measured rim (n, 2)."""
    return np.loadtxt(DATA, delimiter=",", skiprows=2)


def mean_quarters() -> np.ndarray:
    """Return the measured height [mm] at ANGLES, the mean of the quarters, each straight between its points."""
    angle, height = read_rim().T
    around = np.concatenate([(s * ANGLES + t) % 360.0 for s, t in ((1, 0), (-1, 180), (1, 180), (-1, 360))])
    return np.interp(around, angle, height, period=360.0).reshape(4, -1).mean(axis=0)


def make_cup(punch: float) -> Cup:
    """Return the tools of a punch, and the blank whose cup has the measured mean height at constant thickness."""
    target = float(mean_quarters().mean())
    low, high = 1.2 * punch, 2.6 * punch
    for _ in range(60):
        blank = 0.5 * (low + high)
        tools = Cup(blank, 1.0, punch, 10.0, punch + 2.6, 8.0, 0.06, "12 kN", 90, 3.0, ironing=False)
        low, high = (blank, high) if height_by_constant_area(tools) < target else (low, blank)
    return tools


@cache
def draw(ratio: str, parameters: str = "fitted") -> Rim:
    """Return the rim of a cup by drawing ratio, with the fitted parameters of the sheet, or with Tian's."""
    alpha = fit_sheet().alpha if parameters == "fitted" else TIAN
    surface = {"law": "yld2000", "alpha": [float(a) for a in alpha], "exponent": 8}
    material = {"young": "70 GPa", "poisson": 0.33, "yield_function": surface, "hardening": VOCE}
    tools = make_cup(PUNCHES[ratio])
    return draw_material(material, tools, tools.size)


def main() -> None:
    """Print the rims over their means, and draw them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    stress, r = fit_sheet().worst()
    print("alpha", np.round(fit_sheet().alpha, 4), f"largest errors {100 * stress:.2f} % in a stress, {r:.3f} in an r")
    measured = mean_quarters()
    print(
        "measured:",
        *(f"{h:.2f}" for h in measured),
        "mm; over the mean:",
        *(f"{h:.4f}" for h in measured / measured.mean()),
    )
    rims = {}
    for ratio, parameters in (("1.75", "fitted"), ("1.95", "fitted"), ("1.95", "tian")):
        tools, rim = make_cup(PUNCHES[ratio]), draw(ratio, parameters)
        rims[f"drawing ratio {tools.blank / tools.punch:.2f}, {parameters}"] = rim
        heights = np.array([rim.at(a) for a in ANGLES])
        off = heights / heights.mean() - measured / measured.mean()
        print(
            f"blank {tools.blank:.1f}, punch {tools.punch:g} mm, {parameters}:", *(f"{h:.2f}" for h in heights),
            "mm; over the mean off by", *(f"{100 * d:+.2f}" for d in off), "%; highest less lowest",
            f"{100 * np.ptp(heights) / heights.mean():.2f} %, measured",
            f"{100 * np.ptp(measured) / measured.mean():.2f} %; ears at {', '.join(f'{a:.0f}' for a in rim.ears)}",
        )  # fmt: skip
    if arguments.picture:
        draw_picture(arguments.picture, rims)


def draw_picture(path: Path, rims: dict[str, Rim]) -> None:
    """Draw the rims over their means round a quarter."""
    from presswork.view.style import clean_axes, new_figure, save_picture

    figure = new_figure(7.0, 4.2)
    ax = figure.subplots()
    angle, height = fold(read_rim()).T
    ax.plot(angle, height / mean_quarters().mean(), "x", color="0.5", markersize=5, label="measured, all quarters")
    ax.plot(ANGLES, mean_quarters() / mean_quarters().mean(), "ko-", markersize=4, label="measured, mean of quarters")
    for name, rim in rims.items():
        mean = np.mean([rim.at(a) for a in ANGLES])
        ax.plot(rim.angle, rim.height / mean, label=name)
    ax.set_xticks(range(0, 91, 15))
    ax.set_xlabel("angle from the rolling direction [degree]")
    ax.set_ylabel("height of the rim over its mean")
    ax.legend(frameon=False, fontsize=8)
    clean_axes(ax)
    save_picture(figure, path)


if __name__ == "__main__":
    main()
