# SPDX-License-Identifier: Apache-2.0
"""Where the surface of bodies that are formed touches tools and other bodies, or is free, as it lies now.

An edge touches a tool if the tool holds both its ends. Where a gap is given across which heat passes, the conductance
at no pressure falls evenly with the distance, to nothing at that gap; the part that passes to the tool is taken off
what the surroundings see of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.body.heat import sum_at_nodes
from presswork.fields.contact_stress import ContactForces
from presswork.interaction.body_interface import InterfaceArrays
from presswork.interaction.heat_films import Film, PairFilm, interpolate, make_surroundings, measure_sides
from presswork.interaction.meshed_dies import MeshedDies
from presswork.interaction.of_model import Interactions
from presswork.mesh.edges import GAUSS_3
from presswork.mesh.facing import find_facing, split_edges, sum_pairs
from presswork.model import BodyContact, BoolArray, FloatArray, Heat, HeatContact, IntArray, Model, ToolHeat
from presswork.outcome import Step
from presswork.state import State

TOO_DEEP = 0.1
"""Of an edge: a body that overlaps another by more counts as apart from it."""
CHORDS = 0.25
"""Of an edge: how far the mesh of a tool may lie from the edges that touch its profile, both being chords of it."""
FAR = 1e3
"""Gaps, in widths across which heat passes, beyond which all are one."""


@dataclass(frozen=True)
class Touch:
    """Where a tool touches bodies, or is near."""

    tool: int
    heat: ToolHeat
    nodes: IntArray
    """(n,)"""
    area: FloatArray
    """That they stand for (n,) [mm2]."""
    conductance: FloatArray
    """(n,) [N/(mm s K)]."""


@dataclass(frozen=True)
class Meeting:
    """Where two bodies touch, or are near."""

    contact: BodyContact
    film: PairFilm
    area: FloatArray
    """That its pairs of nodes share, the slave's first (n,) [mm2]."""


@dataclass(frozen=True)
class SurfaceNow:
    """What takes and gives heat at the surface."""

    touches: list[Touch]
    meetings: list[Meeting]
    """Of bodies with each other."""
    links: dict[int, tuple[PairFilm, FloatArray]]
    """By tool with a mesh: what passes between its nodes and those of bodies, and the areas that they share
    (n_pairs,) [mm2]."""
    around: list[Film]
    """The surroundings."""


