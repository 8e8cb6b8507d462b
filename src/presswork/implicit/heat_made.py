# SPDX-License-Identifier: Apache-2.0
"""The heat that an increment of forming makes: of plastic work, and of friction on tools and between bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.body.heat import PointShapes, sum_at_nodes
from presswork.body.solids import Mechanics
from presswork.interaction.heat_surface import HeatSurface, SurfaceNow
from presswork.interaction.of_model import Interactions
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import FloatArray, Heat, IntArray, Model
from presswork.state import State


@dataclass(frozen=True)
class MadeHeat:
    """Heat made in an increment at the nodes of bodies (n_points,) each [N mm]."""

    plastic: FloatArray
    friction: FloatArray
    """That goes into the bodies."""
    into_tools: FloatArray
    """Of friction at these nodes that goes into a tool."""
    tool: IntArray
    """Which tool that is (n_points,)."""


class HeatSources:
    """Finds the heat that increments make."""

    def __init__(
        self, model: Model, heat: Heat, cells: Mechanics, interactions: Interactions, surface: HeatSurface
    ) -> None:
        self._model, self._heat, self._cells, self._interactions = model, heat, cells, interactions
        self._surface, self._shapes = surface, PointShapes(model.mesh)
        self._n_points = len(model.mesh.points)
        self._shares = self._share_friction()
        self._body_of = np.zeros(self._n_points, dtype=np.intp)
        for number, body in enumerate(model.bodies):
            self._body_of[body.points.start : body.points.stop] = number

    def find(self, state_n: State, trial: State, surface: SurfaceNow, dt: float) -> MadeHeat:
        """Return the heat of an increment of dt [s] that is in equilibrium."""
        n = self._n_points
        plastic = np.zeros(n)
        for i, work in enumerate(self._cells.plastic_work_at_points(state_n, trial, dt)):
            plastic += self._shapes.to_nodes(i, work)
        friction, into_tools, rubs_on = np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.int32)
        contact = self._interactions.tools.contact
        lost = self._interactions.tools.friction.lost_at
        if self._model.plane_tools and lost.any():
            tool = np.argmax((trial[ContactArrays].status > 0), axis=0) // 2
            share = self._shares[tool, self._body_of[contact.nodes]]
            friction = sum_at_nodes(contact.nodes, share * lost, n)
            into_tools = sum_at_nodes(contact.nodes, (1.0 - share) * lost, n)
            rubs_on[contact.nodes] = tool
        friction += self._rub_bodies(state_n, trial, surface)
        return MadeHeat(self._heat.plastic_fraction * plastic, friction, into_tools, rubs_on)

    def _rub_bodies(self, state_n: State, trial: State, surface: SurfaceNow) -> FloatArray:
        """Return the heat of friction between bodies at the nodes (n_points,) [N mm].

        All that friction takes in the increment, shared by shear times slip at the pairs of nodes, and between the two
        of each by their effusivities.
        """
        n = self._n_points
        heat = np.zeros(n)
        lost = self._interactions.bodies.work(state_n, trial)["friction_work"] if self._model.contacts else 0.0
        if lost <= 0.0:
            return heat
        parts = []
        for meeting in surface.meetings:
            first, second = meeting.film.pairs.T
            slip = np.linalg.norm(trial.nodes.increment[first] - trial.nodes.increment[second], axis=1)
            parts.append(meeting.area * self._surface.find_shear(trial, meeting.contact)[first] * slip)
        total = sum(float(part.sum()) for part in parts)
        for meeting, part in zip(surface.meetings, parts, strict=True):
            first, second = meeting.film.pairs.T
            own, other = (np.array(self._heat.effusivity)[self._body_of[nodes]] for nodes in (first, second))
            amount = lost * part / total if total > 0.0 else np.zeros(len(part))
            heat += sum_at_nodes(first, amount * own / (own + other), n)
            heat += sum_at_nodes(second, amount * other / (own + other), n)
        return heat

    def _share_friction(self) -> FloatArray:
        """Return the part of the heat of friction that goes from a tool into a body (n_tools, n_bodies)."""
        shares = np.full((len(self._model.plane_tools), max(len(self._model.bodies), 1)), 0.5)
        for t, tool in enumerate(self._model.plane_tools):
            heat = self._heat.tools.get(tool.name)
            if heat is not None and heat.effusivity is not None:
                own = np.array(self._heat.effusivity)
                shares[t] = own / (own + heat.effusivity)
        return shares
