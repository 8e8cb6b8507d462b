# SPDX-License-Identifier: Apache-2.0
"""One step back from parts that operations in a row made: draw, trim, flange; draw and redraw; a bent channel.

    python -m validation.one_step_of_operations OUT

forms each part by explicit dynamics, hands its mid-surface to the one-step solver with the same steel, holder force
and friction, and prints how far the blank found lies from the true one, and thickness strain and punch force beside
those of the increments. Three minutes on one core.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from presswork import Result
from presswork.case import StampingCase, build_model
from presswork.case.material.yield_function import Hill1948
from presswork.case.onestep.schema import LAYERS
from presswork.mesh.triangles import find_rims
from presswork.model import Hardening, Material, OneStepModel, YieldFunction
from presswork.onestep import OneStepResult, solve_one_step
from presswork.recorder import run_model
from tests.verification.test_press_line import DRAW, REDRAW
from validation.draw_bending import strip_case
from validation.press_line_twice import run_line, step_of

SWIFT = np.array([565.32, 0.007117, 0.2589])
HILL = Hill1948(law="hill1948", r00=1.79, r45=1.51, r90=2.27).hill_parameters()
CUP_STEEL = Material("steel", 206e3, 0.3, Hardening("swift", SWIFT), YieldFunction("hill1948", HILL))
"""NUMISHEET'93, as in the library."""
HOLDER = 15e3
"""Of the line's draw [N]."""
SMALL_CUP_STEEL = Material("steel", 206e3, 0.3, Hardening("swift", np.array([565.0, 0.0071, 0.26])))
"""Of the small cup of tests/verification/test_press_line.py."""


@dataclass(frozen=True)
class Back:
    """A part at one step of a run and the blank found from it."""

    run: Result
    step: int
    found: OneStepResult

    @property
    def rim(self) -> np.ndarray:
        """Nodes of the outer edge, of which none lies inside on a symmetry plane."""
        mesh = self.run.mesh_at(self.step)
        quads = mesh.blocks[0].connectivity
        loop = max(find_rims(mesh.points, triangles_of(mesh)), key=len)
        start = mesh.points[:, :2]
        free = (start[loop] > 1e-6).all(axis=1)
        outer = np.linalg.norm(start[loop], axis=1) > 0.5 * np.linalg.norm(start[np.unique(quads)], axis=1).max()
        return np.asarray(loop)[free & outer]

    @property
    def off_rim(self) -> np.ndarray:
        """How far the rim found lies outside the true one, along the radius (n,) [mm]."""
        start = self.run.mesh_at(self.step).points[:, :2]
        return np.linalg.norm(self.found.blank[self.rim], axis=1) - np.linalg.norm(start[self.rim], axis=1)

    @property
    def strains(self) -> tuple[np.ndarray, np.ndarray]:
        """Thickness strain of the cells: increments, one step."""
        return self.run.field("thickness_strain", self.step), self.found.fields["thickness_strain"]


def triangles_of(mesh: Any) -> np.ndarray:
    """Return all cells of a mesh as triangles (n, 3)."""
    cells = [block.connectivity for block in mesh.blocks]
    halves = [c if c.shape[1] == 3 else c[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3) for c in cells]
    return np.concatenate(halves).astype(np.int32)


def step_back(run: Result, stage: str, material: Material, thickness: float, force: float, mu: float) -> Back:
    """Find the blank of the part at the end of a stage; force: of the holder [N]."""
    step = step_of(run, stage)
    mesh, points = run.mesh_at(step), run.points(step)
    by_corners = {n: [b.connectivity for b in mesh.blocks if b.connectivity.shape[1] == n] for n in (3, 4)}
    cells = {n: np.concatenate(c).astype(np.int32) if c else np.zeros((0, n), np.int32) for n, c in by_corners.items()}
    model = OneStepModel(
        title="a part of a line",
        points=points,
        triangles=cells[3],
        quadrilaterals=cells[4],
        rims=tuple(sorted(find_rims(points, triangles_of(mesh)), key=len, reverse=True)),
        material=material,
        thickness=thickness,
        rolling_direction=0.0,
        symmetry=(True, True),
        holder_force=force,
        mu=mu,
        layers=LAYERS,
    )
    return Back(run, step, solve_one_step(model))


def redrawn_cup(folder: Path) -> Result:
    """Draw the small cup and draw it again."""
    data = {
        "title": "a small cup",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 46, "thickness": 1.0, "element_size": 1.25, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": {"young": 206e3, "poisson": 0.3, "density": "7850 kg/m^3",
                                "hardening": {"law": "swift", "K": 565, "e0": 0.0071, "n": 0.26}}},
        "operations": [DRAW, REDRAW],
        "output": {"rows": 100, "steps": 1},
    }  # fmt: skip
    return finish(data, folder)


def bent_channel(folder: Path) -> Result:
    """Draw a slice of NUMISHEET'93's strip 40 mm deep."""
    case = strip_case(1.25, 2, 7, length=260, stroke=40)
    del case["springback"]
    return finish(case, folder)


def finish(data: dict[str, Any], folder: Path) -> Result:
    outcome = run_model(build_model(StampingCase.model_validate(data)), folder, overwrite=True, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def find_force(run: Result, name: str) -> float:
    """Return a punch's force at the end of its stroke [N]."""
    stroke = run.history[name.replace(".force", ".stroke")]
    return float(run.history[name][int(np.argmax(stroke))])


def print_back(what: str, back: Back, force: float) -> None:
    off, (true, found) = back.off_rim, back.strains
    rms = np.sqrt(np.mean((found - true) ** 2))
    print(
        f"{what}: rim {off.min():+.2f} to {off.max():+.2f} mm off; "
        f"thickness strain {true.min():+.3f} {true.max():+.3f}, "
        f"one step {found.min():+.3f} {found.max():+.3f}, rms {rms:.3f}; "
        f"punch {force / 1e3:.2f} kN, one step {back.found.punch_force / 1e3:.2f}",
        flush=True,
    )


if __name__ == "__main__":
    out = Path(sys.argv[1])
    line = run_line(out / "line")
    for stage in ("draw_form", "draw_springback", "pierce_springback"):
        back = step_back(line, stage, CUP_STEEL, 0.8, HOLDER, 0.1)
        print_back(f"line, {stage}", back, find_force(line, "draw_punch.force"))
    small = redrawn_cup(out / "small")
    for stage, punch, force in (("draw_form", "draw_punch", 4000.0), ("redraw_form", "redraw_punch", 1500.0)):
        back = step_back(small, stage, SMALL_CUP_STEEL, 1.0, force, 0.1)
        print_back(f"small cup, {stage}", back, find_force(small, f"{punch}.force"))
    channel = bent_channel(out / "channel")
    back = step_back(channel, "draw", CUP_STEEL, 0.78, 70.0 * 2.5, 0.144)
    print_back("channel", back, find_force(channel, "punch.force"))
