# SPDX-License-Identifier: Apache-2.0
"""Contact of the nodes of a solid in space with rigid tools: a spring with augmented Lagrange, and friction.

A node's normal force is that of its multiplier and of a spring as stiff as the metal beneath it, k = E h with h the
root of the node's share of the surface:

    N = multiplier - k g

The multiplier is the force that the converged increment before has left, so what an increment leaves of penetration is
what its change of force takes, and the next one gives it back. An increment that leaves more than PENETRATION of h
takes the multipliers over and iterates on. Several tools may touch one node, as at the edge of a die's cavity, which
constraints of a node would have to tell apart. Simo & Laursen 1992, Computers & Structures 42.

Faces of six nodes touch at the middles of their sides. These are the points of the rule of degree 2 for a triangle, so
nodal forces there are a quadrature of the contact pressure; the corners, which an even pressure does not load, follow
from the body.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from presswork import _core
from presswork.body.solids import Mechanics
from presswork.fields.instant import NodalContact
from presswork.geometry.mirrored import add_mirror_image
from presswork.geometry.pose import find_space_pose
from presswork.geometry.rounded_surface import RoundedSurface
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.space_contact import SpaceContact, SpaceForces, TouchingNodes, limit_friction
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.mesh.faces import nodal_normals, take_bearing
from presswork.model import FloatArray, Model, Tool, Triangulation, find_held_side
from presswork.state import State

PENETRATION = 1e-3
"""Of the root of a node's share of the surface: more than that takes another iteration."""
OF_SMALLEST = 0.5
"""Of the smallest cell: spacing of the lattice by which edges of tools are rounded where meshes change."""
WITHIN = 1e-3
"""Of that spacing: how far a tool that ends at a symmetry plane may end beside it."""
ROUNDING = 1e-4
"""Gap, over the same length, below which a node begins to touch."""


class SolidContact(SpaceContact):
    """The tools in space of a solid; what persists lies in the State."""

    def __init__(self, model: Model, cells: Mechanics) -> None:
        super().__init__(model, math.inf)
        self._cells = cells
        self._young = max(material.young for material in model.materials)
        self._needs_shear = any(t.friction.law in ("shear", "coulomb_capped") for t in model.space_tools)
        n = len(model.mesh.points)
        faces = model.mesh.boundary_faces
        outer = np.unique(take_bearing(faces))
        self._inside = np.ones(n, dtype=bool)
        self._inside[outer] = False
        self._length = np.ones(n)
        self._shear = np.zeros((len(model.space_tools), n))
        self._area = np.zeros((len(model.space_tools), n))
        self._multiplier = np.zeros((len(model.space_tools), n))

    def _make_surface(self, tool: Tool, depth: float) -> _core.ToolSurface | RoundedSurface:
        remeshing = self._model.remeshing
        if remeshing is None or remeshing.keeps_first or not isinstance(tool.surface, Triangulation):
            return super()._make_surface(tool, depth)
        spacing = OF_SMALLEST * remeshing.smallest_size
        start, middle = find_space_pose(tool, np.zeros(3)), self._model.mesh.points.mean(axis=0)
        shape = replace(tool.surface, points=start.carry(tool.surface.points))
        planes = []
        for axis in range(3):
            level = find_held_side(self._model, axis) if tool.mirrored_across[axis] else None
            if level is not None:
                inward = float(np.sign(middle[axis] - level))
                shape = add_mirror_image(shape, axis, level, inward, WITHIN * spacing)
                planes.append((axis, level, inward))

        def fold(points: FloatArray) -> FloatArray:
            """Return places in the tool's frame, those beyond a symmetry plane as their mirror image."""
            places = start.carry(points)
            for axis, level, inward in planes:
                places[:, axis] = level + inward * np.abs(places[:, axis] - level)
            return np.ascontiguousarray(start.to_frame(places))

        shape = replace(shape, points=np.ascontiguousarray(start.to_frame(shape.points)))
        return RoundedSurface(make_surface(shape, depth), spacing, fold)

    def begin_increment(self, state_n: State) -> None:
        """Take surface, shear flow stress and multipliers as they are when the increment begins."""
        places = self._model.mesh.points + state_n.nodes.moved
        faces = self._model.mesh.boundary_faces
        normals = nodal_normals(places, faces)
        self._length = np.where(self._inside, 1.0, np.sqrt(np.linalg.norm(normals, axis=1)))
        placed = state_n[SpaceToolArrays]
        self._multiplier = np.linalg.norm(placed.force - placed.friction, axis=2)
        flow = self._cells.nodal_flow_stress(state_n) / np.sqrt(3.0) if self._needs_shear else np.zeros(0)
        for t in range(len(self._surfaces)):
            gap, out = self.placed(t, placed).nearest(places, float(self._length.max()))
            # the part of the node's surface that faces the tool: at an edge the other side has no contact
            self._area[t] = np.maximum(0.0, -np.einsum("ni,ni->n", normals, out))
            if self._needs_shear:
                # a face slides on the tool where all its nodes that bear lie there, as in the plane
                lies = (self._multiplier[t] > 0.0) | (gap <= ROUNDING * self._length)
                covered = nodal_normals(places, faces[lies[take_bearing(faces)].all(axis=1)])
                self._shear[t] = flow * np.maximum(0.0, -np.einsum("ni,ni->n", covered, out))

    def touching(self, tool: int) -> TouchingNodes:
        """Return what the contact with a tool must know of the nodes; those inside the body touch nothing."""
        spring = self._young * self._length
        reach = np.where(self._inside, -np.inf, self._multiplier[tool] / spring)
        return TouchingNodes(spring, reach, ROUNDING * self._length, self._shear[tool])

    def settle(self, trial: State, found: SpaceForces) -> None:
        """Keep what an increment has found; what multipliers hold stores no energy."""
        super().settle(trial, replace(found, energy=0.0))

    def show(self, state: State) -> NodalContact:
        """Return the contact of a converged state: forces over the part of each node's surface that faces the tool."""
        self.begin_increment(state)
        placed = state[SpaceToolArrays]
        places = self._model.mesh.points + state.nodes.moved
        push = np.linalg.norm(placed.force - placed.friction, axis=2)
        drag = np.linalg.norm(placed.friction, axis=2)
        area = np.where(self._area > 0.0, self._area, np.inf)
        limits = np.array([
            np.where(push[t] > 0.0, limit_friction(tool.friction, push[t], self._shear[t])[0], 0.0)
            for t, tool in enumerate(self._model.space_tools)
        ])  # fmt: skip
        traction = {t.name: placed.force[i] / area[i, :, None] for i, t in enumerate(self._model.space_tools)}
        gap = self.find_gaps(state, places).min(axis=0)
        touches, rough = push.max(axis=0) > 0.0, drag.max(axis=0) > 0.0
        return NodalContact(
            gap=np.where(self._inside | np.isinf(gap), np.nan, gap),
            status=touches + (touches & rough & (drag < limits).any(axis=0)).astype(float),
            pressure=(push / area).sum(axis=0),
            shear=(drag / area).sum(axis=0),
            friction_limit=(limits / area).sum(axis=0),
            traction=traction,
            total_traction=np.sum(list(traction.values()), axis=0),
            force=placed.force.sum(axis=0),
        )

    def augment(self, own: SpaceForces) -> bool:
        """Take the multipliers over if nodes lie too deep in a tool, or too far off one that they push."""
        push = np.linalg.norm(own.by_tool - own.friction, axis=2)
        if not (np.abs(push - self._multiplier) > PENETRATION * self._young * self._length**2).any():
            return False
        self._multiplier = push
        return True
