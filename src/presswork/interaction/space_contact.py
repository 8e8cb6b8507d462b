# SPDX-License-Identifier: Apache-2.0
"""Contact of nodes with rigid tools in space, and friction, with the consistent tangent: what sheets and solids share.

A node touches where the gap between it and the tool is less than its reach: half the thickness of a sheet; at a solid
what its multiplier stands for. With g the gap less the reach, a spring k pushes it out, N = -k g, rounded off over a
small gap so that the derivative has no jump.

Friction is a return mapping over the increment, as in friction.py: T = P (T_n - k_t d), P the tangent plane at the
node's present place and d its way along the tool, shortened to what the law allows. The tangent holds all derivatives:
of N, of the direction of sliding, and of the normal by the curvature of the tool; it is not symmetric.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.body.contract import Look, Near
from presswork.geometry.pose import SpacePose, find_axis, find_space_pose, turn_about
from presswork.geometry.rounded_surface import RoundedSurface
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.contract import Forces
from presswork.interaction.coulomb import return_to_limit
from presswork.interaction.drawbeads import BeadForces
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import FloatArray, Friction, IndexArray, IntArray, Model, Tool
from presswork.state import Arrays, State

TANGENTIAL = 0.1
"""Of the spring that a sticking node hangs on, over the contact's."""
STEEPEST = 5.0
"""Of a node's friction over its normal force, where the law asks for more: a node that hardly touches is not held."""


@dataclass(frozen=True)
class NodesOnTool:
    """What one tool does to the nodes that it touches."""

    nodes: IndexArray
    force: FloatArray
    """On the node (n, 3) [N]."""
    friction: FloatArray
    """The part of it along the tool (n, 3) [N]."""
    stiffness: FloatArray
    """d(-force)/dx (n, 3, 3) [N/mm]."""
    energy: float
    """Stored by the normal forces [N mm]."""


@dataclass(frozen=True)
class TouchingNodes:
    """What contact must know of the nodes."""

    spring: FloatArray
    """That pushes a node out of a tool (n_points,) [N/mm]."""
    reach: FloatArray
    """Distance from the tool below which it pushes (n_points,) [mm]."""
    rounding: FloatArray
    """Distance over which that begins (n_points,) [mm]."""

    @property
    def farthest(self) -> float:
        """Distance from the tool beyond which no node touches [mm]."""
        return float((self.reach + self.rounding).max())

    def gap_at(self, push: FloatArray) -> FloatArray:
        """Return the gap beyond the reach at which a node is pushed with so much [N] (n_points,) [mm]."""
        return gap_at(push, self.spring, self.rounding)


def push_at(gap: FloatArray, spring: FloatArray, rounding: FloatArray) -> FloatArray:
    """Return the push (n,) [N] at gaps beyond the reach (n,) [mm]: a parabola within the rounding."""
    return np.where(gap < -rounding, -spring * gap, spring * (rounding - gap) ** 2 / (4.0 * rounding))


def gap_at(push: FloatArray, spring: FloatArray, rounding: FloatArray) -> FloatArray:
    """Return the gap beyond the reach (n,) [mm] at which the push is so much (n,) [N]."""
    parabola = rounding - np.sqrt(4.0 * rounding * np.maximum(push, 0.0) / spring)
    return np.where(push > spring * rounding, -push / spring, parabola)


@dataclass(frozen=True)
class TouchedNodes:
    """Nodes that touch a tool, or are about to."""

    nodes: IndexArray
    gap: FloatArray
    """Beyond their reach (n,) [mm]."""
    normal: FloatArray
    """Of the tool (n, 3)."""
    spring: FloatArray
    """As in TouchingNodes (n,) [N/mm]."""
    rounding: FloatArray
    """The same (n,) [mm]."""
    law_gap: FloatArray
    """Gap beyond their reach where the tangent of the law is taken (n,) [mm]; `gap` itself: the law."""

    @property
    def slope(self) -> FloatArray:
        """Derivative of the push by the gap (n,) [N/mm]."""
        k, delta = self.spring, self.rounding
        return np.where(self.law_gap < -delta, -k, -0.5 * k * (delta - self.law_gap) / delta)

    @property
    def push(self) -> FloatArray:
        """Of the tool on the nodes (n,) [N], by the tangent of the law at law_gap."""
        return push_at(self.law_gap, self.spring, self.rounding) + self.slope * (self.gap - self.law_gap)


