# SPDX-License-Identifier: Apache-2.0
"""Contact of the nodes of a shell with rigid tools in space, and Coulomb friction, with the consistent tangent.

A node touches where the gap g between the tool and the sheet's surface, half a thickness off the node, closes. What
holds it is a part c of the sheet's elasticity across its thickness, k = c E A / t with A the node's share of the
surface and c = SolverSettings.contact_stiffness: N = -k g, rounded off over a small gap so that the derivative has no
jump. So a sheet may lie between two tools, which exact constraints would not allow. It sinks in by t p / (c E) under a
pressure p.

Friction is a return mapping over the increment, as in friction.py: T = P (T_n - k_t d), P the tangent plane at the
node's present place and d its way along the tool, shortened to mu N. The tangent holds all derivatives: of N, of the
direction of sliding, and of the normal by the curvature of the tool; it is not symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.body.shell_arrays import ShellArrays
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.contract import Forces
from presswork.interaction.coulomb import return_to_limit
from presswork.interaction.drawbeads import BeadForces, SheetBeads
from presswork.interaction.tool_arrays import SheetToolArrays
from presswork.mesh.topology import count_corners
from presswork.model import FloatArray, IndexArray, IntArray, Model, Stage, ToolMotion
from presswork.state import State

TANGENTIAL = 0.1
"""Of the spring that a sticking node hangs on, over the contact's."""
ROUNDING = 1e-3
"""Gap over the thickness below which a node begins to touch."""

DEPTH = 2.0
"""Thicknesses that a node of a guess may lie in a tool and be found: behind that is another wall."""


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
class SheetNodes:
    """What contact must know of the nodes."""

    area: FloatArray
    """Share of the surface (n_points,) [mm2]."""
    thickness: FloatArray
    """(n_points,) [mm]."""
    stiffness: float
    """Of contact, per area and thickness [MPa]."""


def touch_tool(
    surface: _core.ToolSurface, mu: float, sheet: SheetNodes, x: FloatArray, way: FloatArray, friction_n: FloatArray
) -> NodesOnTool:
    """Return the forces of a tool on the nodes of a sheet.

    x: their places in the tool's frame (n_points, 3) [mm]. way: of the nodes along with the increment, less that of the
    tool (n_points, 3) [mm]. friction_n: their friction when the increment began (n_points, 3) [N].
    """
    rounding = ROUNDING * sheet.thickness
    gap, normal, _, _ = surface.nearest(x, float((0.5 * sheet.thickness + rounding).max()))
    nodes = np.flatnonzero(gap - 0.5 * sheet.thickness < rounding)
    g, n, delta = (gap - 0.5 * sheet.thickness)[nodes], normal[nodes], rounding[nodes]
    rise, bend = surface.slopes(np.ascontiguousarray(x[nodes]))
    # 1. normal force, a parabola within the rounding
    k = sheet.stiffness * sheet.area[nodes] / sheet.thickness[nodes]
    deep = g < -delta
    push = np.where(deep, -k * g, k * (delta - g) ** 2 / (4.0 * delta))
    slope = np.where(deep, -k, -0.5 * k * (delta - g) / delta)  # d push / d g
    rounded = k * (delta - np.maximum(g, -delta)) ** 3 / (12.0 * delta)
    energy = float((rounded + np.where(deep, 0.5 * k * (g**2 - delta**2), 0.0)).sum())
    force = push[:, None] * n
    stiffness = -_dyads(slope[:, None] * n, rise) - push[:, None, None] * bend
    if mu == 0.0:
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
    # 3. shortened to mu N where it slides
    limit = mu * push
    returned = return_to_limit(trial, limit)
    slides, along, friction = returned.slides, returned.along, returned.force
    d_slide = mu * _dyads(along, slope[:, None] * rise)
    d_slide += np.where(slides, limit / returned.size, 0.0)[:, None, None] * (
        (np.eye(3) - _dyads(along, along)) @ d_trial
    )
    stiffness -= np.where(slides[:, None, None], d_slide, d_trial)
    return NodesOnTool(nodes, force + friction, friction, stiffness, energy)


