# SPDX-License-Identifier: Apache-2.0
"""Heat of solids in explicit dynamics: after each row of cycles heat flows for the time of the row
(implicit/heat_of_forming.py).

Within a row cells are heated by their own plastic work alone. The law keeps that rise; it is the plastic work of the
row, cycle by cycle, and what is given to the cells from outside is what heat has made of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from presswork.explicit.input_checks import ExplicitError
from presswork.implicit.heat_of_forming import HeatOfForming
from presswork.interaction.heat.forming_instant import FormingInstant, Poses
from presswork.model import FloatArray, Heating, Material, Model
from presswork.outcome import Failed, GaveUpError
from presswork.process.explicit.contacts import ContactsOfRun
from presswork.remesh.carrier import Carrier
from presswork.timing import Timing


def heat_by_itself(model: Model, material: Material) -> Material:
    """Return a material whose law is heated by its plastic work, with its specific heat at the start."""
    if model.heat is None or material.thermal is None:
        return material
    blocks = model.mesh.blocks
    own = [
        i
        for i, body in enumerate(model.bodies)
        if any(model.materials[blocks[b].material] is material for b in body.blocks)
    ]
    start = model.heat.initial[own[0] if own else 0]
    capacity = float(np.interp(start, *material.thermal.specific_heat.T))
    given = material.heating or Heating()
    made = replace(given, start=start, heat_capacity=capacity, plastic_fraction=model.heat.plastic_fraction)
    return replace(material, heating=made)


class HeatedSolids(Protocol):
    """Solids of an explicit loop, as heat sees them in the plane and in space."""

    @property
    def time(self) -> float:
        """[s]"""

    @property
    def position(self) -> FloatArray:
        """Displacement of the nodes (n_nodes, d) [mm]."""


class HeatedWall(Protocol):
    """A tool of an explicit loop, as heat sees it in the plane and in space."""

    @property
    def pressed(self) -> FloatArray:
        """Impulse of its pressure on the nodes since begin_sums (n_nodes,) [N s]."""

    @property
    def friction_work(self) -> FloatArray:
        """Work that friction on it has taken at the nodes since begin_sums (n_nodes,) [N mm]."""

    def begin_sums(self) -> None:
        """Sum up anew."""


class HeatOfSolids:
    """Heat of a model's bodies, beside the explicit loop; who inherits knows the dimension."""

    def __init__(
        self, model: Model, solids: HeatedSolids, walls: Sequence[HeatedWall], contacts: ContactsOfRun, threads: int
    ) -> None:
        """solids, walls, contacts: those of the explicit loop of the model's dimension."""
        assert model.heat is not None
        self._contacts, self._points = contacts, model.mesh.points
        self._model, self._heat, self._solids, self._walls = model, model.heat, solids, walls
        shortest = min(stage.duration for stage in model.stages)
        self.forming = HeatOfForming(
            model, Timing("assembly", "analysis", "solve"), threads, shortest / model.output.rows
        )
        self.arrays = self.forming.at_rest()
        self._rim = np.unique(model.mesh.boundary_faces if model.dimension == 3 else model.mesh.boundary_edges)
        self._capacity = self._measure_capacity()
        self._prescribe_temperature()

    def _measure_capacity(self) -> list[FloatArray]:
        """Return the heat that warms each cell by a degree, as its law has it (n_cells, 1) [N mm/K]."""
        model, found = self._model, []
        for block, volume in zip(model.mesh.blocks, self.forming.volumes(), strict=True):
            material = heat_by_itself(model, model.materials[block.material])
            assert material.heating is not None
            assert material.heating.heat_capacity is not None
            found.append(volume[:, None] * material.density * material.heating.heat_capacity)
        return found

    def _find_rise(self) -> list[FloatArray]:
        """Return the rise of temperature by plastic work at the points of each block (n_cells, p) [K]."""
        raise NotImplementedError

    def _prescribe_temperature(self) -> None:
        temperature = self.arrays.temperature
        given = [self.forming.to_points(block, temperature) - rise for block, rise in enumerate(self._find_rise())]
        self._set_given(given)

    def _set_given(self, given: list[FloatArray]) -> None:
        """Give the points of each block temperatures from outside (n_cells, p) [degrees C]."""
        raise NotImplementedError

    def _find_poses(self) -> Poses:
        """Return where tools in the plane stand; in space none."""
        raise NotImplementedError

    def _find_gap(self, t: int, places: FloatArray, reach: float) -> FloatArray:
        """Return the distance of places (n, d) from a tool (n,) [mm]; reach: beyond which it does not matter."""
        raise NotImplementedError

    def begin_stage(self) -> None:
        """Forget the rate of temperatures: what heats and cools jumps where a stage begins."""
        self.arrays = self.arrays.duplicate()
        self.forming.begin_stage(self.arrays)

    def begin_row(self) -> None:
        """Keep what a row of cycles begins with."""
        self._time, self._rise = self._solids.time, self._find_rise()
        self._points = self._solids.position
        for wall in self._walls:
            wall.begin_sums()

    def advance(self) -> None:
        """Let heat flow for the time of the row.

        Raises GaveUpError where it finds no balance, ExplicitError for a cell whose corners are turned inside out.
        """
        dt = self._solids.time - self._time
        try:
            found = self.forming.advance(self.arrays, self._show(dt), dt)
        except ValueError as error:
            raise ExplicitError(
                f"{error} at a corner by t = {self._solids.time:g} s, so it conducts no heat: refine the mesh, set "
                "explicit.hourglass_stiffness higher, or make the tools slower"
            ) from error
        if isinstance(found, Failed):
            raise GaveUpError(found.reason)
        self.arrays = found
        self._prescribe_temperature()

    def _show(self, dt: float) -> FormingInstant:
        """Return what heat asks of a row of dt [s]."""
        n, points = len(self._model.mesh.points), self._solids.position
        shape = (len(self._walls), n)
        pressed = np.array([wall.pressed for wall in self._walls]).reshape(shape)
        friction_work = np.array([wall.friction_work for wall in self._walls]).reshape(shape)
        gap = np.full(shape, np.inf)
        for t, tool in enumerate(self._model.tools):
            own = self._heat.tools.get(tool.name)
            if own is not None and own.gap > 0.0:
                gap[t, self._rim] = self._find_gap(t, points[self._rim], own.gap)
        parts = zip(self._find_rise(), self._rise, self._capacity, strict=True)
        return FormingInstant(
            points=points,
            poses=self._find_poses(),
            holds=pressed > 0.0,
            push=pressed / dt,
            gap=gap,
            plastic=[(now - before) * capacity / now.shape[1] for now, before, capacity in parts],
            friction_work=friction_work,
            between=self._contacts.show_heat(points - self._points, self._heat.contacts),
        )

    def go_on(self, before: HeatOfSolids, carrier: Carrier) -> None:
        """Let bodies whose temperatures come from another mesh have stored what they had there."""
        stored = before.forming.stored_in_bodies(before.arrays)
        self.forming.keep_stored(self.arrays, stored, carrier.is_new())
        self._prescribe_temperature()

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what the arrays gave that a checkpoint has."""
        taken = self.forming.at_rest()
        taken.load_arrays(arrays)
        self.arrays = taken
        self._prescribe_temperature()
