# SPDX-License-Identifier: Apache-2.0
"""Contact of the nodes of a solid in space with rigid tools: a spring with augmented Lagrange, and friction.

A node's normal force is that of its multiplier and of a spring as stiff as the metal beneath it, k = E h with h the
root of the node's share of the surface:

    N = multiplier - k g

The multiplier is the force that the converged increment before has left, so what an increment leaves of penetration is
what its change of force takes, and the next one gives it back. An increment that leaves more than PENETRATION of h
takes the multipliers over and iterates on. Several tools may touch one node, as at the edge of a die's cavity, which
constraints of a node would have to distinguish. Simo & Laursen 1992, Computers & Structures 42.

Faces of six nodes touch at the middles of their sides. These are the points of the rule of degree 2 for a triangle, so
nodal forces there are a quadrature of the contact pressure; the corners, which an even pressure does not load, follow
from the body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswork import _core
from presswork.body.contract import Look, Near
from presswork.body.solids import Mechanics
from presswork.fields.instant import NodalContact
from presswork.geometry.mirrored import WITHIN, complete_tool, find_mirrors
from presswork.geometry.pose import find_space_pose
from presswork.geometry.rounded_surface import RoundedSurface
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.space.floating_space_tools import FloatingSpaceTools
from presswork.interaction.space.resting import SOFT, RestingBody, find_loose
from presswork.interaction.space.space_contact import SpaceContact, SpaceForces, Touched
from presswork.interaction.space.space_touch import STEEPEST, TouchingNodes
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.law.friction import BY_FLOW_STRESS, SMOOTH
from presswork.mesh.faces import face_areas, nodal_normals, press_faces, take_bearing
from presswork.model import FloatArray, IndexArray, IntArray, Model, Tool, Triangulation
from presswork.state import State

GUESSES = 8
"""Guesses of an increment after which the area that shears stays."""
RENEWALS, STALE = 3, 0.05
"""Number of times in an increment that equilibrium is found anew with the present area, and the difference in area,
over a node's share of the surface, that requires it."""
PENETRATION = 1e-3
"""Penetration over the root of a node's share of the surface above which another iteration follows."""
SUDDEN, COARSE = 0.2, 1e-4
"""Change of the nodes' forces in an increment, over all of them, beyond which so much of that length takes another
iteration: where a blow begins, the force rises as steeply as the springs give."""
OF_SMALLEST = 0.5
"""Spacing of the lattice by which edges of tools are rounded where meshes change, over the smallest cell."""
FOLDED = 0.4
"""Resultant of the faces round a node over their area, below which they turn away from each other as at the root of a
fold, and its springs hang on all of that area: three faces of a cube's corner have 0.58."""
AT_LIMIT = 1e-9
"""Part of its limit by which friction may be less and yet count as at it."""
ROUNDING = 1e-4
"""Gap, over the same length, below which a node begins to touch."""

FACING = 0.05
"""Part of a node's surface that counts as facing a tool at least, where it lands sideways."""
CONSTANT_SHEAR = ("shear", "coulomb_capped")
"""Laws of friction whose limit jumps where a node lands."""


