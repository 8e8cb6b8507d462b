# SPDX-License-Identifier: Apache-2.0
"""Stretching over a hemispherical punch: explicit against implicit shells, and both against axisymmetric solids.

    python -m validation.hemispherical_punch [docs/img/hemispherical_punch.png]

prints the differences, some five minutes, and draws the thickness strain against the radius.
"""

from __future__ import annotations

import sys

import numpy as np

from presswork.case import StampingCase, build_model
from presswork.process.explicit.stamping import ExplicitStamping
from tests.problems.punch_stretching import EXAMPLE, Profile, stretch, stretch_solids

FINE = ("implicit.contact_stiffness=0.1", "implicit.max_increment=0.005")
SOFT = ("implicit.contact_stiffness=0.01",)
ZONES = ((0.0, 5.0), (5.0, 20.0), (20.0, 35.0), (35.0, 50.0), (50.0, 60.0))
"""Of the undeformed radius [mm]: pole, sphere, where it leaves the punch, free, shoulder and clamp."""
SIZE = 2.5
SPEEDS = (10, 3, 1)
"""Of the punch [m/s]."""
FORCES = np.array([10, 20, 30, 40, 50, 60, 70], float)
PUBLISHED = np.array([10.6, 15.4, 20.0, 24.7, 28.2, 33.0, 37.4])
"""Travel of the punch [mm] at FORCES [kN] without friction: references "SOURCE_EXTERNE" of code_aster's ssnv501a.comm.

Its load is a pressure of t x 12.33 MPa on the punch's back of radius 50.8 mm, so t x 99.96 kN.
"""
CODE_ASTER = np.array([9.977, 15.091, 19.344, 23.595, 27.622, 32.000, 37.054])
"""Its own, by axisymmetric solids on a coarse mesh [mm]."""


def explicit(mu: float, speed: float = 3, thickness: float = 1.0) -> Profile:
    """Stretch by explicit dynamics."""
    return stretch("explicit", mu, SIZE, f'stages.0.velocity="{speed} m/s"', thickness=thickness)


def implicit(mu: float, *, fine: bool = True, thickness: float = 1.0) -> Profile:
    """Stretch by the implicit procedure, with shorter increments, or with softer contact than its default."""
    return stretch("implicit", mu, SIZE, *(FINE if fine else SOFT), thickness=thickness)


def travel_at_forces(size: float = SIZE) -> np.ndarray:
    """Return the travel of the punch [mm] at FORCES by explicit dynamics, without friction."""
    keys = ["tools.punch.mu=0", "tools.die.mu=0", f"blank.element_size={size}", "stages.0.tools.punch.stroke=42",
            "output.rows=200", "output.steps=1"]  # fmt: skip
    model = build_model(StampingCase.from_toml(EXAMPLE, keys))  # type: ignore[arg-type]
    run = ExplicitStamping(model, threads=1)
    rows = [run.row(report) for report in run.advance()]  # type: ignore[arg-type]
    force = np.array([row["punch.force"] for row in rows[:-1]], float)
    return np.interp(1e3 * FORCES, force, np.array([row["punch.stroke"] for row in rows[:-1]], float))


def differences(one: Profile, other: Profile, name: str) -> list[float]:
    """Return the largest difference of a strain in each zone [% of its largest]; the meshes are the same."""
    a, b = getattr(one, name), getattr(other, name)
    off = 100 * np.abs(a - b) / np.abs(b).max()
    return [float(off[(one.radius >= low) & (one.radius < high)].max()) for low, high in ZONES]


def beside_solids(shells: Profile, solids: Profile) -> list[float]:
    """Return the mean difference of the thickness strain in each zone [% of the solids' mean there]."""
    found = []
    for low, high in ZONES:
        inside = (shells.radius >= low) & (shells.radius < high)
        reference = np.interp(shells.radius[inside], solids.radius, solids.thickness_strain)
        found.append(float(100 * (shells.thickness_strain[inside].mean() / reference.mean() - 1)))
    return found


def draw(path: str) -> None:
    """Draw the thickness strain of all three against the radius."""
    from presswork.view.style import clean_axes, new_figure

    figure = new_figure(9.0, 3.8)
    for axes, mu in zip(figure.subplots(1, 2, sharey=True), (0.0, 0.15), strict=True):
        solids = stretch_solids(mu)
        axes.plot(solids.radius, solids.thickness_strain, "k-", linewidth=1.2, label="axisymmetric solids")
        for name, marker, profile in (("implicit shells", "o", implicit(mu)), ("explicit shells", "x", explicit(mu))):
            axes.plot(profile.radius, profile.thickness_strain, marker, markersize=3, label=name)
        axes.set_title(f"friction {mu:g}")
        axes.set_xlabel("undeformed radius [mm]")
        clean_axes(axes)
    figure.axes[0].set_ylabel("thickness strain")
    figure.axes[0].legend(frameon=False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    for friction in (0.0, 0.15):
        reference = implicit(friction)
        print(f"friction {friction}, zones {ZONES} mm; difference in % of the largest strain: thickness | radial")
        runs = [(f"explicit, {v} m/s", explicit(friction, v)) for v in SPEEDS]
        for label, profile in [*runs, ("implicit, contact_stiffness = 0.01", implicit(friction, fine=False))]:
            parts = [differences(profile, reference, f"{s}_strain") for s in ("thickness", "radial")]
            text = " | ".join(" ".join(f"{v:5.2f}" for v in part) for part in parts)
            force = f"force {100 * (profile.force / reference.force - 1):+.2f} %"
            print(f"  {label:20s} {text}  {force}, kinetic {profile.kinetic:.1e}, {profile.seconds:.1f} s")
        print(f"  implicit: {reference.force:.0f} N, {reference.seconds:.1f} s; solids: "
              f"{stretch_solids(friction).force:.0f} N; shells beside solids, thickness strain in %:")  # fmt: skip
        print("  ", *(f"{v:+.2f}" for v in beside_solids(reference, stretch_solids(friction))))
    thin = beside_solids(implicit(0.0, thickness=0.25), stretch_solids(0.0, 0.25, 480))
    print("   a quarter as thick, frictionless:", *(f"{v:+.2f}" for v in thin))
    print("travel without friction at", *(f"{f:.0f}" for f in FORCES), "kN [mm]:")
    for label, travel in (("explicit", travel_at_forces()), ("published", PUBLISHED), ("code_aster", CODE_ASTER)):
        print(f"  {label:10s}", *(f"{v:6.2f}" for v in travel))
    if len(sys.argv) > 1:
        draw(sys.argv[1])
