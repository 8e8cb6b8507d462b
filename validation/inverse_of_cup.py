# SPDX-License-Identifier: Apache-2.0
"""The one-step solver turned on the square cup of Cheng (1995) as the explicit procedure draws it: is its blank found?

    python -m validation.inverse_of_cup OUT [element_size] [key=value ...]

draws the packaged example to 15, 20 and 25 mm, hands its mid-surface to the one-step solver, and prints how far the
blank that it finds lies from the true square of 100 mm, and its thickness strain beside that of the incremental cup,
by one step and by three stages; then the blank of 25 mm by way of shapes that the increments went through, which
shows the path's share of the error; then one step with a holder ten times softer and stiffer, and with twice its force;
then one step and stages for cups with other friction, radii and holder forces, and for round cups. Four minutes.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from presswork import Result
from presswork.case.onestep.schema import LAYERS
from presswork.mesh.triangles import find_rims
from presswork.model import Hardening, Material, OneStepModel
from presswork.onestep import OneStepResult, loads, solve_one_step
from presswork.onestep.fields import form_layers
from presswork.onestep.process import Process
from validation import square_cup

DEPTHS = (15.0, 20.0, 25.0)
HOLDER_FORCE, MU = 15e3, 0.144
"""Of the example [N]."""
STAGES = 3
LEVEL, STEEP = 0.996, 0.3
"""Upward part of a cell's normal from which on it lies level, below which it belongs to the wall."""


@dataclass(frozen=True)
class Inverse:
    """A cup and the blank found from it."""

    cup: Result
    step: int
    found: OneStepResult

    @property
    def off_outline(self) -> np.ndarray:
        """Distance of the blank's edge from the true square, outwards [mm], at the nodes of the edge."""
        start = self.cup.mesh.points[:, :2]
        half = start.max()
        on_edge = np.isclose(start.max(axis=1), half)
        return self.found.blank[on_edge].max(axis=1) - half

    @property
    def off_points(self) -> np.ndarray:
        """Distance of every node from its true place in the blank [mm]."""
        return np.linalg.norm(self.found.blank - self.cup.mesh.points[:, :2], axis=1)

    @property
    def strains(self) -> tuple[np.ndarray, np.ndarray]:
        """Thickness strain of the cells: incremental, one-step."""
        return self.cup.field("thickness_strain", self.step), self.found.fields["thickness_strain"]

    def zones(self) -> dict[str, np.ndarray]:
        """Return the cells of each zone by where they lie in the cup."""
        corners = self.cup.points(self.step)[self.cup.mesh.blocks[0].connectivity]
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        up = normal[:, 2] / np.linalg.norm(normal, axis=1)
        z = corners[:, :, 2].mean(axis=1)
        low = z < 0.5 * (z.min() + z.max())
        level, steep = up > LEVEL, up < STEEP
        return {
            "bottom": level & low,
            "punch radius": ~level & ~steep & low,
            "wall": steep,
            "die radius": ~level & ~steep & ~low,
            "flange": level & ~low,
        }


def draw_cup(folder: Path, element_size: float = 2.0, *overrides: str) -> Result:
    """Draw the example's cup to the last depth; a step is saved every millimetre."""
    to_depth = [f"stages.0.tools.punch.stroke={DEPTHS[-1]}", "output.steps=25"]
    return square_cup.draw_cup(folder, element_size, *to_depth, *overrides)


def find_step(cup: Result, depth: float) -> int:
    stroke = [np.linalg.norm(cup.surface_displacement("punch", step)) for step in range(len(cup.times))]
    return int(np.argmin(np.abs(np.array(stroke) - depth)))


def find_blank(cup: Result, depth: float, **process: Any) -> Inverse:
    """Hand the cup's mid-surface at a depth to the one-step solver.

    As arrays, not as a file: the drawn wall curls outwards, by 10 degrees over the vertical at 25 mm, which the reader
    of files takes for an undercut.
    """
    model = make_model(cup, depth, **process)
    return Inverse(cup, find_step(cup, depth), solve_one_step(model))


