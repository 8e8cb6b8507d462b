# SPDX-License-Identifier: Apache-2.0
"""Where the surface of bodies that are formed touches tools and other bodies, or is free, in its present shape.

An edge touches a tool if the tool holds both its ends, a face in space if it holds all its nodes. Where a gap is given
across which heat passes, the conductance at no pressure falls evenly with the distance, to nothing at that gap; the
part that passes to the tool is taken off what the surroundings see of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.body.heat import sum_at_nodes
from presswork.geometry.pose import ToolPose
from presswork.interaction.heat.forming_instant import FormingInstant
from presswork.interaction.heat.heat_films import (
    ConvectionFilm,
    Film,
    PairFilm,
    interpolate,
    make_surroundings,
    measure_sides,
)
from presswork.interaction.heat.meshed_dies import Die, MeshedDies
from presswork.mesh.facing import find_facing, measure_lengths, split_edges, sum_pairs
from presswork.model import BodyContact, BoolArray, FloatArray, Heat, HeatContact, IntArray, Model, ToolHeat

TOO_DEEP = 0.1
"""Overlap of a body over the edge above which it counts as apart from the other."""
CHORDS = 0.25
"""How far the mesh of a tool may lie from the edges that touch its profile, both being chords of it, over an edge."""


@dataclass(frozen=True)
class Touch:
    """Where a tool touches bodies, or is near."""

    tool: int
    heat: ToolHeat
    nodes: IntArray
    """(n,)"""
    area: FloatArray
    """Area of the surface that they stand for (n,) [mm2]."""
    conductance: FloatArray
    """(n,) [N/(mm s K)]."""


@dataclass(frozen=True)
class Meeting:
    """Where two bodies touch, or are near."""

    contact: BodyContact
    film: PairFilm
    area: FloatArray
    """Area that its pairs of nodes share, the slave's first (n,) [mm2]."""


@dataclass(frozen=True)
class SurfaceNow:
    """What takes and gives heat at the surface."""

    touches: list[Touch]
    meetings: list[Meeting]
    """Meetings of bodies with each other."""
    links: dict[int, tuple[PairFilm, FloatArray]]
    """Films by tool with a mesh: what passes between its nodes and those of bodies, and the areas that they share
    (n_pairs,) [mm2]."""
    around: list[Film]
    """The surroundings."""


