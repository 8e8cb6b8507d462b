# SPDX-License-Identifier: Apache-2.0
"""Films of heat: what heats and cools the surface of bodies, lumped at its nodes.

A film is compiled (cpp/assembly/heat_films.hpp): asked at a guess of the temperatures it answers the heat that it gives
to the nodes, with its derivative. Radiation and coefficients that depend on temperature are thus implicit, as is the
other side of a contact.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from presswork import _core
from presswork.body.heat import sum_at_nodes
from presswork.mesh.edges import edge_areas
from presswork.mesh.faces import face_areas
from presswork.mesh.facing import find_touching_faces, sum_pairs
from presswork.model import (
    STEFAN_BOLTZMANN,
    Convection,
    FloatArray,
    HeatFlux,
    HeatStage,
    IntArray,
    Model,
    Radiation,
    Surroundings,
)


class Film(Protocol):
    """One film."""

    kind: str
    """Kind under which its heat is counted."""

    def at(self, time: float) -> _core.HeatFilm:
        """Return the compiled film as it is so long after the stage began [s]."""


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

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return _core.HeatFilm.flux(self._area * read_at(self._entry.value, time))


class ConvectionFilm:
    """Newton's law of cooling."""

    kind = "convection"

    def __init__(self, entry: Convection, area: FloatArray) -> None:
        self._entry, self._area = entry, area

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return _core.HeatFilm.convection(self._area, self._entry.coefficient, read_at(self._entry.ambient, time))


class RadiationFilm:
    """Stefan and Boltzmann's law between a grey surface and large surroundings."""

    kind = "radiation"

    def __init__(self, entry: Radiation, area: FloatArray) -> None:
        self._entry, self._factor = entry, area * entry.emissivity * STEFAN_BOLTZMANN

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return _core.HeatFilm.radiation(self._factor, read_at(self._entry.ambient, time))


class ToolFilm:
    """Conductance between nodes and a tool: in proportion to the difference from a temperature at each."""

    kind = "tools"

    def __init__(self, nodes: IntArray, factor: FloatArray, other: FloatArray | float) -> None:
        """Take nodes (n,), each once, factors [N mm/(s K)] and the tool's temperatures there (n,) [degrees C]."""
        self._film = _core.HeatFilm.at_nodes(
            nodes, factor, np.full(len(nodes), other) if isinstance(other, float) else other
        )

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return self._film


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
        self.kind, self.pairs = kind, pairs
        self._film = _core.HeatFilm.between(pairs, factor)

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return self._film


def make_contacts(model: Model) -> list[PairFilm]:
    """Return the films between bodies that lie on each other and stay so."""
    assert model.heat is not None
    films = []
    sides = model.mesh.boundary_faces if model.analysis == "solid" else model.mesh.boundary_edges
    for entry in model.heat.contacts:
        own, other = (sides[model.bodies[i].owns(sides)] for i in entry.between)
        found = find_touching_faces(
            model.mesh.points, own, other, None if model.analysis == "axisymmetric" else model.depth
        )
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
