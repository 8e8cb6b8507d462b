# SPDX-License-Identifier: Apache-2.0
"""Pressures on a sheet in the history: the pressure, the volume that the sheet has swept, and the pole of the bulge.

The pole is the node under the pressure that has moved farthest along its first normal. Round it the surface is fitted
by a sphere and a term of the fourth power of the distance r from the normal, c and R with the least squares of

    x . x = 2 c . x + d + e r^4,        R^2 = d + c . c,

since a pole near its instability is more curved than the sheet round it. R is the radius of curvature at the pole.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from presswork.fields.instant import Instant
from presswork.mesh.pressed_cells import find_area_vectors, find_pressed_cells, find_side, find_swept_volume
from presswork.model import FloatArray, IntArray, Model, SheetPressure
from presswork.observe.contract import History, Observed, Observer, Row

QUANTITIES = ("p", "volume", "height", "radius", "thickness", "contact")
RATE, LEAK = "strain_rate", "leak"
FITTED = 0.35
"""Distance round the pole over which the surface is fitted, over the radius of a circle as large as what is pressed."""
FITTED_EDGES = 3.5
"""Least such distance, in mean edges of cells."""
FLAT = 1e-6
"""Height over the fitted distance below which a sheet has no radius."""
PASSED = 0.01
"""Fall of a pressure below its largest, over it, from which the sheet has passed the maximum."""
LEAKED = 0.05
"""Part of a pressure that leaks above which it is reported."""
TOUCHED = 0.01
"""Force of a tool in the same direction, over that of the pressure, above which it is reported."""


class PressedSheet(Observer):
    """The pressures on the sheet of one model."""

    def __init__(self, model: Model) -> None:
        self._pressed = [PressedPart(model, pressure) for pressure in model.sheet_pressures]

    def columns(self, run: Observed) -> list[str]:
        """Return six for each pressure: MPa, mm3 of the whole part, at the pole mm, and the part of it on tools; where
        it holds a strain rate that, too [1/s].
        """
        return [part.name(each) for part in self._pressed for each in (*QUANTITIES, *part.more)]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the pressures, which are gone once the part is released, and the shapes of the bulges."""
        if not self._pressed:
            return {}
        value, row = {} if is_released else run.sheet_pressures(), Row()
        rates = {} if is_released else run.held_rates()
        now, strain = run.positions(), run.sheet_fields(with_surface=False)["thickness_strain"]
        forces = run.show().tool_force
        for part in self._pressed:
            on_tools = 0.0 if forces is None else part.find_touched(now, forces)
            found = (value.get(part.pressure.name, 0.0), *part.measure(now, strain), on_tools)
            row |= {part.name(quantity): each for quantity, each in zip(QUANTITIES, found, strict=True)}
            row |= {part.name(each): rates.get(part.pressure.name, 0.0) for each in part.more}
        return row

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the largest of each pressure, where it was, and whether the sheet went on beyond it."""
        if not self._pressed or not len(history["time"]):
            return {}
        return {"sheet_pressures": {part.pressure.name: part.find_largest(history) for part in self._pressed}}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return a warning where a tool lies on a face that a fluid presses."""
        if not self._pressed:
            return []
        now, positions, value = run.show(), run.positions(), run.sheet_pressures()
        found = [text for part in self._pressed if (text := part.warn(now, positions, value[part.pressure.name]))]
        return found + [text for part in self._pressed if (text := part.warn_of_leak(history))]


