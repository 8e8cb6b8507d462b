# SPDX-License-Identifier: Apache-2.0
"""Heat that austenite sets free in solids as it becomes other phases (docs/theory/phases.md), lumped at the nodes.

In a time step ferrite, pearlite and bainite grow at the rates of its start. Martensite forms with the temperature of
its end: its heat stands in the balance with its derivative.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.evolution.kinetics import Kinetics
from presswork.interaction.heat.heat_films import Film
from presswork.model import FloatArray, Model

KIND = "latent"
"""Kind under which the heat is counted."""


class LatentFilm:
    """Heat set free over one time step."""

    kind = KIND

    def __init__(self, film: _core.HeatFilm) -> None:
        self._film = film

    def at(self, time: float) -> _core.HeatFilm:
        """Return the film."""
        return self._film


class PhasesAtNodes:
    """Phases of the steels of a model, at their nodes."""

    def __init__(self, model: Model, mass: Sequence[FloatArray]) -> None:
        """Take the mass of each block at the nodes, (n_points,) each [t]."""
        self._steels = []
        for number, material in enumerate(model.materials):
            if material.transformation is None:
                continue
            pairs = zip(model.mesh.blocks, mass, strict=False)
            own = sum((part for block, part in pairs if block.material == number), np.zeros_like(mass[0]))
            nodes = np.flatnonzero(own).astype(np.int32)
            self._steels.append((Kinetics(material.transformation), nodes, own[nodes]))
        self._n_points = len(model.mesh.points)

    def at_rest(self) -> FloatArray:
        """Return the fractions at the start (n_points, 4): of austenite alone."""
        return np.zeros((self._n_points, 4))

    def grow(self, fractions: FloatArray, temperature: FloatArray, dt: float) -> tuple[FloatArray, list[Film]]:
        """Return the fractions (n_points, 4) after a step of dt [s] but for martensite, and the heat of the step.

        temperature: of its start (n_points,) [degrees C].
        """
        if not self._steels:
            return fractions, []
        after, films = fractions.copy(), list[Film]()
        for kinetics, nodes, mass in self._steels:
            before = fractions[nodes].T
            grown = kinetics.advance(before, temperature[nodes], dt)
            after[nodes] = grown.T
            made = mass * kinetics.heat_of(grown - before) / dt
            if made.any():
                given = np.zeros(self._n_points)
                given[nodes] = made
                films.append(LatentFilm(_core.HeatFilm.flux(given)))
            (start, rate), heat = kinetics.martensite_law, mass * kinetics.heat_of_martensite / dt
            free = 1.0 - grown[:3].sum(axis=0)
            films.append(LatentFilm(_core.HeatFilm.martensite(nodes, heat, free, grown[3], start=start, rate=rate)))
        return after, films

    def finish(self, fractions: FloatArray, temperature: FloatArray) -> FloatArray:
        """Return the fractions with the martensite at the end of the step (n_points, 4)."""
        if not self._steels:
            return fractions
        after = fractions.copy()
        for kinetics, nodes, _ in self._steels:
            after[nodes, 3], _ = kinetics.martensite(fractions[nodes].T, temperature[nodes])
        return after
