# SPDX-License-Identifier: Apache-2.0
"""Films of heat: what heats and cools the surface of bodies, lumped at its nodes.

A film is asked at a guess of the temperatures and answers the heat that it gives to the nodes, with its derivative.
Radiation and coefficients that depend on temperature are thus implicit, as is the other side of a contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from presswork.body.heat import sum_at_nodes
from presswork.mesh.edges import edge_areas
from presswork.mesh.faces import face_areas
from presswork.mesh.facing import find_lying, sum_pairs
from presswork.model import (
    STEFAN_BOLTZMANN,
    ZERO_CELSIUS,
    Convection,
    FloatArray,
    HeatFlux,
    HeatStage,
    IntArray,
    Model,
    Radiation,
    Surroundings,
)


@dataclass(frozen=True)
class HeatFlow:
    """What a film gives to the nodes."""

    power: FloatArray
    """(n_points,) [N mm/s]."""
    slope: FloatArray
    """-d power / d temperature of the same node (n_points,) [N mm/(s K)]."""
    coupled: tuple[IntArray, FloatArray] | None = None
    """Pairs of different nodes (n, 2), and -d power of the first / d temperature of the second of each (n,)."""


class Film(Protocol):
    """One film."""

    kind: str
    """Under which its heat is counted."""

    def evaluate(self, temperature: FloatArray, time: float) -> HeatFlow:
        """Return the flow at nodal temperatures (n_points,) [degrees C], so long after the stage began [s]."""


def interpolate(table: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the values of a table (n, 2) and their slopes: linear between rows, constant beyond."""
    if len(table) == 1:
        return np.full(np.shape(at), table[0, 1]), np.zeros(np.shape(at))
    arguments, values = table.T
    row = np.clip(np.searchsorted(arguments, at, side="right") - 1, 0, len(table) - 2)
    slope = (np.diff(values) / np.diff(arguments))[row]
    inside = (at >= arguments[0]) & (at < arguments[-1])
    return np.interp(at, arguments, values), np.where(inside, slope, 0.0)


def read_at(table: FloatArray, time: float) -> float:
    """Return the value of a table by time."""
    return float(table[0, 1] if len(table) == 1 else np.interp(time, *table.T))


def measure_sides(model: Model, sides: IntArray, points: FloatArray) -> FloatArray:
    """Return the area that each node of each edge, in space face, stands for (n_sides, n_nodes) [mm2]."""
    if model.analysis == "solid":
        return face_areas(points, sides)
    return edge_areas(points, sides, None if model.analysis == "axisymmetric" else model.depth)


def side_areas(model: Model, sides: IntArray, points: FloatArray) -> FloatArray:
    """Return the area of the surface that each node stands for on edges, in space faces (n_points,) [mm2]."""
    return sum_at_nodes(sides, measure_sides(model, sides, points), len(points))


class FluxFilm:
    """A given flux of heat."""

    kind = "flux"

    def __init__(self, entry: HeatFlux, area: FloatArray) -> None:
        self._entry, self._area = entry, area

    def evaluate(self, temperature: FloatArray, time: float) -> HeatFlow:
        """Return the flow."""
        return HeatFlow(self._area * read_at(self._entry.value, time), np.zeros(len(temperature)))


class ConvectionFilm:
    """Newton's law of cooling."""

    kind = "convection"

    def __init__(self, entry: Convection, area: FloatArray) -> None:
        self._entry, self._area = entry, area
        self._slope = area * entry.coefficient[0, 1]  # of a coefficient that does not depend on temperature

    def evaluate(self, temperature: FloatArray, time: float) -> HeatFlow:
        """Return the flow."""
        if len(self._entry.coefficient) == 1:
            return HeatFlow(self._slope * (read_at(self._entry.ambient, time) - temperature), self._slope)
        coefficient, slope = interpolate(self._entry.coefficient, temperature)
        excess = temperature - read_at(self._entry.ambient, time)
        return HeatFlow(-self._area * coefficient * excess, self._area * (coefficient + slope * excess))


class RadiationFilm:
    """Stefan and Boltzmann's law between a grey surface and large surroundings."""

    kind = "radiation"

    def __init__(self, entry: Radiation, area: FloatArray) -> None:
        self._entry, self._factor = entry, area * entry.emissivity * STEFAN_BOLTZMANN

    def evaluate(self, temperature: FloatArray, time: float) -> HeatFlow:
        """Return the flow."""
        kelvin = temperature + ZERO_CELSIUS
        ambient = read_at(self._entry.ambient, time) + ZERO_CELSIUS
        cube = kelvin * kelvin * kelvin
        return HeatFlow(-self._factor * (cube * kelvin - ambient**4), 4 * self._factor * cube)