class HeatSurface:
    """Finds what the surface of a model's bodies touches."""

    def __init__(self, model: Model, heat: Heat, dies: MeshedDies) -> None:
        self._model, self._heat, self._dies = model, heat, dies
        self._edges = np.ascontiguousarray(find_open_sides(model), dtype=np.int32)
        self._corners = self._edges.shape[1] if model.analysis == "solid" else 2
        self._tools = [heat.tools.get(tool.name) for tool in model.tools]
        self._pieces = self._edges if model.analysis == "solid" else split_edges(self._edges)
        self._contacts = {contact.name: contact for contact in model.contacts}
        self._profiles: dict[int, tuple[tuple[float, float], FloatArray]] = {}
        self._thickness = None if model.analysis == "axisymmetric" else model.depth

    def find(self, now: FormingInstant, points: FloatArray) -> SurfaceNow:
        """Return what touches the surface; points: where the nodes of bodies and dies are (n_points, d) [mm]."""
        areas = measure_sides(self._model, self._edges, points)
        seen = areas.copy()
        touches = []
        links: dict[int, tuple[PairFilm, FloatArray]] = {}
        for t, heat in enumerate(self._tools):
            if heat is None:
                seen[now.holds[t][self._edges[:, : self._corners]].all(axis=1)] = 0.0
                continue
            touching, pressure, nodes, area, conductance = _core.find_touch(
                self._edges,
                areas,
                holds=now.holds[t],
                push=now.push[t],
                gap=now.gap[t],
                conductance=heat.conductance,
                width=heat.gap,
                seen=seen,
                corners=self._corners,
            )
            if len(nodes):
                touches.append(Touch(t, heat, nodes, area, conductance))
            if heat.die is not None:
                links[t] = self._link(t, heat, now.gap[t], points, np.asarray(touching), np.asarray(pressure))
        zones = self._find_zones(now.stage, seen, len(points))
        area = sum_at_nodes(self._edges, seen, len(points))
        for die in self._dies.dies:
            area += self._measure_profile(die, now.poses[die.tool], points)
            film, shared = links[die.tool]
            area -= sum_at_nodes(film.pairs[:, 1], shared, len(points))
        meetings = [self._meet(now, entry) for entry in self._heat.contacts]
        for meeting in meetings:
            for side in meeting.film.pairs.T:
                area = area - sum_at_nodes(side, meeting.area, len(points))
        area = np.maximum(area, 0.0)
        around = self._heat.surroundings
        around_now = make_surroundings(around, area) if around else []
        return SurfaceNow(touches, meetings, links, [*around_now, *zones])

    def _find_zones(self, stage: int, seen: FloatArray, n_points: int) -> list[Film]:
        """Return the films of a stage on zones, and take their sides out of what the surroundings see (n_edges, n)."""
        films: list[Film] = []
        given = self._model.stages[stage].heat
        for convection in reversed(given.convections if given else ()):
            zone = self._is_in(convection.side_set)
            films.append(ConvectionFilm(convection, sum_at_nodes(self._edges[zone], seen[zone], n_points)))
            seen[zone] = 0.0
        return films

    def _is_in(self, name: str) -> BoolArray:
        """Return which open sides belong to a set of sides."""
        mesh = self._model.mesh
        sets = mesh.face_sets if self._model.analysis == "solid" else mesh.edge_sets
        own = {tuple(sorted(side)) for side in sets[name].tolist()}
        return np.array([tuple(sorted(side)) in own for side in self._edges.tolist()], dtype=bool)

    def _measure_profile(self, die: Die, pose: ToolPose, points: FloatArray) -> FloatArray:
        """Return the area of a die's profile that each node stands for (n_points,) [mm2].

        It stays as it is while the die moves along the axis, or in the plane.
        """
        place = pose.angle, float(pose.displacement[0])
        kept = self._profiles.get(die.tool)
        if kept is None or kept[0] != place:
            kept = place, sum_at_nodes(die.profile, measure_sides(self._model, die.profile, points), len(points))
            self._profiles[die.tool] = kept
        return kept[1]

    def find_open(self, points: FloatArray) -> list[Film]:
        """Return the surroundings of tools with meshes that no body touches; points: of bodies and tools."""
        area = np.zeros(len(points))
        for die in self._dies.dies:
            area += sum_at_nodes(die.profile, measure_sides(self._model, die.profile, points), len(points))
        around = self._heat.surroundings
        return make_surroundings(around, area) if around else []

    def _link(
        self,
        t: int,
        heat: ToolHeat,
        gaps: FloatArray,
        points: FloatArray,
        touching: BoolArray,
        pressure: FloatArray,
    ) -> tuple[PairFilm, FloatArray]:
        """Return what passes between bodies and a tool with a mesh, and the areas that pairs of nodes share."""
        die = next(die for die in self._dies.dies if die.tool == t)
        pairs, conducted, shared = _core.link_tool(
            points,
            self._pieces,
            touching=touching,
            pressure=pressure,
            profile=die.profile,
            gap=gaps,
            conductance=heat.conductance,
            width=heat.gap,
            chords=CHORDS,
            thickness=self._thickness or 0.0,
        )
        return PairFilm("dies", np.asarray(pairs), np.asarray(conducted)), np.asarray(shared)

    def _meet(self, now: FormingInstant, entry: HeatContact) -> Meeting:
        """Return how two bodies touch or are near."""
        contact, points = self._contacts[entry.name], now.points
        own, other = (self._pieces[self._model.bodies[b].owns(self._pieces)] for b in (contact.slave, contact.master))
        length = measure_lengths(points, own)
        reach = np.full(len(own), entry.gap) + TOO_DEEP * length
        found = find_facing(points, own, other, reach, self._thickness)
        nodal = np.maximum(now.between.pressure[entry.name], 0.0)
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


def find_open_sides(model: Model) -> IntArray:
    """Return the boundary edges, in space faces, that no support holds: symmetry planes and clamps give no heat."""
    edges = model.mesh.boundary_faces if model.analysis == "solid" else model.mesh.boundary_edges
    held = np.zeros(len(edges), dtype=bool)
    for support in model.lasting_supports:
        held |= np.isin(edges, model.mesh.node_sets[support.node_set]).all(axis=1)
    return edges[~held]
