# SPDX-License-Identifier: Apache-2.0
"""The heat that an increment of forming makes: of plastic work, and of friction on tools and between bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.body.heat import PointShapes, sum_at_nodes
from presswork.interaction.heat.forming_instant import FormingInstant
from presswork.interaction.heat.heat_surface import SurfaceNow
from presswork.model import FloatArray, Heat, Model


@dataclass(frozen=True)
class MadeHeat:
    """Heat made in an increment at the nodes of bodies (n_points,) each [N mm]."""

    plastic: FloatArray
    friction: FloatArray
    """Heat of friction that goes into the bodies."""
    into_tools: FloatArray
    """Heat of friction at these nodes that goes into each tool (n_tools, n_points)."""


class HeatSources:
    """Finds the heat that increments make."""

    def __init__(self, model: Model, heat: Heat) -> None:
        self._model, self._heat, self._shapes = model, heat, PointShapes(model)
        self._n_points = len(model.mesh.points)
        self._body_of = np.zeros(self._n_points, dtype=np.intp)
        for number, body in enumerate(model.bodies):
            self._body_of[body.points.start : body.points.stop] = number
        self._shares = self._share_friction()[:, self._body_of]

    def find(self, now: FormingInstant, surface: SurfaceNow) -> MadeHeat:
        """Return the heat of an increment."""
        plastic = np.zeros(self._n_points)
        for i, heat in enumerate(now.plastic):
            plastic += self._shapes.to_nodes(i, heat)
        into_bodies = self._shares * now.friction_work
        friction = into_bodies.sum(axis=0) + self._heat_bodies(now, surface)
        return MadeHeat(plastic, friction, now.friction_work - into_bodies)

    def _heat_bodies(self, now: FormingInstant, surface: SurfaceNow) -> FloatArray:
        """Return the heat of friction between bodies at the nodes (n_points,) [N mm].

        All that friction takes in the increment, shared by shear times slip at the pairs of nodes, and between the two
        of each by their effusivities.
        """
        n, between = self._n_points, now.between
        heat = np.zeros(n)
        if between.lost <= 0.0:
            return heat
        parts = []
        for meeting in surface.meetings:
            first, second = meeting.film.pairs.T
            slip = np.linalg.norm(between.moved[first] - between.moved[second], axis=1)
            parts.append(meeting.area * between.shear[meeting.contact.name][first] * slip)
        total = sum(float(part.sum()) for part in parts)
        for meeting, part in zip(surface.meetings, parts, strict=True):
            first, second = meeting.film.pairs.T
            own, other = (np.array(self._heat.effusivity)[self._body_of[nodes]] for nodes in (first, second))
            amount = between.lost * part / total if total > 0.0 else np.zeros(len(part))
            heat += sum_at_nodes(first, amount * own / (own + other), n)
            heat += sum_at_nodes(second, amount * other / (own + other), n)
        return heat

    def _share_friction(self) -> FloatArray:
        """Return the part of the heat of friction that goes from a tool into a body (n_tools, n_bodies)."""
        shares = np.full((len(self._model.tools), max(len(self._model.bodies), 1)), 0.5)
        for t, tool in enumerate(self._model.tools):
            heat = self._heat.tools.get(tool.name)
            if heat is not None and heat.effusivity is not None:
                own = np.array(self._heat.effusivity)
                shares[t] = own / (own + heat.effusivity)
        return shares
