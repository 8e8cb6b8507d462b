# SPDX-License-Identifier: Apache-2.0
"""Heat in a sheet: temperatures at levels through the thickness of every node (docs/theory/sheet_heat.md).

A node stands for a column of the sheet, in which heat flows between equally spaced levels; between columns it flows in
the plane of the cells, level by level. A time step of backward Euler takes the plane first, then the columns:

    1. (C/dt + K) d = -K T_n,   Q = -K (T_n + d)     in the plane, by conjugate gradients
    2. m (H(T) - H(T_n)) / dt = Q + conduction through the thickness + faces + sources     by Newton's method

Only Q goes from the first to the second, and it sums to zero whatever the accuracy of d, so that what is stored is what
has come in. Conductivities are those at the start of the step. Arrays are (levels, n_points), from the bottom up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy

from presswork.body.heat import Enthalpy, sum_at_nodes
from presswork.evolution.kinetics import Kinetics
from presswork.mesh.topology import is_triangle
from presswork.model import FloatArray, IntArray, Thermal, find_cell

MOST_ITERATIONS = 40
RESIDUAL = 1e-12
"""Largest out-of-balance over the sum of all heat flows."""
CORRECTION = 1e-11
"""Largest correction [K] over the largest temperature: nothing smaller is worth an iteration."""
PLANE_ACCURACY = 1e-6
"""Relative accuracy of the conjugate gradients; the balance of heat does not depend on it."""
_CORNER = 1.0 / np.sqrt(3.0)
_XI = np.array([[-_CORNER, -_CORNER], [_CORNER, -_CORNER], [_CORNER, _CORNER], [-_CORNER, _CORNER]])
_SIGNS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
SHAPES = 0.25 * np.prod(1.0 + _XI[:, None] * _SIGNS, axis=2)
"""Shape functions of four nodes at the 2 x 2 points (q, node)."""
_SLOPES = 0.25 * np.stack(
    [_SIGNS[:, 0] * (1.0 + _XI[:, None, 1] * _SIGNS[:, 1]), _SIGNS[:, 1] * (1.0 + _XI[:, None, 0] * _SIGNS[:, 0])],
    axis=2,
)


class FaceFilm(Protocol):
    """What heats and cools one face of the sheet over a step."""

    kind: str
    """Kind under which its heat is counted."""
    level: int
    """0 at the bottom, -1 at the top."""

    def evaluate(self, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heat into the nodes [N mm/s] and minus its derivative, at temperatures of the face (n_points,)."""


@dataclass(frozen=True)
class SheetHeatStep:
    """A converged step."""

    temperature: FloatArray
    """(levels, n_points) [degrees C]."""
    fractions: FloatArray
    """Fractions of PHASES (4, levels, n_points)."""
    power: dict[str, float]
    """Mean heat that came in by kind of film [N mm/s]; `latent`: set free by transformations."""
    error: float
    """Largest error of the step, as estimated [K]."""
    iterations: int


@dataclass(frozen=True)
class _Balance:
    """Heat at one guess (levels, n_points), flows in N mm/s."""

    content: FloatArray
    """[N mm]"""
    flow: FloatArray
    """Heat that conduction through the thickness and films bring in."""
    latent: FloatArray
    """Set free by martensite."""
    slope: FloatArray
    """Derivative of the stored and released heat, conduction left out [N mm/(s K)]."""
    storing: FloatArray
    """The part of it that is stored, with latent heat."""
    fractions: FloatArray
    """(4, levels, n_points)."""
    power: dict[str, float]
    """Power of each kind of film."""