class SolidContact(SpaceContact):
    """The tools in space of a solid; what persists lies in the State."""

    def __init__(self, model: Model, cells: Mechanics, before: SpaceContact | None = None) -> None:
        super().__init__(model, cells, math.inf, before)
        self._solids = cells
        self._young = max(material.young for material in model.materials)
        self._needs_shear = any(t.friction.law in BY_FLOW_STRESS for t in model.space_tools)
        n = len(model.mesh.points)
        faces = model.mesh.boundary_faces
        outer = np.unique(take_bearing(faces))
        self._inside = np.ones(n, dtype=bool)
        self._inside[outer] = False
        self._length, self._surface = np.ones(n), np.zeros((n, 3))
        self._sticking = [t for t, tool in enumerate(model.space_tools) if tool.friction.law == "sticking"]
        self._shear_flow, self._n_guesses, self._n_renewals = np.zeros(n), 0, 0
        self._latest: tuple[FloatArray, Sequence[Touched]] = (np.zeros((n, 3)), [])
        self._covered = (np.zeros((0, 3), dtype=np.int32), np.zeros(0))
        self._lay = np.zeros((len(model.space_tools), n), dtype=bool)
        self._multiplier = np.zeros((len(model.space_tools), n))
        rests = find_loose(model) and not model.solver.inertia and not FloatingSpaceTools(model).is_needed
        self._resting = RestingBody(len(model.space_tools), n) if rests else None

    def _make_surface(self, tool: Tool, depth: float) -> _core.ToolSurface | RoundedSurface:
        remeshing = self._model.remeshing
        if remeshing is None or remeshing.keeps_first or not isinstance(tool.surface, Triangulation):
            return super()._make_surface(tool, depth)
        spacing = OF_SMALLEST * remeshing.smallest_size
        start, mirrors = find_space_pose(tool, np.zeros(3)), find_mirrors(tool, self._model)
        shape = complete_tool(tool, mirrors, WITHIN * remeshing.smallest_size)

        def fold(points: FloatArray) -> FloatArray:
            """Return places in the tool's frame, those beyond a symmetry plane as their mirror image."""
            places = start.carry(points)
            for axis, level, inward in mirrors:
                places[:, axis] = level + inward * np.abs(places[:, axis] - level)
            return np.ascontiguousarray(start.to_frame(places))

        return RoundedSurface(make_surface(shape, depth), spacing, fold)

    def _look(self, looks: Sequence[Look], x: FloatArray) -> list[Near]:
        return self._solids.look_near(looks, x)

    def begin_increment(self, state_n: State) -> None:
        """Take surface, shear flow stress and multipliers as they are when the increment begins."""
        super().begin_increment(state_n)
        places = self._model.mesh.points + state_n.nodes.moved
        faces = self._model.mesh.boundary_faces
        self._surface = nodal_normals(places, faces)
        resultant = np.linalg.norm(self._surface, axis=1)
        whole = np.bincount(faces.ravel(), face_areas(places, faces).ravel(), minlength=len(places))
        area = np.where(resultant < FOLDED * whole, whole, resultant)
        self._length = np.where(self._inside, 1.0, np.sqrt(area))
        placed = state_n[SpaceToolArrays]
        self._multiplier = np.linalg.norm(placed.force - placed.friction, axis=2)
        for t in range(len(self._surfaces)) if self._resting is not None else self._sticking:
            surface = self.placed(t, placed)
            gap, out = self._look([(surface.nearest, float(self._length.max()))], places)[0]
            self._lay[t] = (self._multiplier[t] > 0.0) | (gap <= ROUNDING * self._length)
            if self._resting is not None:
                far = not np.isfinite(gap[~self._inside]).any()
                seen, along = self._look([(surface.nearest, math.inf)], places)[0] if far else (gap, out)
                self._resting.take(t, np.where(self._inside, np.inf, seen), along, self._length)
        if self._needs_shear:
            self._shear_flow, self._n_guesses = self._solids.nodal_flow_stress(state_n) / np.sqrt(3.0), 0
            self._n_renewals = 0

    def limit_by_shear(self, x: FloatArray, touched: Sequence[Touched]) -> Sequence[FloatArray | None]:
        """Return the largest friction on nodes of each tool whatever the push (n,) [N]; None: no law asks for it.

        As in the plane, the area at a guess is that of the faces all of whose nodes that bear touch a tool, and a node
        that lands on a sticking tool sticks from the next increment on. Where a node is pressed on by less than a part
        of its shear, its faces count in proportion: area that jumped with a node that hardly touches would never
        converge. After some guesses the faces and their parts stay, so that an iteration converges on them; in
        equilibrium they are looked at again (augment). Laws that rise smoothly from none take all of the surface that
        faces the tool at the start of the increment.
        """
        found: list[FloatArray | None] = [None] * len(touched)
        if self._needs_shear:
            self._latest = x, touched
            if self._n_guesses < GUESSES:
                self._covered = self._cover(x, touched)
            self._n_guesses += 1
            covered = nodal_normals(x, *self._covered)
            for t, (nodes, out, _) in enumerate(touched):
                area = _project(covered[nodes], out)
                if self._model.space_tools[t].friction.law in SMOOTH:
                    area = self._find_facing(nodes, out)
                found[t] = self._shear_flow[nodes] * area
        for t in self._sticking:
            found[t] = np.where(self._lay[t, touched[t][0]], np.inf, 0.0)
        return found

    def _find_area(self, t: int, touched: Touched, shear: FloatArray | None) -> FloatArray:
        """Return the area over which each node is pressed: what is covered where it jumps as a node lands."""
        nodes, out, _ = touched
        if shear is not None and self._model.space_tools[t].friction.law in CONSTANT_SHEAR:
            return shear / np.maximum(self._shear_flow[nodes], 1e-300)
        return self._find_facing(nodes, out)

    def _find_facing(self, nodes: IndexArray, out: FloatArray) -> FloatArray:
        """Return how much of the surface of nodes (n,) faces tools of these normals (n, 3) as an increment begins."""
        return np.maximum(_project(self._surface[nodes], out), FACING * self._length[nodes] ** 2)

    def _cover(self, x: FloatArray, touched: Sequence[Touched]) -> tuple[IntArray, FloatArray]:
        """Return the faces that lie on tools at a guess (n, k), and the part of each that counts (n,)."""
        faces = self._model.mesh.boundary_faces
        lies, part = np.zeros(len(x), dtype=bool), np.zeros(len(x))
        lies[np.concatenate([nodes for nodes, _, _ in touched])] = True
        faces = faces[lies[take_bearing(faces)].all(axis=1)]
        covered = nodal_normals(x, faces)
        for tool, (nodes, out, push) in zip(self._model.space_tools, touched, strict=True):
            constant = float(tool.friction.m) if tool.friction.law in CONSTANT_SHEAR else 0.0
            shear = constant * self._shear_flow[nodes] * _project(covered[nodes], out)
            part[nodes] = np.maximum(part[nodes], np.minimum(1.0, STEEPEST * push / np.maximum(shear, 1e-300)))
        return faces, part[take_bearing(faces)].min(axis=1)

    def touching(self, tool: int) -> TouchingNodes:
        """Return what the contact with a tool must know of the nodes; those inside the body touch nothing."""
        spring = self._young * self._length
        reach = np.where(self._inside, -np.inf, self._multiplier[tool] / spring)
        return TouchingNodes(spring, reach, ROUNDING * self._length, self._length**2)

    def evaluate(
        self, state_n: State, trial: State, displacement: FloatArray, stage: int = 0, fraction: float = 0.0
    ) -> SpaceForces:
        """Return the forces on the nodes at a guess; those of a body that rests on tools hang on them softly."""
        found = super().evaluate(state_n, trial, displacement, stage, fraction)
        if self._resting is None:
            return found
        moved = trial[SpaceToolArrays].displacement - state_n[SpaceToolArrays].displacement
        tool, nodes = np.nonzero(self._resting.find_holds(moved))
        if not len(nodes):
            return found
        spring = SOFT * self._young * self._length[nodes]
        slip = (displacement - state_n.nodes.displacement)[nodes, :3] - moved[tool]
        np.add.at(found.force[:, :3], nodes, -spring[:, None] * slip)
        blocks = np.zeros((len(nodes), *found.blocks.shape[1:]))
        blocks[:, :3, :3] = spring[:, None, None] * np.eye(3)
        return replace(
            found,
            pairs=np.concatenate([found.pairs, np.repeat(nodes[:, None], 2, axis=1).astype(np.int32)]),
            blocks=np.concatenate([found.blocks, blocks]),
            tool=np.concatenate([found.tool, np.full(len(nodes), -1, dtype=np.int32)]),
        )

    def end_increment(self, trial: State, found: SpaceForces) -> None:
        """Keep what an increment has found; what multipliers hold stores no energy."""
        super().end_increment(trial, replace(found, energy=0.0))

    def show(self, state: State) -> NodalContact:
        """Return the contact of a converged state: forces over the part of each node's surface that faces the tool."""
        self.begin_increment(state)
        placed = state[SpaceToolArrays]
        places = self._model.mesh.points + state.nodes.moved
        push = np.linalg.norm(placed.force - placed.friction, axis=2)
        drag = np.linalg.norm(placed.friction, axis=2)
        normals = nodal_normals(places, self._model.mesh.boundary_faces)
        area, limits, touched = np.full(push.shape, np.inf), np.zeros(push.shape), []
        for t, own in enumerate(push > 0.0):
            nodes = np.flatnonzero(own)
            out = self.placed(t, placed).nearest(places, float(self._length.max()))[1][nodes]
            touched.append((nodes, out, push[t, nodes]))
            # the part of the node's surface that faces the tool: at an edge the other side has no contact
            faced = _project(normals[nodes], out)
            area[t, nodes] = np.where(faced > 0.0, faced, np.inf)
        for t, shear in enumerate(self.limit_by_shear(places, touched)):
            nodes = touched[t][0]
            limits[t, nodes] = self.friction_on(t, touched[t], shear).limit(push[t, nodes])[0]
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
        """Take the multipliers over if nodes lie too deep in a tool, or too far off one that they push.

        Metal that answers elastically is as stiff as the springs, and would take ten rounds of that; the next increment
        gives back what is left. Iterate on, too, where the area that shears is no longer that of the faces that touch.
        """
        renewed = self._renew_cover()
        if self._solids.answers_elastically:
            return renewed
        push = np.linalg.norm(own.by_tool - own.friction, axis=2)
        change = np.abs(push - self._multiplier)
        allowed = COARSE if change.sum() > SUDDEN * push.sum() else PENETRATION
        if not (change > allowed * self._young * self._length**2).any():
            return renewed
        self._multiplier = push
        return True

    def take_over(self, own: SpaceForces) -> None:
        """Take the multipliers over."""
        self._multiplier = np.linalg.norm(own.by_tool - own.friction, axis=2)

    def find_area_blocks(self, x: FloatArray, own: SpaceForces) -> tuple[IntArray, FloatArray]:
        """Return how friction at the limit of constant shear depends on the areas of faces (space_contact.py)."""
        faces, part = self._covered
        if not self._needs_shear or not len(faces):
            return super().find_area_blocks(x, own)
        by_place = press_faces(x, faces, 1.0)[1]  # of area vectors, by the places of nodes
        covered, blocks = nodal_normals(x, faces, part), np.zeros_like(by_place)
        pairs_of = zip(self._model.space_tools, own.by_tool, own.friction, strict=True)
        for t, (tool, by_tool, friction) in enumerate(pairs_of):
            if tool.friction.law not in CONSTANT_SHEAR:
                continue
            push, size = (np.linalg.norm(f, axis=1, keepdims=True) for f in (by_tool - friction, friction))
            out, along = (f / np.maximum(s, 1e-300) for f, s in ((by_tool - friction, push), (friction, size)))
            factor = 1.0 if self._factor is None else self._factor[t, :, None]
            shear = factor * float(tool.friction.m) * self._shear_flow[:, None]
            limit = shear * _project(covered, out)[:, None]
            along = np.where((size > 0.0) & (size >= (1.0 - AT_LIMIT) * limit), along, 0.0)
            by_area = np.einsum("fai,fabij->fabj", (shear * out)[faces], by_place)
            blocks += part[:, None, None, None, None] * along[faces][:, :, None, :, None] * by_area[:, :, :, None, :]
        nodes = np.broadcast_to(faces[:, :, None], blocks.shape[:3])
        pairs = np.stack([nodes, np.swapaxes(nodes, 1, 2)], axis=-1).reshape(-1, 2)
        acts = blocks.any(axis=(3, 4)).ravel()
        return np.ascontiguousarray(pairs[acts]), np.ascontiguousarray(blocks.reshape(-1, 3, 3)[acts])

    def touch_like(self, other: SpaceContact) -> None:
        """Let nodes stick that stick in another run, and the faces shear whose area it has found."""
        assert isinstance(other, SolidContact)
        self._lay, stays = other._lay, other._n_guesses >= GUESSES
        self._n_guesses = GUESSES if stays else 0
        if stays:
            self._covered = other._covered

    def _renew_cover(self) -> bool:
        """Take the area that shears in equilibrium, if the present one is out of date; return whether it was."""
        if self._n_guesses <= GUESSES or self._n_renewals == RENEWALS:
            return False
        places, touched = self._latest
        now = self._cover(places, touched)
        change = nodal_normals(places, *now) - nodal_normals(places, *self._covered)
        if not (np.linalg.norm(change, axis=1) > STALE * self._length**2).any():
            return False
        self._covered, self._n_renewals = now, self._n_renewals + 1
        return True


def _project(area: FloatArray, out: FloatArray) -> FloatArray:
    """Return the part of area vectors (n, 3) that faces tools of normals (n, 3) (n,) [mm2]."""
    return np.asarray(np.maximum(0.0, -np.einsum("ni,ni->n", area, out)))