def follow_increments(cup: Result, depths: tuple[float, ...]) -> np.ndarray:
    """Return the blank (n_nodes, 2) by way of the shapes that the increments went through, each node in its place."""
    process = Process(make_model(cup, depths[-1]))
    blank, formed = cup.mesh.points[:, :2].copy(), None
    for depth in depths:
        found = process.find_blank(process.shape(cup.points(find_step(cup, depth))), blank, formed)
        blank, formed = found.solution.blank, form_layers(found.problem, found.solution.blank)
    return blank


def make_model(cup: Result, depth: float, **process: Any) -> OneStepModel:
    """Return the cup at a depth as the one-step solver takes it."""
    step = find_step(cup, depth)
    quads = cup.mesh.blocks[0].connectivity.astype(np.int32)
    halves = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    points = cup.points(step)
    steel = Material("steel", 210e3, 0.3, Hardening("swift", np.array([565.32, 0.007117, 0.2589])))
    given = {"holder_force": HOLDER_FORCE, "mu": MU, "layers": LAYERS} | process
    return OneStepModel(
        title=f"square cup, {depth:g} mm deep",
        points=points,
        triangles=np.zeros((0, 3), dtype=np.int32),
        quadrilaterals=quads,
        rims=tuple(sorted(find_rims(points, halves), key=len, reverse=True)),
        material=steel,
        thickness=0.8,
        rolling_direction=0.0,
        symmetry=(True, True),
        **given,
    )


def print_inverse(inverse: Inverse, depth: float) -> None:
    """Print outline, thickness strain by zones and punch force."""
    off, (true, found) = inverse.off_outline, inverse.strains
    start = inverse.cup.mesh.points[:, :2]
    on_edge = np.isclose(start.max(axis=1), start.max())
    middle, corner = start[on_edge].min(axis=1).argmin(), start[on_edge].min(axis=1).argmax()
    force = np.interp(depth, inverse.cup.history["punch.stroke"], inverse.cup.history["punch.force"])
    print(
        f"{depth:g} mm: edge {off.min():+.2f} to {off.max():+.2f} mm off the square; middle of the side "
        f"{off[middle]:+.2f}, corner {off[corner]:+.2f}; all nodes {inverse.off_points.max():.2f} mm at most"
    )
    print(f"  punch force {inverse.found.punch_force / 1e3:.1f} kN, incremental {force / 1e3:.1f} kN")
    print("  thickness strain  cells   incremental      one-step     difference: mean    rms    largest")
    for zone, cells in {**inverse.zones(), "whole": np.ones(len(true), dtype=bool)}.items():
        t, f = true[cells], found[cells]
        d = f - t
        worst = d[np.argmax(np.abs(d))]
        print(
            f"  {zone:17s} {cells.sum():5d}  {t.min():+.3f} {t.max():+.3f}  {f.min():+.3f} {f.max():+.3f}"
            f"            {d.mean():+.3f}  {np.sqrt(np.mean(d**2)):.3f}  {worst:+.3f}"
        )


def print_path(cup: Result) -> None:
    """Print the blank of 25 mm by way of more and more of the increments' own shapes: the share of the path."""
    start = cup.mesh.points[:, :2]
    on_edge = np.isclose(start.max(axis=1), start.max())
    middle, corner = start[on_edge].min(axis=1).argmin(), start[on_edge].min(axis=1).argmax()
    for depths in (
        (25.0,),
        (15.0, 25.0),
        (10.0, 20.0, 25.0),
        tuple(np.arange(5.0, 26.0, 5.0)),
        tuple(np.arange(1.0, 26.0)),
    ):
        off = follow_increments(cup, depths)[on_edge].max(axis=1) - start.max()
        print(
            f"by way of {len(depths)} shapes of the increments: middle {off[middle]:+.2f}, corner {off[corner]:+.2f}, "
            f"edge {np.abs(off).max():.2f} mm at most"
        )