@dataclass(frozen=True)
class SheetForces(Forces):
    """Of all tools and beads on the nodes."""

    by_tool: FloatArray
    """(n_tools, n_points, 3) [N]."""
    friction: FloatArray
    """The part of it along the tool, in the same form."""
    tool: IntArray
    """Which tool each block is of (n,); -1: of a bead."""
    beads: BeadForces
    energy: float
    """Stored by the normal forces [N mm]."""


class SheetContact:
    """The tools in space of one run, and its drawbeads; what persists lies in the State."""

    def __init__(self, model: Model) -> None:
        self._model = model
        n = len(model.mesh.points)
        self._area, self._cells = np.zeros(n), np.zeros(n)
        for block in model.mesh.blocks:
            self._area += share_surface(model.mesh.points, block.connectivity)
            np.add.at(self._cells, block.connectivity, 1.0)
        self._thickness = np.zeros(n)
        depth = DEPTH * max((b.section.thickness for b in model.mesh.blocks if b.section), default=0.0)
        self._surfaces = [make_surface(tool.surface, depth, smooth=True) for tool in model.sheet_tools]
        self.beads = SheetBeads(model)
        self._stiffness = model.solver.contact_stiffness * max(m.young for m in model.materials)

    def move(self, stage: int, fraction: float) -> FloatArray:
        """Return how far strokes have moved the tools at a fraction of a stage (n_tools, 3) [mm]."""
        stages = self._model.stages
        return sum((self._move(s) for s in stages[:stage]), fraction * self._move(stages[stage]))

    def _move(self, stage: Stage) -> FloatArray:
        moves = [stage.tool_motion.get(t.name, ToolMotion()).move for t in self._model.sheet_tools]
        return np.array(moves, dtype=float).reshape(-1, 3)

    def begin_increment(self, state_n: State) -> None:
        """Take the thickness at the nodes as it is when the increment begins."""
        total = np.zeros_like(self._cells)
        for block, thickness in zip(self._model.mesh.blocks, state_n[ShellArrays].thickness, strict=True):
            np.add.at(total, block.connectivity, thickness.mean(axis=1)[:, None])
        self._thickness = total / np.maximum(self._cells, 1.0)
        self.beads.begin_increment(state_n)

    def evaluate(
        self, state_n: State, trial: State, displacement: FloatArray, stage: int = 0, fraction: float = 0.0
    ) -> SheetForces:
        """Return the forces of tools and beads at a guess; tools stand where the trial state has them."""
        placed, placed_n = trial[SheetToolArrays], state_n[SheetToolArrays]
        n, tools = len(displacement), self._model.sheet_tools
        sheet = SheetNodes(self._area, self._thickness, self._stiffness)
        x = self._model.mesh.points + displacement[:, :3]
        moved = displacement[:, :3] - state_n.nodes.displacement[:, :3]
        by_tool, friction = np.zeros((len(tools), n, 3)), np.zeros((len(tools), n, 3))
        nodes, blocks, owners, energy = [], [], [], 0.0
        for t, tool in enumerate(tools):
            place = x - np.array(tool.position) - placed.displacement[t]
            way = moved - (placed.displacement[t] - placed_n.displacement[t])
            found = touch_tool(self._surfaces[t], float(tool.friction.mu), sheet, place, way, placed_n.friction[t])
            by_tool[t, found.nodes], friction[t, found.nodes] = found.force, found.friction
            block = np.zeros((len(found.nodes), 6, 6))
            block[:, :3, :3] = found.stiffness
            energy += found.energy
            nodes.append(found.nodes)
            blocks.append(block)
            owners.append(np.full(len(found.nodes), t, dtype=np.int32))
        beads = self.beads.evaluate(state_n, trial, displacement, self.beads.share(stage, fraction))
        force = np.zeros((n, 6))
        force[:, :3] = by_tool.sum(axis=0) + beads.force
        block = np.zeros((len(beads.pairs), 6, 6))
        block[:, :3, :3] = beads.blocks
        pairs: list[IntArray] = [np.repeat(own[:, None], 2, axis=1).astype(np.int32) for own in nodes]
        owners.append(np.full(len(block), -1, dtype=np.int32))
        return SheetForces(
            force,
            np.concatenate([*pairs, beads.pairs]),
            np.concatenate([*blocks, block]),
            by_tool,
            friction,
            np.concatenate(owners),
            beads,
            energy,
        )

    def settle(self, trial: State, found: SheetForces) -> None:
        """Keep what an increment has found."""
        kept = trial[SheetToolArrays]
        kept.force, kept.friction, kept.energy = found.by_tool, found.friction, found.energy
        self.beads.settle(trial, found.beads)

    def held_directions(self, state: State) -> tuple[IndexArray, FloatArray]:
        """Return nodes (n,) and unit vectors (n, 3) along which beads and tools hold them; rough tools in all three."""
        self.begin_increment(state)
        found = self.evaluate(state, state, state.nodes.displacement)
        beneath, across = self.beads.held_directions()
        nodes, directions = [beneath], [across]
        for tool, force in zip(self._model.sheet_tools, found.by_tool, strict=True):
            touched = np.flatnonzero(np.linalg.norm(force, axis=1) > 0.0)
            if float(tool.friction.mu) > 0.0:
                nodes.append(np.repeat(touched, 3))
                directions.append(np.tile(np.eye(3), (len(touched), 1)))
            else:
                nodes.append(touched)
                directions.append(force[touched] / np.linalg.norm(force[touched], axis=1)[:, None])
        return np.concatenate(nodes), np.concatenate(directions)

    def work(self, state_n: State, trial: State) -> tuple[float, float]:
        """Return the work of tools and beads in an increment, by their own motion, and what friction takes [N mm]."""
        placed, placed_n = trial[SheetToolArrays], state_n[SheetToolArrays]
        moved = placed.displacement - placed_n.displacement
        forces = (placed_n.force + placed.force).sum(axis=1)
        way = trial.nodes.increment[None, :, :3] - moved[:, None]
        lost = -0.5 * float(((placed_n.friction + placed.friction) * way).sum())
        carried, restrained = self.beads.work(state_n, trial)
        return 0.5 * float((forces * moved).sum()) + carried, lost + restrained

    def depths(self, state: State) -> FloatArray:
        """Return how deep the sheet's surface is in each tool at a converged state (n_tools,) [mm]."""
        self.begin_increment(state)
        x = self._model.mesh.points + state.nodes.displacement[:, :3]
        half = 0.5 * self._thickness
        found = np.zeros(len(self._model.sheet_tools))
        for t, tool in enumerate(self._model.sheet_tools):
            gap, *_ = self._surfaces[t].nearest(
                x - np.array(tool.position) - state[SheetToolArrays].displacement[t], float(half.max())
            )
            found[t] = max(0.0, -float((gap - half).min()))
        return found

    def tool_forces(self, state: State) -> FloatArray:
        """Return the force of the sheet on each tool (n_tools, 3) [N], as modelled."""
        return np.asarray(-state[SheetToolArrays].force.sum(axis=1))


def share_surface(points: FloatArray, connectivity: IntArray) -> FloatArray:
    """Return each node's share of the surface (n_points,) [mm2]: the same of each node of a cell."""
    share = np.zeros(len(points))
    np.add.at(share, connectivity, (_cell_areas(points, connectivity) / connectivity.shape[1])[:, None])
    return share


def _cell_areas(points: FloatArray, connectivity: IntArray) -> FloatArray:
    """Return the areas of flat triangles or quadrilaterals, by their corners [mm2]."""
    corners = points[connectivity[:, : count_corners(connectivity.shape[1])]]
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    if corners.shape[1] == 4:
        one, other = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return np.asarray(0.5 * np.linalg.norm(np.cross(one, other), axis=1))


def _dyads(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return a b^T of each row (n, 3, 3)."""
    return np.asarray(a[:, :, None] * b[:, None, :], dtype=float)