class HeatSurface:
    """Finds what the surface of a model's bodies touches."""

    def __init__(self, model: Model, heat: Heat, interactions: Interactions, dies: MeshedDies) -> None:
        self._model, self._heat, self._interactions, self._dies = model, heat, interactions, dies
        self._edges = find_open_edges(model)
        self._pieces = split_edges(self._edges)
        self._contacts = {contact.name: contact for contact in model.contacts}
        self._thickness = None if model.analysis == "axisymmetric" else model.depth

    def find(self, trial: State, step: Step) -> SurfaceNow:
        """Return what touches the surface of a state in equilibrium."""
        points = self._dies.place(trial)
        areas = measure_sides(self._model, self._edges, points)
        seen = areas.copy()
        touches = []
        links: dict[int, tuple[PairFilm, FloatArray]] = {}
        if self._model.plane_tools:
            forces = self._interactions.tools.contact.forces(trial, self._interactions.supports.fixed(step.stage))
            for t, tool in enumerate(self._model.plane_tools):
                held = np.zeros(len(self._model.mesh.points), dtype=bool)
                held[forces.nodes[forces.tool == t]] = True
                touching: BoolArray = np.asarray(held[self._edges[:, 0]] & held[self._edges[:, 1]])
                seen[touching] = 0.0
                heat = self._heat.tools.get(tool.name)
                if heat is None:
                    continue
                pressure = self._find_pressure(t, areas[touching], self._edges[touching], forces)
                near = self._near(t, heat.gap, areas, touching)
                if heat.gap > 0.0:
                    seen -= near
                touch = self._touch(t, heat, areas, near, touching, pressure)
                touches += [touch] if len(touch.nodes) else []
                if heat.die is not None:
                    links[t] = self._link(t, heat, points, touching, pressure)
        area = sum_at_nodes(self._edges, seen, len(points))
        for die in self._dies.dies:
            area += sum_at_nodes(die.profile, measure_sides(self._model, die.profile, points), len(points))
            film, shared = links[die.tool]
            area -= sum_at_nodes(film.pairs[:, 1], shared, len(points))
        meetings = [self._meet(trial, entry, points) for entry in self._heat.contacts]
        for meeting in meetings:
            for side in meeting.film.pairs.T:
                area = area - sum_at_nodes(side, meeting.area, len(points))
        area = np.maximum(area, 0.0)
        around = self._heat.surroundings
        return SurfaceNow(touches, meetings, links, make_surroundings(around, area) if around else [])

    def find_open(self, state: State) -> list[Film]:
        """Return the surroundings of tools with meshes that no body touches."""
        points = self._dies.place(state)
        area = np.zeros(len(points))
        for die in self._dies.dies:
            area += sum_at_nodes(die.profile, measure_sides(self._model, die.profile, points), len(points))
        around = self._heat.surroundings
        return make_surroundings(around, area) if around else []

    def _find_pressure(self, t: int, areas: FloatArray, edges: IntArray, forces: ContactForces) -> FloatArray:
        """Return the pressure of a tool at the nodes of the edges that it touches (n_points,) [MPa]."""
        own, n = forces.tool == t, len(self._model.mesh.points)
        area = sum_at_nodes(edges, areas, n)
        push = sum_at_nodes(forces.nodes[own], np.maximum(forces.push[own], 0.0), n)
        return np.asarray(np.divide(push, area, out=np.zeros(n), where=area > 0.0))

    def _touch(
        self, t: int, heat: ToolHeat, areas: FloatArray, near: FloatArray, touching: BoolArray, pressure: FloatArray
    ) -> Touch:
        """Return where a tool touches or is near: areas, and those of what is near, at the edges' nodes."""
        n = len(pressure)
        area = sum_at_nodes(self._edges[touching], areas[touching], n)
        conductance, _ = interpolate(heat.conductance, pressure)
        if heat.gap > 0.0:
            beside = sum_at_nodes(self._edges, near, n)
            loose = float(interpolate(heat.conductance, np.zeros(1))[0][0])
            whole = area + beside
            conductance = (area * conductance + beside * loose) / np.where(whole > 0.0, whole, 1.0)
            area = whole
        nodes = np.flatnonzero(area).astype(np.int32)
        return Touch(t, heat, nodes, area[nodes], conductance[nodes])

    def _link(
        self, t: int, heat: ToolHeat, points: FloatArray, touching: BoolArray, pressure: FloatArray
    ) -> tuple[PairFilm, FloatArray]:
        """Return what passes between bodies and a tool with a mesh, and the areas that pairs of nodes share."""
        die = next(die for die in self._dies.dies if die.tool == t)
        holds = np.tile(touching, len(self._pieces) // len(self._edges))
        gap = self._gaps(t, heat.gap)[self._pieces]
        counts = holds | (gap.min(axis=1) < heat.gap)
        own, gap, holds = self._pieces[counts], gap[counts], holds[counts]
        length = np.linalg.norm(points[own[:, 1]] - points[own[:, 0]], axis=1)
        reach = np.where(holds, 0.0, heat.gap) + CHORDS * length
        found = find_facing(points, own, die.profile, reach, self._thickness)
        held = holds[found.own]
        between = np.maximum((found.own_shape * gap[found.own]).sum(axis=1), 0.0)
        passes = np.where(held, 1.0, np.clip(1.0 - between / max(heat.gap, 1e-300), 0.0, 1.0))
        pushed = np.where(held, (found.own_shape * pressure[own[found.own]]).sum(axis=1), 0.0)
        area = passes * found.area
        conductance, _ = interpolate(heat.conductance, pushed)
        pairs, (conducted, shared) = sum_pairs(found, own, die.profile, conductance * area, area)
        return PairFilm("dies", pairs, conducted), shared

    def _gaps(self, t: int, width: float) -> FloatArray:
        """Return the distance of the nodes from a tool, cut off far away (n_points,) [mm]."""
        contact = self._interactions.tools.contact
        gap = np.full(len(self._model.mesh.points), np.inf)
        gap[contact.nodes] = contact.gap[2 * t]
        return np.asarray(np.minimum(gap, FAR * width + 1.0))

    def _near(self, t: int, width: float, areas: FloatArray, touching: BoolArray) -> FloatArray:
        """Return the area at the nodes of each edge (n_edges, n_nodes) by the part of heat that passes a gap."""
        if width == 0.0:
            return np.zeros_like(areas)
        ends = self._gaps(t, width)[self._edges[:, :2]]
        part = np.zeros(len(areas))
        for s, weight in GAUSS_3:
            between = 0.5 * (1 - s) * ends[:, 0] + 0.5 * (1 + s) * ends[:, 1]
            part += 0.5 * weight * np.clip(1.0 - np.maximum(between, 0.0) / width, 0.0, 1.0)
        part[touching] = 0.0
        return np.asarray(areas * part[:, None])

    def _meet(self, trial: State, entry: HeatContact, points: FloatArray) -> Meeting:
        """Return how two bodies touch or are near."""
        contact = self._contacts[entry.name]
        own, other = (self._pieces[self._model.bodies[b].owns(self._pieces)] for b in (contact.slave, contact.master))
        length = np.linalg.norm(points[own[:, 1]] - points[own[:, 0]], axis=1)
        reach = np.full(len(own), entry.gap) + TOO_DEEP * length
        found = find_facing(points, own, other, reach, self._thickness)
        nodal = np.maximum(self._spread(contact, trial[InterfaceArrays].pressure), 0.0)
        pressure = (found.own_shape * nodal[own[found.own]]).sum(axis=1)
        conductance, _ = interpolate(entry.conductance, pressure)
        width = entry.gap if entry.gap > 0.0 else np.inf
        apart = np.where(pressure > 0.0, 0.0, np.maximum(found.gap, 0.0))
        passes = np.where((entry.gap > 0.0) | (pressure > 0.0), np.clip(1.0 - apart / width, 0.0, 1.0), 0.0)
        passes[found.gap < -TOO_DEEP * length[found.own]] = 0.0
        area = (
            (0.5 if contact.slave == contact.master else 1.0) * passes * found.area
        )  # a fold is found from both sides
        pairs, (conducted, shared) = sum_pairs(found, own, other, conductance * area, area)
        return Meeting(contact, PairFilm("contact", pairs, conducted), shared)

    def find_shear(self, state: State, contact: BodyContact) -> FloatArray:
        """Return how large the shear of a contact is at the slave's nodes (n_points,) [MPa]."""
        return self._spread(contact, np.abs(state[InterfaceArrays].shear))

    def _spread(self, contact: BodyContact, slots: FloatArray) -> FloatArray:
        """Return what the slots of all contacts (n_slots,) tell of one at the slave's nodes (n_points,)."""
        nodal = np.zeros(len(self._model.mesh.points))
        interface = next(i for i in self._interactions.bodies.interfaces if i.contact is contact)
        nodal[interface.nodes] = slots[interface.places]
        if interface.slave.shape[1] == 3:
            first, last, middle = interface.slave.T
            nodal[middle] = 0.5 * (nodal[first] + nodal[last])
        return nodal


def find_open_edges(model: Model) -> IntArray:
    """Return the boundary edges that no support holds: those of symmetry planes and clamps give no heat."""
    edges = model.mesh.boundary_edges
    held = np.zeros(len(edges), dtype=bool)
    for support in model.supports:
        held |= np.isin(edges, model.mesh.node_sets[support.node_set]).all(axis=1)
    return edges[~held]
