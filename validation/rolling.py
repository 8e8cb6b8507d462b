# SPDX-License-Identifier: Apache-2.0
"""Cold rolling of a strip: roll force, torque and neutral point against the slab theories of rolling_theory.py.

The packaged example with another friction or reduction; steady means are taken over the last 40 % of the second stage.
Run: python -m validation.rolling [--picture docs/img/rolling.png]
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import presswork
from presswork.post import trace_interface
from validation.rolling_theory import RollGap, Rolling, roll_by_slab

EXAMPLE = Path(presswork.__file__).parent / "examples" / "strip_rolling.toml"
RADIUS, ENTRY = 100.0, 4.0
FROM = 0.6
"""Part of the second stage after which the pass is steady."""
PASSES = ((0.1, 0.15), (0.2, 0.12), (0.2, 0.15), (0.2, 0.2))
"""Reduction and Coulomb's coefficient."""


@dataclass(frozen=True)
class Pass:
    """Steady figures of one pass, per width of 1 mm, of one roll."""

    force: float
    """Roll force [N]."""
    torque: float
    """[N mm]"""
    spread: float
    """Largest deviation of the force from its mean, as a fraction."""
    forward_slip: float
    """Speed of the strip behind the gap over the roll's, minus 1."""
    neutral: float
    """Distance of the neutral point before the exit plane [mm]."""
    x: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray


def flow_stress(strain: float) -> float:
    """Return that of the example [MPa]."""
    return float(600.0 * (0.02 + strain) ** 0.15)


def theory(reduction: float, mu: float, *, orowan: bool) -> Rolling:
    """Return what the slab theory gives for a pass."""
    gap = RollGap(RADIUS, ENTRY, ENTRY * (1 - reduction), mu, flow_stress)
    return roll_by_slab(gap, orowan=orowan)


@cache
def roll(reduction: float, mu: float) -> Pass:
    """Compute a pass; the strip starts where it touches the roll."""
    exit_ = ENTRY * (1 - reduction)
    bottom, centre = 0.5 * exit_, 0.5 * exit_ + RADIUS
    bite = np.sqrt(RADIUS**2 - (centre - 0.5 * ENTRY) ** 2)
    start = -bite - 0.02 - 40.0
    overrides = [
        f"workpiece.mesh.origin=[{start},0]",
        f"tools.pusher.profile=[[{start},-1],[{start},3]]",
        f"tools.roll.profile=[[0,{bottom}],{{to=[0,{centre + RADIUS}],centre=[0,{centre}],turn='left'}},"
        f"{{to=[0,{bottom}],centre=[0,{centre}],turn='left'}}]",
        f"tools.roll.mu={mu}",
    ]
    case = presswork.Case.from_toml(EXAMPLE, overrides)
    with tempfile.TemporaryDirectory() as folder:
        outcome = presswork.run(case, Path(folder) / "run")
        if outcome.status != "completed":
            raise RuntimeError(outcome.reason)
        return _measure(outcome.result)


def _measure(result: presswork.Result) -> Pass:
    history = result.history
    steady = history["time"] > 1 + FROM
    weight = np.diff(history["time"], prepend=0.0)[steady]
    force, torque = history["roll.force_y"][steady], history["roll.torque"][steady]
    mean = float(np.average(force, weights=weight))
    steps = [i for i, time in enumerate(result.times) if time > 1 + FROM]
    traces = [trace_interface(result, "roll", step) for step in steps]
    crossing = [_zero(t.points[:, 0], t.contact_shear) for t in traces]
    return Pass(
        force=mean,
        torque=float(np.average(torque, weights=weight)),
        spread=float(np.abs(force - mean).max() / mean),
        forward_slip=_forward_slip(result, steps[0]),
        neutral=-float(np.mean(crossing)),
        x=traces[-1].points[:, 0],
        pressure=traces[-1].contact_pressure,
        shear=traces[-1].contact_shear,
    )


def _zero(x: np.ndarray, shear: np.ndarray) -> float:
    """Return where the contact shear changes its sign within the gap."""
    inside = slice(2, -2)
    x, shear = x[inside], shear[inside]
    last = int(np.nonzero(shear[:-1] * shear[1:] < 0)[0][0])
    return float(x[last] - shear[last] * (x[last + 1] - x[last]) / (shear[last + 1] - shear[last]))


def _forward_slip(result: presswork.Result, step: int) -> float:
    """Compare the way of the strip behind the gap between two steps with that of the roll's surface."""
    before, after = result.points(step), result.points(-1)
    behind = (before[:, 0] > 3.0) & (before[:, 1] < 1e-9)
    turned = result.tool_pose("roll").angle - result.tool_pose("roll", step).angle
    return float((after[behind, 0] - before[behind, 0]).mean() / (RADIUS * turned) - 1)


def print_table() -> None:
    """Print every pass beside the theories."""
    print("reduction mu | force N/mm: FE, von Karman, Orowan | torque N: FE, von Karman, Orowan | neutral mm | spread")
    for reduction, mu in PASSES:
        found, karman, orowan = (
            roll(reduction, mu),
            theory(reduction, mu, orowan=False),
            theory(reduction, mu, orowan=True),
        )
        print(
            f"{reduction:.0%} {mu:.2f} | {found.force:.0f} {karman.force:.0f} {orowan.force:.0f} | "
            f"{found.torque:.0f} {karman.torque:.0f} {orowan.torque:.0f} | "
            f"{found.neutral:.2f} {RADIUS * np.sin(karman.neutral_angle):.2f} "
            f"{RADIUS * np.sin(orowan.neutral_angle):.2f} | {found.spread:.1%} | forward slip {found.forward_slip:.3%}"
        )


def draw(path: Path) -> None:
    """Draw pressure and friction over the roll gap."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    for colour, (reduction, mu) in zip(("C0", "C1", "C2"), PASSES[1:], strict=True):
        found, slab = roll(reduction, mu), theory(reduction, mu, orowan=True)
        upper.plot(found.x, found.pressure, color=colour, label=f"mu = {mu:g}")
        lower.plot(found.x, found.shear, color=colour)
        along = -RADIUS * np.sin(slab.phi)
        upper.plot(along, slab.pressure, "--", color=colour, linewidth=1)
        lower.plot(along, slab.friction, "--", color=colour, linewidth=1)
    upper.plot([], [], "--", color="0.4", linewidth=1, label="Orowan's slab theory")
    upper.set_ylabel("pressure [MPa]")
    lower.set_ylabel("friction on the strip [MPa]")
    lower.set_xlabel("distance from the exit plane [mm]")
    upper.legend(frameon=False)
    upper.set_title("Rolling 4 to 3.2 mm, roll diameter 200 mm", loc="left", fontsize="medium")
    for ax in (upper, lower):
        ax.grid(True, color="0.9")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    print_table()
    if arguments.picture:
        draw(arguments.picture)
