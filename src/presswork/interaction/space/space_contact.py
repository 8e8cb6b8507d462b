# SPDX-License-Identifier: Apache-2.0
"""Contact of nodes with rigid tools in space by the law of space_touch.py: what sheets and solids share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.body.contract import Cells, Look, Near
from presswork.geometry.pose import find_axis, find_space_pose, turn_about
from presswork.geometry.rounded_surface import RoundedSurface
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.contract import Forces
from presswork.interaction.sliding import Sliding
from presswork.interaction.space.drawbeads import BeadForces
from presswork.interaction.space.space_touch import (
    FrictionOfNodes,
    PlacedSurface,
    TouchingNodes,
    choose_touched,
    is_frictionless,
    touch_tool,
)
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import FloatArray, IndexArray, IntArray, Model, Tool
from presswork.state import Arrays, State

LIES = 200.0
"""Gap over the rounding of contact within which a node lies on a tool."""

Touched = tuple[IndexArray, FloatArray, FloatArray]
"""Nodes that touch a tool (n,), its normals there (n, 3) and its push on them (n,) [N]."""


@dataclass(frozen=True)
class SpaceForces(Forces):
    """Forces of all tools and beads on the nodes."""

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
    """Beads of a sheet."""


class SpaceContact:
    """The tools in space of one run; what persists lies in the State."""

    def __init__(self, model: Model, cells: Cells, depth: float, before: SpaceContact | None = None) -> None:
        """Take the tools of a model, and the cells that touch them.

        depth: that a node of a guess may lie in a tool and be found [mm]. before: the same tools of the run on the mesh
        before, whose surfaces are taken over.
        """
        self._model = model
        self._surfaces: list[_core.ToolSurface | RoundedSurface] = (
            before._surfaces if before else [self._make_surface(tool, depth) for tool in model.space_tools]
        )
        self._law_gap: FloatArray | None = None
        self._cells = cells
        self.sliding = Sliding(model.space_tools, len(model.mesh.points))
        self._factor: FloatArray | None = None

    def _make_surface(self, tool: Tool, depth: float) -> _core.ToolSurface | RoundedSurface:
        return make_surface(tool.surface, depth, smooth=True)

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of tools that have not moved and touch nothing."""
        placed = SpaceToolArrays.at_rest(len(self._model.space_tools), len(self._model.mesh.points))
        return placed, *self.sliding.at_rest()

    def placed(self, t: int, arrays: SpaceToolArrays) -> PlacedSurface:
        """Return the surface of a tool where it stands."""
        pose = find_space_pose(self._model.space_tools[t], arrays.displacement[t], float(arrays.angle[t]))
        return PlacedSurface(self._surfaces[t], pose)

    def slips(self, state_n: State, trial: State, displacement: FloatArray) -> Iterator[FloatArray]:
        """Yield the slip of the nodes along each tool in an increment (n_points, 3) [mm].

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
        if self.sliding.is_needed or self.sliding.needs_temperature:
            self._factor = self.sliding.find_factors(state_n, self._cells.nodal_temperature(state_n))

    def touching(self, tool: int) -> TouchingNodes:
        """Return what the contact with a tool must know of the nodes."""
        raise NotImplementedError

    def _look(self, looks: Sequence[Look], x: FloatArray) -> list[Near]:
        """Return what each look finds of the nodes at x (n_points, 3) [mm]."""
        return [nearest(x, reach) for nearest, reach in looks]

    def limit_by_shear(self, x: FloatArray, touched: Sequence[Touched]) -> Sequence[FloatArray | None]:
        """Return the largest friction on nodes of each tool whatever the push (n,) [N]; None: no law asks for it.

        Shear flow stress times area; on a sticking tool infinite for nodes that stick, 0 for those that land.
        x: places of all nodes (n_points, 3) [mm]. touched: of each tool the nodes that touch it (n,), its normals there
        (n, 3) and its push on them (n,) [N].
        """
        return [None] * len(touched)

    def friction_on(self, t: int, touched: Touched, shear: FloatArray | None) -> FrictionOfNodes:
        """Return what the friction of a tool asks of nodes that touch it; shear: as limit_by_shear has it (n,) [N]."""
        law = self._model.space_tools[t].friction
        factor = None if self._factor is None else self._factor[t, touched[0]]
        return FrictionOfNodes(law, self._find_area(t, touched, shear), shear, factor)

    def _find_area(self, t: int, touched: Touched, shear: FloatArray | None) -> FloatArray:
        """Return the area over which each node that touches a tool is pressed (n,) [mm2]."""
        return self.touching(t).area[touched[0]]

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
        pressed = [(own.nodes, own.normal, own.push) for own in touched]
        shear = self.limit_by_shear(x, pressed)
        for t, slip in enumerate(self.slips(state_n, trial, displacement)):
            law = self.friction_on(t, pressed[t], shear[t])
            found = touch_tool(surfaces[t], law, touched[t], x, slip, friction_n[t])
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

    def count_undecided(self, trial: State, found: SpaceForces, displacement: FloatArray, pull: float) -> int:
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

    def end_increment(self, trial: State, found: SpaceForces) -> None:
        """Keep what an increment has found."""
        kept = trial[SpaceToolArrays]
        kept.force, kept.friction, kept.energy = found.by_tool, found.friction, found.energy

    def commit(self, state_n: State, trial: State, dt: float) -> None:
        """Keep how far and how fast nodes have slid in an increment of dt [s]."""
        if self.sliding.is_needed:
            placed = trial[SpaceToolArrays]
            touches = np.linalg.norm(placed.force, axis=2) > 0.0
            slip = np.linalg.norm(self._slips(state_n, trial), axis=2)
            self.sliding.advance(state_n, trial, np.where(touches, slip, 0.0).max(axis=0, initial=0.0), dt)

    def touched(self, state: State) -> FloatArray:
        """Return the forces of the tools on the nodes where they stand in a state (n_tools, n_points, 3) [N]."""
        self.begin_increment(state)
        return self.evaluate(state, state, state.nodes.displacement).by_tool

    def held_directions(
        self, state: State, pushed_along: Mapping[int, FloatArray], least: float, *, lying: bool
    ) -> tuple[IndexArray, FloatArray]:
        """Return nodes (n,) and vectors (n, 3) along which tools hold them; rough tools in all three.

        pushed_along: directions (3,) of tools that forces push, by their numbers, along which these hold nothing.
        least: a push that counts as none [N]. lying: nodes that lie on tools are held, too, pushed or not.
        """
        nodes, directions = [np.zeros(0, dtype=np.intp)], [np.zeros((0, 3))]
        forces = self.touched(state)
        lies = self._find_lying(state) if lying else [(np.zeros(0, dtype=np.intp), np.zeros((0, 3)))] * len(forces)
        for t, (tool, force, (beside, out)) in enumerate(zip(self._model.space_tools, forces, lies, strict=True)):
            pushed = np.flatnonzero(np.linalg.norm(force, axis=1) > least)
            along = force[pushed] / np.linalg.norm(force[pushed], axis=1)[:, None]
            touched, along = np.concatenate([pushed, beside]), np.concatenate([along, out])
            if not is_frictionless(tool.friction):
                touched, along = np.repeat(touched, 3), np.tile(np.eye(3), (len(touched), 1))
            if t in pushed_along:
                along = along - (along @ pushed_along[t])[:, None] * pushed_along[t]
            nodes.append(touched)
            directions.append(along)
        return np.concatenate(nodes), np.concatenate(directions)

    def _find_lying(self, state: State) -> list[tuple[IndexArray, FloatArray]]:
        """Return the nodes that lie on each tool (n,), and its normals there (n, 3)."""
        places, found = self._model.mesh.points + state.nodes.moved, []
        for t in range(len(self._surfaces)):
            touching = self.touching(t)
            near = touching.reach + LIES * touching.rounding
            surface = self.placed(t, state[SpaceToolArrays])
            gap, out = self._look([(surface.nearest, float(near.max()))], places)[0]
            nodes = np.flatnonzero(gap <= near)
            found.append((nodes, out[nodes]))
        return found

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
        """Return the slip of the nodes along each tool in a converged increment (n_tools, n_points, 3) [mm]."""
        now, before = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        if (now.angle != before.angle).any():
            return np.array(list(self.slips(state_n, trial, trial.nodes.displacement)))
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