class SheetConduction:
    """Conduction and storage of one sheet."""

    def __init__(
        self,
        points: FloatArray,
        cells: IntArray,
        thermal: Thermal,
        thickness: float,
        levels: int,
        steel: Kinetics | None,
    ) -> None:
        """Take the undeformed points (n_points, 3) and cells (n, 4), a triangle with its last node twice."""
        self.n_points, self.levels, self._cells, self._thermal = len(points), levels, cells, thermal
        self._enthalpy, self._steel = Enthalpy(thermal), steel
        self.share = np.full(levels, 1.0 / (levels - 1))
        """Part of the thickness that each level stands for."""
        self.share[[0, -1]] *= 0.5
        n = self.n_points
        pairs = (cells[:, :, None].astype(np.int64) * n + cells[:, None, :]).ravel()
        entries, self._entry = np.unique(pairs, return_inverse=True)
        self._columns = (entries % n).astype(np.int32)
        self._starts = np.searchsorted(entries // n, np.arange(n + 1)).astype(np.int32)
        self.shapes = np.broadcast_to(SHAPES, (len(cells), 4, 4))
        self._shape: tuple[FloatArray, FloatArray] | None = None
        self.mass = self._lump(points, np.full(len(cells), thermal.density * thickness))
        """Mass of the nodes [t]."""
        self.update(points, np.full(len(cells), thickness))

    def _lump(self, points: FloatArray, amount: FloatArray) -> FloatArray:
        """Return the nodal sums of an amount per area of each cell (n_points,)."""
        _, area = self._measure(points)
        return sum_at_nodes(self._cells, np.einsum("cq,qa->ca", area * amount[:, None], SHAPES), self.n_points)

    def _measure(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the base vectors at the points (n, q, 2, 3) and the areas that these stand for (n, q) [mm2]."""
        base = np.asarray(_SLOPES.transpose(0, 2, 1) @ points[self._cells][:, None])
        return base, np.linalg.norm(np.cross(base[:, :, 0], base[:, :, 1]), axis=2)

    def measure_areas(self, points: FloatArray) -> FloatArray:
        """Return the areas that the 2 x 2 points of the cells stand for (n, 4) [mm2]."""
        return self._measure(points)[1]

    def update(self, points: FloatArray, thickness: FloatArray) -> None:
        """Take the shape of the sheet: nodes (n_points, 3) and thickness of the cells (n,) [mm]."""
        if self._shape is not None and all(map(np.array_equal, self._shape, (points, thickness))):
            return
        self._shape = points.copy(), thickness.copy()
        base, area = self._measure(points)
        weight = area * thickness[:, None]
        a, b, c = (np.einsum("cqi,cqi->cq", base[:, :, i], base[:, :, j]) for i, j in ((0, 0), (0, 1), (1, 1)))
        inverse = (
            np.stack([c, -b, -b, a], axis=2).reshape(*a.shape, 2, 2) * (weight / (a * c - b * b))[:, :, None, None]
        )
        slopes = _SLOPES @ inverse
        self._plane = slopes.transpose(0, 2, 1, 3).reshape(len(base), 4, 8) @ _SLOPES.transpose(0, 2, 1).reshape(8, 4)
        self.area = sum_at_nodes(self._cells, np.einsum("cq,qa->ca", area, SHAPES), self.n_points)
        """Area of one face that each node stands for (n_points,) [mm2]."""
        volume = sum_at_nodes(self._cells, np.einsum("cq,qa->ca", weight, SHAPES), self.n_points)
        self.thickness = np.divide(volume, self.area, out=np.ones(self.n_points), where=self.area > 0)
        """Thickness at the nodes (n_points,) [mm]."""
        normal = np.zeros((self.n_points, 3))
        of_cell = np.cross(base[:, :, 0], base[:, :, 1]).sum(axis=1)
        for axis in range(3):
            normal[:, axis] = sum_at_nodes(self._cells, np.repeat(of_cell[:, None, axis], 4, axis=1), self.n_points)
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        self.normal = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
        """Unit normals, out of the top (n_points, 3)."""

    def content(self, temperature: FloatArray) -> FloatArray:
        """Return the heat stored at levels and nodes (levels, n_points) [N mm]; its zero is arbitrary."""
        return np.asarray(self.mass * self.share[:, None] * self._enthalpy.find(temperature)[0])

    def mean(self, temperature: FloatArray) -> float:
        """Return the mean temperature, weighted by mass."""
        return float(self.share @ temperature @ self.mass / self.mass.sum())

    def step(
        self,
        temperature_n: FloatArray,
        fractions_n: FloatArray,
        dt: float,
        films: Sequence[FaceFilm],
        source: FloatArray,
    ) -> SheetHeatStep | None:
        """Return a step of dt [s] from temperatures (levels, n_points); None if it finds no balance of heat.

        source: heat made at levels and nodes (levels, n_points) [N mm/s].
        """
        mass = self.mass * self.share[:, None]
        content_n, capacity_n = (mass * part for part in self._enthalpy.find(temperature_n))
        conductivity = np.interp(temperature_n, *self._thermal.conductivity.T)
        given = source + self._conduct_in_plane(temperature_n, conductivity, capacity_n / dt)
        through = 0.5 * (conductivity[1:] + conductivity[:-1]) * self.area / (self.thickness / (self.levels - 1))
        fractions, diffused = fractions_n, np.zeros_like(temperature_n)
        if self._steel is not None:
            fractions = self._steel.advance(fractions_n, temperature_n, dt)
            diffused = mass * self._steel.heat_of(fractions - fractions_n) / dt
        given = given + diffused
        temperature, start_rate, finished = temperature_n, None, False
        for iteration in range(MOST_ITERATIONS):
            now = self._evaluate(temperature, fractions, dt, films, through)
            stored = (now.content - content_n) / dt
            residual = now.flow + given + now.latent - stored
            if start_rate is None:
                start_rate = residual / (dt * now.storing)
            largest = sum(float(np.abs(part).sum()) for part in (stored, now.flow, now.latent, given))
            if not np.isfinite(largest):
                return None
            if finished or np.abs(residual).sum() <= RESIDUAL * largest:
                power = now.power | {"latent": float((now.latent + diffused).sum())}
                begins = (fractions_n[3] == 0.0) & (now.fractions[3] > 0.0)  # its heat is that of the step's end
                error = np.where(begins, 0.0, 0.5 * (temperature - temperature_n - dt * start_rate))
                return SheetHeatStep(temperature, now.fractions, power, float(np.abs(error).max()), iteration)
            correction = _solve_columns(now.slope, through, residual)
            temperature = temperature + correction
            finished = bool(np.abs(correction).max() <= CORRECTION * max(1.0, float(np.abs(temperature).max())))
        return None

    def _evaluate(
        self,
        temperature: FloatArray,
        fractions: FloatArray,
        dt: float,
        films: Sequence[FaceFilm],
        through: FloatArray,
    ) -> _Balance:
        """Return heat flows at a guess; through: conductance between levels (levels - 1, n_points) [N mm/(s K)]."""
        mass = self.mass * self.share[:, None]
        content, capacity = (mass * part for part in self._enthalpy.find(temperature))
        flow, slope, latent = np.zeros_like(temperature), capacity / dt, np.zeros_like(temperature)
        between = through * np.diff(temperature, axis=0)
        flow[:-1] += between
        flow[1:] -= between
        if self._steel is not None:
            formed, rise = self._steel.martensite(fractions, temperature)
            heat = mass * self._steel.heat_of_martensite / dt
            latent, slope = heat * (formed - fractions[3]), slope - heat * rise
            fractions = np.concatenate([fractions[:3], formed[None]])
        storing, power = slope.copy(), {film.kind: 0.0 for film in films}
        for film in films:
            taken, stiffness = film.evaluate(temperature[film.level])
            flow[film.level] += taken
            slope[film.level] += stiffness
            power[film.kind] += float(taken.sum())
        return _Balance(content, flow, latent, slope, storing, fractions, power)

    def _conduct_in_plane(self, temperature: FloatArray, conductivity: FloatArray, capacity: FloatArray) -> FloatArray:
        """Return the heat that conduction in the plane brings (levels, n_points) [N mm/s], by backward Euler.

        capacity: over dt (levels, n_points) [N mm/(s K)].
        """
        of_cell = conductivity.mean(axis=0)[self._cells].mean(axis=1)
        data = np.bincount(self._entry, (self._plane * of_cell[:, None, None]).ravel())
        matrix = scipy.sparse.csr_matrix((data, self._columns, self._starts), shape=(self.n_points, self.n_points))
        share = self.share[:, None]
        diagonal = capacity + share * matrix.diagonal()

        def conduct(t: FloatArray) -> FloatArray:
            return np.asarray(share * (matrix @ t.T).T)

        residual = -conduct(temperature)
        change, direction, last = np.zeros_like(temperature), np.zeros_like(temperature), 1.0
        aim = PLANE_ACCURACY**2 * float((residual**2 / diagonal).sum())
        for _ in range(1000):
            scaled = residual / diagonal
            now = float((residual * scaled).sum())
            if now <= aim:
                break
            direction = scaled + (now / last) * direction
            answer = capacity * direction + conduct(direction)
            size = now / float((direction * answer).sum())
            change += size * direction
            residual -= size * answer
            last = now
        return -conduct(temperature + change)


def _solve_columns(diagonal: FloatArray, between: FloatArray, right: FloatArray) -> FloatArray:
    """Return x of (diagonal + conduction between neighbours) x = right, all (levels, n); between (levels - 1, n)."""
    levels = len(diagonal)
    pivot, x = diagonal.copy(), right.copy()
    pivot[:-1] += between
    pivot[1:] += between
    for i in range(1, levels):
        factor = between[i - 1] / pivot[i - 1]
        pivot[i] -= factor * between[i - 1]
        x[i] += factor * x[i - 1]
    x[-1] /= pivot[-1]
    for i in range(levels - 2, -1, -1):
        x[i] = (x[i] + between[i] * x[i + 1]) / pivot[i]
    return x


class LayerMap:
    """Carries quantities between levels at the nodes and the layers of the cells' integration points."""

    def __init__(self, cells: IntArray, shapes: FloatArray, heights: FloatArray, levels: int, n_points: int) -> None:
        """Take cells (n, nodes), shape functions at their q points (q, nodes), heights of layers in [-1, 1]."""
        place = 0.5 * (np.clip(heights, -1.0, 1.0) + 1.0) * (levels - 1)
        below = np.minimum(place.astype(int), levels - 2)
        self._of_layer = np.zeros((len(heights), levels))
        self._of_layer[np.arange(len(heights)), below] = 1.0 - (place - below)
        self._of_layer[np.arange(len(heights)), below + 1] += place - below
        weights = np.broadcast_to(shapes, (len(cells), *shapes.shape))
        if find_cell(2, cells).name == "quad4" and len(shapes) == 1 and (three := is_triangle(cells)).any():
            weights = weights.copy()
            weights[three] = np.array([[1 / 3, 1 / 3, 1 / 6, 1 / 6]])
        self._weights, self._cells, self._n = weights, cells, n_points

    def to_layers(self, temperature: FloatArray) -> FloatArray:
        """Return values at the layers (n_cells, q, k) of values at levels (levels, n_points)."""
        at_points = np.einsum("cqa,lca->cql", self._weights, temperature[:, self._cells])
        return np.asarray(at_points @ self._of_layer.T)

    def to_levels(self, amounts: FloatArray) -> FloatArray:
        """Return what amounts at the layers (n_cells, q, k) come to at the levels (levels, n_points): the sum stays."""
        of_levels = np.einsum("cqk,kl->lcq", amounts, self._of_layer)
        at_nodes = np.einsum("lcq,cqa->lca", of_levels, self._weights)
        return np.stack([sum_at_nodes(self._cells, level, self._n) for level in at_nodes])