@dataclass(frozen=True)
class PlacedSurface:
    """A tool's surface where it stands; answers as _core.ToolSurface does, in space."""

    surface: _core.ToolSurface | RoundedSurface
    pose: SpacePose

    def nearest(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the gap of points (n, 3) closer than reach [mm], infinite of others, and the normal there (n, 3)."""
        gap, normal, _, _ = self.surface.nearest(np.ascontiguousarray(self.pose.to_frame(points)), reach)
        return gap, self.pose.turn(normal)

    def slopes(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the derivatives of gap (n, 3) and normal (n, 3, 3) to points [1/mm]."""
        rise, bend = self.surface.slopes(np.ascontiguousarray(self.pose.to_frame(points)))
        turned = self.pose.turned
        return self.pose.turn(rise), bend if turned is None else turned @ bend @ turned.T


def find_touched(
    surface: PlacedSurface, touching: TouchingNodes, x: FloatArray, before: FloatArray | None = None
) -> TouchedNodes:
    """Return the nodes at x (n_points, 3) [mm] that touch a tool; before: as of choose_touched."""
    return choose_touched(surface.nearest(x, touching.farthest), touching, before)


def choose_touched(near: Near, touching: TouchingNodes, before: FloatArray | None = None) -> TouchedNodes:
    """Return the nodes that touch a tool. near: of all nodes, found within touching.farthest.

    before: law_gap of all nodes before a correction, infinite of those that did not touch (n_points,) [mm]. The law's
    tangent is then taken where the push is what the correction has asked for, and nodes that it has asked to pull are
    let go. At the nodes' own gap Newton's method would only halve what is left of a parabola, again and again.
    """
    gap, normal = near
    nodes = np.flatnonzero(gap - touching.reach < touching.rounding)
    k, delta, beyond = touching.spring[nodes], touching.rounding[nodes], (gap - touching.reach)[nodes]
    law_gap = beyond
    if before is not None:
        touched = np.isfinite(before[nodes])
        last = np.where(touched, before[nodes], 0.0)
        asked = TouchedNodes(nodes, beyond, normal[nodes], k, delta, last).push
        law_gap = np.where(touched, np.maximum(gap_at(asked, k, delta), beyond), beyond)
        kept = ~touched | (asked > 0.0)
        nodes, k, delta, beyond, law_gap = nodes[kept], k[kept], delta[kept], beyond[kept], law_gap[kept]
    return TouchedNodes(nodes, beyond, normal[nodes], k, delta, law_gap)


def touch_tool(
    surface: PlacedSurface,
    law: Friction,
    touched: TouchedNodes,
    x: FloatArray,
    way: FloatArray,
    friction_n: FloatArray,
    shear: FloatArray | None = None,
) -> NodesOnTool:
    """Return the forces of a tool on the nodes that touch it.

    x: places of all nodes (n_points, 3) [mm]. way: of the nodes along with the increment, less that of the tool
    (n_points, 3) [mm]. friction_n: their friction when the increment began, turned with the tool (n_points, 3) [N].
    shear: largest friction on those touched whatever the push (n,) [N], which laws with a friction factor ask for.
    """
    nodes, g, n, k, delta = touched.nodes, touched.gap, touched.normal, touched.spring, touched.rounding
    rise, bend = surface.slopes(x[nodes])
    # 1. normal force
    deep = g < -delta
    push, slope = touched.push, touched.slope
    rounded = k * (delta - np.maximum(g, -delta)) ** 3 / (12.0 * delta)
    energy = float((rounded + np.where(deep, 0.5 * k * (g**2 - delta**2), 0.0)).sum())
    force = push[:, None] * n
    stiffness = -_dyads(slope[:, None] * n, rise) - push[:, None, None] * bend
    if is_frictionless(law):
        return NodesOnTool(nodes, force, np.zeros_like(force), stiffness, energy)
    # 2. friction: elastic trial in the tangent plane
    hanging = TANGENTIAL * k
    pulled = friction_n[nodes] - hanging[:, None] * way[nodes]
    out = np.einsum("ni,ni->n", n, pulled)
    trial = pulled - out[:, None] * n
    plane = np.eye(3) - _dyads(n, n)
    d_trial = (
        -hanging[:, None, None] * plane - _dyads(n, np.einsum("nij,nj->ni", bend, pulled)) - out[:, None, None] * bend
    )
    # 3. shortened to what the law allows where it slides
    limit, by_push = limit_friction(law, push, shear)
    returned = return_to_limit(trial, limit)
    slides, along, friction = returned.slides, returned.along, returned.force
    d_slide = _dyads(along, (by_push * slope)[:, None] * rise)
    d_slide += np.where(slides, limit / returned.size, 0.0)[:, None, None] * (
        (np.eye(3) - _dyads(along, along)) @ d_trial
    )
    stiffness -= np.where(slides[:, None, None], d_slide, d_trial)
    return NodesOnTool(nodes, force + friction, friction, stiffness, energy)


def is_frictionless(law: Friction) -> bool:
    """Return whether a tool lets nodes slide freely."""
    if law.law == "coulomb":
        return float(law.mu) == 0.0
    return law.law == "frictionless" or (law.law == "shear" and float(law.m) == 0.0)


def limit_friction(law: Friction, push: FloatArray, shear: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Return the largest friction (n,) [N] at normal forces `push` (n,) [N], and its derivative by these."""
    if law.law == "sticking":
        return np.full_like(push, math.inf) if shear is None else shear, np.zeros_like(push)
    if law.law == "frictionless":
        return np.zeros_like(push), np.zeros_like(push)
    steep = float(law.mu) if law.law in ("coulomb", "coulomb_capped") else STEEPEST
    limit, by_push = steep * push, np.full_like(push, steep)
    if law.law == "coulomb":
        return limit, by_push
    assert shear is not None, "the law needs the shear flow stress"
    most = float(law.m) * shear
    if law.law == "shear":  # the symmetric part of a derivative by so steep a law would be indefinite
        return np.minimum(limit, most), np.zeros_like(push)
    return np.minimum(limit, most), np.where(limit < most, by_push, 0.0)


@dataclass(frozen=True)
class SpaceForces(Forces):
    """Of all tools and beads on the nodes."""

    by_tool: FloatArray
    """(n_tools, n_points, 3) [N]."""
    friction: FloatArray
    """The part of it along the tool, in the same form."""
    tool: IntArray
    """Which tool each block is of (n,); -1: of a bead."""
    energy: float
    """Stored by the normal forces [N mm]."""
    law_gap: FloatArray
    """Where the tangent of the law was taken, infinite of nodes that do not touch (n_tools, n_points) [mm]."""
    beads: BeadForces | None = None
    """Of a sheet."""


class SpaceContact:
    """The tools in space of one run; what persists lies in the State."""

    def __init__(self, model: Model, depth: float, before: SpaceContact | None = None) -> None:
        """Take the tools of a model.

        depth: that a node of a guess may lie in a tool and be found [mm]. before: the same tools of the run on the mesh
        before, whose surfaces are taken over.
        """
        self._model = model
        self._surfaces: list[_core.ToolSurface | RoundedSurface] = (
            before._surfaces if before else [self._make_surface(tool, depth) for tool in model.space_tools]
        )
        self._law_gap: FloatArray | None = None

    def _make_surface(self, tool: Tool, depth: float) -> _core.ToolSurface | RoundedSurface:
        return make_surface(tool.surface, depth, smooth=True)

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of tools that have not moved and touch nothing."""
        return (SpaceToolArrays.at_rest(len(self._model.space_tools), len(self._model.mesh.points)),)

    def placed(self, t: int, arrays: SpaceToolArrays) -> PlacedSurface:
        """Return the surface of a tool where it stands."""
        pose = find_space_pose(self._model.space_tools[t], arrays.displacement[t], float(arrays.angle[t]))
        return PlacedSurface(self._surfaces[t], pose)

    def ways(self, state_n: State, trial: State, displacement: FloatArray) -> Iterator[FloatArray]:
        """Yield the way of the nodes along each tool in an increment (n_points, 3) [mm].

        displacement: of the nodes at a guess (n_points, freedoms); the tools stand where the trial state has them.
        """
        now, before = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        moved = displacement[:, :3] - state_n.nodes.displacement[:, :3]
        for t in range(len(self._model.space_tools)):
            if now.angle[t] == before.angle[t]:
                yield moved - (now.displacement[t] - before.displacement[t])
                continue
            x_n = self._model.mesh.points + state_n.nodes.displacement[:, :3]
            carried = self.placed(t, now).pose.carry(self.placed(t, before).pose.to_frame(x_n))
            yield x_n + moved - carried

    def turned_friction(self, state_n: State, trial: State) -> FloatArray:
        """Return the friction with which an increment begins, turned with the tools (n_tools, n_points, 3) [N]."""
        now, before = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        friction = before.friction
        for t in np.flatnonzero(now.angle != before.angle):
            turn = turn_about((now.angle[t] - before.angle[t]) * find_axis(self._model.space_tools[t]))
            friction = friction.copy() if friction is before.friction else friction
            friction[t] = friction[t] @ turn.T
        return friction

    def begin_increment(self, state_n: State) -> None:
        """Take what belongs to the nodes as it is when the increment begins."""

    def touching(self, tool: int) -> TouchingNodes:
        """Return what the contact with a tool must know of the nodes."""
        raise NotImplementedError

    def _look(self, looks: Sequence[Look], x: FloatArray) -> list[Near]:
        """Return what each look finds of the nodes at x (n_points, 3) [mm]."""
        return [nearest(x, reach) for nearest, reach in looks]

    def limit_by_shear(
        self, x: FloatArray, touched: Sequence[tuple[IndexArray, FloatArray, FloatArray]]
    ) -> Sequence[FloatArray | None]:
        """Return the largest friction on nodes of each tool whatever the push (n,) [N]; None: no law asks for it.

        Shear flow stress times area; on a sticking tool infinite for nodes that stick, 0 for those that land.
        x: places of all nodes (n_points, 3) [mm]. touched: of each tool the nodes that touch it (n,), its normals there
        (n, 3) and its push on them (n,) [N].
        """
        return [None] * len(touched)

    def touch_all(self, state_n: State, trial: State, displacement: FloatArray) -> SpaceForces:
        """Return the forces of the tools at a guess; they stand where the trial state has them."""
        placed = trial[SpaceToolArrays]
        n, freedoms = displacement.shape
        tools = self._model.space_tools
        x = self._model.mesh.points + displacement[:, :3]
        friction_n = self.turned_friction(state_n, trial)
        by_tool, friction = np.zeros((len(tools), n, 3)), np.zeros((len(tools), n, 3))
        nodes, blocks, owners, energy = [], [], [], 0.0
        surfaces = [self.placed(t, placed) for t in range(len(tools))]
        before, self._law_gap = self._law_gap, None
        touching = [self.touching(t) for t in range(len(tools))]
        seen = self._look([(own.nearest, of.farthest) for own, of in zip(surfaces, touching, strict=True)], x)
        touched = [
            choose_touched(near, touching[t], None if before is None else before[t]) for t, near in enumerate(seen)
        ]
        law_gap = np.full((len(tools), n), np.inf)
        shear = self.limit_by_shear(x, [(own.nodes, own.normal, own.push) for own in touched])
        for t, (tool, way) in enumerate(zip(tools, self.ways(state_n, trial, displacement), strict=True)):
            found = touch_tool(surfaces[t], tool.friction, touched[t], x, way, friction_n[t], shear[t])
            by_tool[t, found.nodes], friction[t, found.nodes] = found.force, found.friction
            law_gap[t, found.nodes] = touched[t].law_gap
            block = np.zeros((len(found.nodes), freedoms, freedoms))
            block[:, :3, :3] = found.stiffness
            energy += found.energy
            nodes.append(found.nodes)
            blocks.append(block)
            owners.append(np.full(len(found.nodes), t, dtype=np.int32))
        force = np.zeros((n, freedoms))
        force[:, :3] = by_tool.sum(axis=0)
        pairs = [np.repeat(own[:, None], 2, axis=1).astype(np.int32) for own in nodes]
        return SpaceForces(
            force,
            np.concatenate(pairs) if pairs else np.zeros((0, 2), dtype=np.int32),
            np.concatenate(blocks) if blocks else np.zeros((0, freedoms, freedoms)),
            by_tool,
            friction,
            np.concatenate(owners) if owners else np.zeros(0, dtype=np.int32),
            energy,
            law_gap,
        )

    def evaluate(
        self, state_n: State, trial: State, displacement: FloatArray, stage: int = 0, fraction: float = 0.0
    ) -> SpaceForces:
        """Return the forces on the nodes at a guess, at a fraction of a stage."""
        return self.touch_all(state_n, trial, displacement)

    def predict(self, found: SpaceForces) -> None:
        """Take note of a correction from a guess that is about to be evaluated."""

    def count_unsettled(self, trial: State, found: SpaceForces, displacement: FloatArray, pull: float) -> int:
        """Return how many nodes the tangent of the law pushes otherwise than the law, by more than `pull` [N]."""
        return 0

    def augment(self, own: SpaceForces) -> bool:
        """Take multipliers over in equilibrium if they are not good enough yet."""
        return False

    def find_area_blocks(self, x: FloatArray, own: SpaceForces) -> tuple[IntArray, FloatArray]:
        """Return how the friction that was found depends on areas of faces: pairs (n, 2), blocks (n, 3, 3) [N/mm]."""
        return np.zeros((0, 2), dtype=np.int32), np.zeros((0, 3, 3))

    def take_over(self, own: SpaceForces) -> None:
        """Take the multipliers over, if there are any."""

    def touch_like(self, other: SpaceContact) -> None:
        """Take over from another run of nearly the same model what it has decided of nodes and faces."""

    def settle(self, trial: State, found: SpaceForces) -> None:
        """Keep what an increment has found."""
        kept = trial[SpaceToolArrays]
        kept.force, kept.friction, kept.energy = found.by_tool, found.friction, found.energy

    def touched(self, state: State) -> FloatArray:
        """Return the forces of the tools on the nodes where they stand in a state (n_tools, n_points, 3) [N]."""
        self.begin_increment(state)
        return self.evaluate(state, state, state.nodes.displacement).by_tool

    def held_directions(self, state: State, ways: Mapping[int, FloatArray]) -> tuple[IndexArray, FloatArray]:
        """Return nodes (n,) and vectors (n, 3) along which tools hold them; rough tools in all three.

        ways: directions (3,) of tools that forces push, by their numbers, along which these hold nothing.
        """
        nodes, directions = [np.zeros(0, dtype=np.intp)], [np.zeros((0, 3))]
        for t, (tool, force) in enumerate(zip(self._model.space_tools, self.touched(state), strict=True)):
            touched = np.flatnonzero(np.linalg.norm(force, axis=1) > 0.0)
            along = force[touched] / np.linalg.norm(force[touched], axis=1)[:, None]
            if not is_frictionless(tool.friction):
                touched, along = np.repeat(touched, 3), np.tile(np.eye(3), (len(touched), 1))
            if t in ways:
                along = along - (along @ ways[t])[:, None] * ways[t]
            nodes.append(touched)
            directions.append(along)
        return np.concatenate(nodes), np.concatenate(directions)

    def work(self, state_n: State, trial: State) -> tuple[float, float]:
        """Return the work of the tools in an increment, by their own motion, and what friction takes [N mm]."""
        placed, placed_n = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        lost = -float(
            (0.5 * (self.turned_friction(state_n, trial) + placed.friction) * self._slips(state_n, trial)).sum()
        )
        moved = placed.displacement - placed_n.displacement
        turns = placed.angle - placed_n.angle
        forces = (placed_n.force + placed.force).sum(axis=1)
        torques = turns * 0.5 * (self.torques(state_n) + self.torques(trial)) if turns.any() else np.zeros(0)
        return 0.5 * float((forces * moved).sum()) - float(torques.sum()), lost

    def _slips(self, state_n: State, trial: State) -> FloatArray:
        """Return the way of the nodes along each tool in a converged increment (n_tools, n_points, 3) [mm]."""
        now, before = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        if (now.angle != before.angle).any():
            return np.array(list(self.ways(state_n, trial, trial.nodes.displacement)))
        return trial.nodes.increment[None, :, :3] - (now.displacement - before.displacement)[:, None]

    def lost_at(self, state_n: State, trial: State) -> FloatArray:
        """Return the work that friction has taken at the nodes in an increment (n_tools, n_points) [N mm]."""
        mean = 0.5 * (self.turned_friction(state_n, trial) + trial[SpaceToolArrays].friction)
        return np.asarray(-(mean * self._slips(state_n, trial)).sum(axis=2))

    def torques(self, state: State) -> FloatArray:
        """Return the torque of the workpiece on each tool about its axis (n_tools,) [N mm], as modelled."""
        placed, x = state[SpaceToolArrays], self._model.mesh.points + state.nodes.displacement[:, :3]
        found = np.zeros(len(self._model.space_tools))
        for t, tool in enumerate(self._model.space_tools):
            pose = find_space_pose(tool, placed.displacement[t], float(placed.angle[t]))
            centre = pose.carry(np.array((*tool.centre, 0.0)[:3])[None])
            found[t] = -float(np.cross(x - centre, placed.force[t]).sum(axis=0) @ find_axis(tool))
        return found

    def find_gaps(self, state: State, places: FloatArray) -> FloatArray:
        """Return how far places (n, 3) [mm] lie off each tool (n_tools, n) [mm]; infinity outside of it."""
        placed = state[SpaceToolArrays]
        gaps = [self.placed(t, placed).nearest(places, 0.0)[0] for t in range(len(self._surfaces))]
        return np.array(gaps).reshape(-1, len(places))

    def tool_forces(self, state: State) -> FloatArray:
        """Return the force of the workpiece on each tool (n_tools, 3) [N], as modelled."""
        return np.asarray(-state[SpaceToolArrays].force.sum(axis=1))


def _dyads(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return a b^T of each row (n, 3, 3)."""
    return np.asarray(a[:, :, None] * b[:, None, :], dtype=float)