class PressedPart:
    """The part of a sheet under one pressure."""

    def __init__(self, model: Model, pressure: SheetPressure) -> None:
        self.pressure = pressure
        courses = [stage.pressure_course.get(pressure.name) for stage in model.stages]
        holds = any(course is not None and course.held is not None for course in courses)
        self.more = [RATE] if holds else [LEAK] if pressure.is_sealed else []
        self._points, self._symmetry, self._whole = model.mesh.points, model.symmetry, model.whole
        self._thickness = model.thickest
        self._numbers = find_pressed_cells(model.mesh.points, model.cells, pressure)
        self._cells: IntArray = model.cells[self._numbers]
        self._side = find_side(model.mesh.points, model.cells, pressure.face)
        self._normals = find_normals(self._points, self._cells, self._side)
        self._nodes = np.unique(self._cells)
        area = np.abs(find_area_vectors(self._points[self._cells])[..., 2]).sum()
        edge = np.sqrt(area / len(self._cells))
        self._reach = max(FITTED * float(np.sqrt(area * self._whole / np.pi)), FITTED_EDGES * float(edge))

    def name(self, quantity: str) -> str:
        """Return the name of a column."""
        return f"pressure.{self.pressure.name}.{quantity}"

    def measure(self, now: FloatArray, strain: FloatArray) -> tuple[float, float, float, float]:
        """Return volume [mm3], and height, radius of curvature and thickness at the pole [mm]; radius 0 where flat.

        now: positions of the nodes (n_points, 3) [mm]; strain: through the thickness, of cells (n_cells,).
        """
        volume = self._side * find_swept_volume(self._points, now, self._cells) * self._whole
        rise = ((now - self._points) * self._normals).sum(axis=1)[self._nodes]
        pole = int(self._nodes[np.argmax(rise)])
        around = self._numbers[(self._cells == pole).any(axis=1)]
        thickness = self._thickness * float(np.exp(strain[around].mean()))
        height = float(rise.max())
        radius = self._fit_radius(pole, now) if height > FLAT * self._reach else 0.0
        return volume + 0.0, height + 0.0, radius, thickness

    def _fit_radius(self, pole: int, now: FloatArray) -> float:
        """Return the radius of curvature at the pole, by the nodes round it and their mirror images [mm]."""
        near = np.linalg.norm(self._points[self._nodes] - self._points[pole], axis=1) <= self._reach
        x = now[self._nodes[near]]
        for axis, is_cut in enumerate(self._symmetry):
            if is_cut:
                x = np.concatenate([x, x * np.where(np.arange(3) == axis, -1.0, 1.0)])
        x = (x - now[pole]) / self._reach
        square = (x**2).sum(axis=1)
        aside = square - (x @ self._normals[pole]) ** 2
        terms = np.column_stack([2.0 * x, np.ones(len(x)), aside**2])
        *centre, rest, _ = np.linalg.lstsq(terms, square, rcond=None)[0]
        return self._reach * float(np.sqrt(max(rest + np.dot(centre, centre), 0.0)))

    def find_touched(self, now: FloatArray, forces: FloatArray) -> float:
        """Return the part of the pressed area that lies on tools. forces: of all tools on nodes (n_points, 3) [N]."""
        area = np.linalg.norm(find_area_vectors(now[self._cells]), axis=2)
        touched = (forces[self._cells] != 0.0).any(axis=2)
        return float(area[touched].sum() / area.sum())

    def find_largest(self, history: History) -> dict[str, Any]:
        """Return the largest pressure [MPa], its height [mm] and instant, and whether it fell while the bulge grew."""
        p, height = (np.asarray(history[self.name(quantity)], dtype=float) for quantity in ("p", "height"))
        at = int(np.argmax(p))
        beyond = (p[at:] < (1.0 - PASSED) * p[at]) & (p[at:] > 0.0) & (height[at:] > height[at])
        return {
            "largest_mpa": float(p[at]),
            "height_mm": float(height[at]),
            "largest_height_mm": float(height.max()),
            "stage": str(history["stage"][at]),
            "time_s": float(history["time"][at]),
            "passed": bool(beyond.any()),
        }

    def warn_of_leak(self, history: History) -> str:
        """Return a warning where the seal has held less than the pressure that was given."""
        if LEAK not in self.more or not len(history["time"]):
            return ""
        leak, p = (np.asarray(history[self.name(each)], dtype=float) for each in (LEAK, "p"))
        at = int(np.argmax(leak))
        if leak[at] <= LEAKED * (p[at] + leak[at]):
            return ""
        return (
            f"the pressure {self.pressure.name} leaks over the flange: at {history['time'][at]:.4g} s tools hold "
            f"{p[at]:.3g} of {p[at] + leak[at]:.3g} MPa: press the holder harder, or give less pressure"
        )

    def warn(self, now: Instant, positions: FloatArray, value: float) -> str:
        """Return a warning where tools push on the face that the fluid pushes; value: of the pressure [MPa]."""
        if now.tool_force is None or value <= 0.0:
            return ""
        along = (now.tool_force * find_normals(positions, self._cells, self._side)).sum(axis=1)
        area = np.linalg.norm(find_area_vectors(positions[self._cells]), axis=2).sum()
        force, whole = float(along.clip(0.0).sum()), value * float(area)
        if force <= TOUCHED * whole:
            return ""
        return (
            f"tools push the {self.pressure.face} face with {force * self._whole:.3g} N where the pressure "
            f"{self.pressure.name} acts, which no fluid does beneath a tool: keep the tools off it, or bound it by "
            f"pressure.{self.pressure.name}.inside"
        )


def find_normals(points: FloatArray, cells: IntArray, side: float) -> FloatArray:
    """Return the unit normals along which cells (n, 4) are pushed at their nodes (n_points, 3), 0 at the others."""
    vectors = np.zeros_like(points)
    np.add.at(vectors, cells, side * find_area_vectors(points[cells]))
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300))