def print_influences(cup: Result) -> None:
    """Print what the holder's stiffness and its force make of the blank and of the bottom."""
    start = cup.mesh.points[:, :2]
    on_edge = np.isclose(start.max(axis=1), start.max())
    middle, corner = start[on_edge].min(axis=1).argmin(), start[on_edge].min(axis=1).argmax()
    own = loads._COMPLIANCE
    for stiffness, holder in ((0.1, 1.0), (1.0, 1.0), (10.0, 1.0), (1.0, 2.0)):
        loads._COMPLIANCE = own * stiffness
        for depth in DEPTHS:
            inverse = find_blank(cup, depth, holder_force=holder * HOLDER_FORCE)
            off, (true, found), bottom = inverse.off_outline, inverse.strains, inverse.zones()["bottom"]
            print(
                f"holder {stiffness:g} times as stiff, {holder:g} times its force, {depth:g} mm: "
                f"middle {off[middle]:+.2f}, corner {off[corner]:+.2f} mm; "
                f"punch {inverse.found.punch_force / 1e3:.1f} kN; "
                f"bottom {found[bottom].mean():.3f}, of the increments {true[bottom].mean():.3f}"
            )
    loads._COMPLIANCE = own


def _with_friction(mu: float) -> list[str]:
    return [f"tools.{tool}.mu={mu}" for tool in ("punch", "die", "holder")]


def _round_cup(radius: float) -> list[str]:
    """Return the keys of a round cup of 50 mm from a disc of 100 mm, friction 0.1; radius: of punch and die."""
    disc = 'blank={shape="circle",diameter=100,thickness=0.8,element_size=2,material="steel",symmetry=["x","y"]}'
    tools = (("punch", 50.0, radius), ("die", 53.0, radius), ("holder", 53.0, 1.0))
    return [disc] + [
        f'tools.{kind}={{kind="{kind}",shape="round",diameter={size},edge_radius={edge},mu=0.1}}'
        for kind, size, edge in tools
    ]


OTHERS: dict[str, tuple[list[str], dict[str, float]]] = {
    "no friction": (_with_friction(0.0), {"mu": 0.0}),
    "friction 0.05": (_with_friction(0.05), {"mu": 0.05}),
    "friction 0.2": (_with_friction(0.2), {"mu": 0.2}),
    "radii of 8 mm": (["tools.punch.edge_radius=8", "tools.die.edge_radius=8"], {}),
    "holder 5 kN": (["stages.0.tools.holder.force=5000"], {"holder_force": 5e3}),
    "holder 30 kN": (["stages.0.tools.holder.force=30000"], {"holder_force": 30e3}),
    "round, radii of 4 mm": (_round_cup(4.0), {"mu": 0.1}),
    "round, radii of 6 mm": (_round_cup(6.0), {"mu": 0.1}),
}
"""Other cups: keys of their cases, and what of the process the one-step solver is told."""


def off_rim(inverse: Inverse) -> np.ndarray:
    """Return how far the blank's edge lies outside the true one, round or square, at its nodes [mm]."""
    start = inverse.cup.mesh.points[:, :2]
    radius = np.linalg.norm(start, axis=1)
    if start.max() < 0.8 * radius.max():  # a square, of which the corners lie farthest out
        return inverse.off_outline
    on_edge = radius > radius.max() - 0.05
    return np.asarray(np.linalg.norm(inverse.found.blank[on_edge], axis=1) - radius[on_edge])


def print_others(folder: Path, element_size: float) -> None:
    """Print outline and thickness strain of the other cups, by one step and by stages."""
    for name, (keys, process) in OTHERS.items():
        cup = draw_cup(folder / name.replace(" ", "_").replace(",", ""), element_size, *keys)
        for depth in DEPTHS:
            for number in (1, STAGES):
                inverse = find_blank(cup, depth, stages=number, **process)
                off, (true, found) = off_rim(inverse), inverse.strains
                print(
                    f"{name}, {depth:g} mm, stages {number}: edge {off.min():+.2f} to {off.max():+.2f}; "
                    f"thickness strain {np.sqrt(np.mean((found - true) ** 2)):.3f} off (rms) {inverse.found.notes}",
                    flush=True,
                )


if __name__ == "__main__":
    size = float(sys.argv[2]) if len(sys.argv) > 2 else 2.0
    drawn = draw_cup(Path(sys.argv[1]), size, *sys.argv[3:])
    for number in (1, STAGES):
        print(f"stages: {number}")
        for deep in DEPTHS:
            print_inverse(find_blank(drawn, deep, stages=number), deep)
    print_path(drawn)
    print_influences(drawn)
    print_others(Path(sys.argv[1]), size)