class LastingFilm:
    """Nodes that each exchange heat with a temperature of its own, in proportion to the difference."""

    def __init__(self, nodes: IntArray, factor: FloatArray, other: FloatArray | float) -> None:
        """Take nodes (n,), each once, factors [N mm/(s K)] and the temperatures on the other side (n,) [degrees C]."""
        self._nodes, self._factor, self._other = nodes, factor, other
        self._slope: FloatArray = np.zeros(0)

    def evaluate(self, temperature: FloatArray) -> HeatFlow:
        """Return the flow."""
        if len(self._slope) != len(temperature):
            self._slope = np.zeros(len(temperature))
            self._slope[self._nodes] = self._factor
        power = np.zeros(len(temperature))
        power[self._nodes] = self._factor * (self._other - temperature[self._nodes])
        return HeatFlow(power, self._slope)


class ToolFilm:
    """Conductance between nodes and a tool of constant temperature."""

    kind = "tools"

    def __init__(self, temperature: float, nodes: IntArray, area: FloatArray, conductance: FloatArray) -> None:
        """Take the tool's temperature, nodes (n,), the areas that they stand for [mm2] and conductances there (n,)."""
        self._lasting = LastingFilm(nodes, area * conductance, temperature)

    def evaluate(self, temperature: FloatArray, time: float) -> HeatFlow:
        """Return the flow."""
        return self._lasting.evaluate(temperature)


def make_surroundings(surroundings: Surroundings, area: FloatArray) -> list[Film]:
    """Return the films on free surfaces; area: what each node stands for of them (n_points,) [mm2]."""
    ambient = np.array([[0.0, surroundings.ambient]])
    films: list[Film] = []
    if surroundings.coefficient > 0.0:
        coefficient = np.array([[0.0, surroundings.coefficient]])
        films.append(ConvectionFilm(Convection("", coefficient, ambient), area))
    if surroundings.emissivity > 0.0:
        films.append(RadiationFilm(Radiation("", surroundings.emissivity, ambient), area))
    return films


class PairFilm:
    """Conductance between surfaces that face each other, node by node over the area that two nodes share.

    A row of nodes at one temperature against a row at another exchanges the exact heat on any pair of meshes, and no
    node is cooled below its neighbours.
    """

    def __init__(self, kind: str, pairs: IntArray, factor: FloatArray) -> None:
        """Take pairs of nodes (n, 2), and conductance times shared area [N mm/(s K)] of each."""
        self.kind, self.pairs, self._factor = kind, pairs, factor
        self._first, self._second = np.ascontiguousarray(pairs.T)
        self._coupled = np.concatenate([pairs, pairs[:, ::-1]]), np.tile(-factor, 2)

    def evaluate(self, temperature: FloatArray, time: float) -> HeatFlow:
        """Return the flow."""
        n, first, second = len(temperature), self._first, self._second
        flow = self._factor * (temperature[first] - temperature[second])
        power = sum_at_nodes(second, flow, n) - sum_at_nodes(first, flow, n)
        slope = sum_at_nodes(first, self._factor, n) + sum_at_nodes(second, self._factor, n)
        return HeatFlow(power, slope, self._coupled)


def make_contacts(model: Model) -> list[PairFilm]:
    """Return the films between bodies that lie on each other and stay so."""
    assert model.heat is not None
    films = []
    for entry in model.heat.contacts:
        own, other = (model.mesh.boundary_edges[model.bodies[i].owns(model.mesh.boundary_edges)] for i in entry.between)
        found = find_lying(model.mesh.points, own, other, None if model.analysis == "axisymmetric" else model.depth)
        conductance, _ = interpolate(entry.conductance, np.zeros(len(found.area)))
        pairs, (conducted,) = sum_pairs(found, own, other, conductance * found.area)
        films.append(PairFilm("contact", pairs, conducted))
    return films


def make_films(model: Model, stage: HeatStage, points: FloatArray) -> list[Film]:
    """Return the films of a stage on the surfaces as they lie at `points` (n_points, d)."""
    sets = model.mesh.face_sets if model.analysis == "solid" else model.mesh.edge_sets
    films: list[Film] = []
    for flux in stage.fluxes:
        films.append(FluxFilm(flux, side_areas(model, sets[flux.side_set], points)))
    for convection in stage.convections:
        films.append(ConvectionFilm(convection, side_areas(model, sets[convection.side_set], points)))
    for radiation in stage.radiations:
        films.append(RadiationFilm(radiation, side_areas(model, sets[radiation.side_set], points)))
    return films
