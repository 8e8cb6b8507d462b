# SPDX-License-Identifier: Apache-2.0
"""Contact of boundary nodes with rigid tools, as exact constraints with an active set.

A node that would be inside a tool is put on its surface and held there along the normal (SLIDING); on a sticking tool
it is held in both directions from the next increment on (STUCK), at the place in the tool's frame where it has come to
rest: so the converged answer does not depend on the path of the iteration. A held node is released when it pulls. There
is no penalty: the tangent stays as well conditioned as the workpiece itself, and the gap of a held node is zero.

No increment converges with a node that pulls by more than what may be out of balance (`tolerance`). What prevents
chatter: a node is released only near equilibrium, and only if it pulls with more than that; where constant shear drags
a node off that comes back without it, a part of the shear is found with which it neither pulls nor lifts (grazing.py);
and a node that has changed its state MAX_CHANGES times in an increment stays held for the rest of it. If it still pulls
when all else is in equilibrium, the increment has failed. Where tools that move apart pull at a body, the fastest ones
release it first: the body stays on the tool that stands still.

Faces: tool t offers face 2t, the closest, and 2t + 1, the other face of an inner corner.
"""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.fields.contact_stress import ContactForces
from presswork.geometry.pose import ToolPose, place_points, start_centre, start_profile, to_tool_frame, turn_vectors
from presswork.interaction.contract import Constraints
from presswork.interaction.plane.grazing import Drag, Grazing
from presswork.interaction.plane.held_nodes import find_normal_forces, prescribe_held
from presswork.interaction.tool_arrays import SLIDING, STUCK, ContactArrays, StatusArray, ToolArrays
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Model, find_cell, list_bodies
from presswork.state import State

MAX_CHANGES = 4
"""Changes after which a node keeps contact until the increment ends."""
SLOWER = 0.5
"""Speed of a tool over that of the tool that leaves fastest below which a body stays on it."""
ALONG = 0.5
"""Part of a normal along the free motion of a body, below which it lies across."""
FLUSH = 1 - 1e-6
"""Cosine between two faces above which they are one: a node held by both would not slide."""


class Contact:
    """The active set of one run; what persists lies in the State."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._segments = [start_profile(t) for t in model.plane_tools]
        self._centres = [start_centre(t) for t in model.plane_tools]
        laws = [t.friction.law for t in model.plane_tools]
        self._sticking = np.array([law == "sticking" for law in laws], dtype=bool)
        boundary = model.mesh.boundary_edges if model.plane_tools else np.zeros((0, 2), dtype=np.int32)
        self.nodes: IntArray = np.unique(boundary).astype(np.int32)
        quadratic = boundary if find_cell(1, boundary).is_quadratic else np.zeros((0, 3))
        self._sides: IndexArray = np.searchsorted(self.nodes, quadratic)  # first, last, mid-side as places
        self._leader = self._find_leaders()
        self._bodies = list_bodies(model)
        starts = [body.points.start for body in self._bodies]
        self._body = np.searchsorted(starts, self.nodes, side="right") - 1
        points = model.mesh.points
        self.tolerance = 1e-6 * float(np.ptp(points, axis=0).max())
        self.gap = np.full((2 * len(model.plane_tools), len(self.nodes)), np.inf)
        self.normal = np.zeros((2 * len(model.plane_tools), len(self.nodes), 2))
        self.segment = np.full(self.gap.shape, -1, dtype=np.int32)  # of the tool's profile; -1 where there is no gap
        self._searched: tuple[FloatArray, FloatArray, FloatArray] | None = None  # nodes and tools of the last search
        self._changes = np.zeros(len(self.nodes), dtype=np.int64)
        self._was_idle = np.zeros(len(self.nodes), dtype=bool)
        self._start = np.zeros((len(model.plane_tools), 2))  # displacement of the tools when the increment began
        self._by_shear = np.array(
            [t.friction.law in ("shear", "coulomb_capped") for t in model.plane_tools], dtype=bool
        ).repeat(2)
        self._grazing = Grazing(len(self.nodes))
        self._grazes = np.zeros(len(self.nodes), dtype=bool)
        self.n_undecided = 0
        """Nodes that may change no more in this increment, and pull strongly."""

    def _find_leaders(self) -> IndexArray:
        """Place whose reaction decides for each candidate: its own, but the mid-side's for a vertex on the axis.

        On the axis a quadratic edge's vertex carries no share of a pressure (int N r dr = 0): its own reaction is
        noise.
        """
        leader = np.arange(len(self.nodes))
        if self._model.analysis == "axisymmetric":
            radius = self._model.mesh.points[self.nodes, 0]
            for end, other in ((0, 1), (1, 0)):
                on_axis = (radius[self._sides[:, end]] < 1e-9) & (radius[self._sides[:, other]] > 1e-9)
                leader[self._sides[on_axis, end]] = self._sides[on_axis, 2]
        return leader

    def _judge(self, push: FloatArray) -> FloatArray:
        """Return the push by which each candidate is judged (n_faces, n_candidates) [N].

        A mid-side is judged with half the push of its ends, about the load of its edge: where a sticking surface ends,
        nodal forces of quadratic elements alternate, and one that pulls by a little is no sign of lifting.
        """
        judged = push.copy()
        first, last, middle = self._sides.T
        judged[:, middle] += 0.5 * (push[:, first] + push[:, last])
        return judged[:, self._leader]

    def search(self, state: State, displacement: FloatArray) -> None:
        """Find gap and normal of every candidate to every tool; tools stand where the state has them."""
        if not len(self.nodes):
            return
        x = self._model.mesh.points[self.nodes] + displacement[self.nodes]
        placed = state[ToolArrays]
        asked = x, placed.displacement, placed.angle
        if self._searched is not None and all(map(np.array_equal, self._searched, asked)):
            return
        self._searched = x, placed.displacement.copy(), placed.angle.copy()
        for t, segments in enumerate(self._segments):
            local = np.ascontiguousarray(to_tool_frame(x, self._pose(state, t)))
            gap, normal, second_gap, second_normal, segment, second_segment = _core.touch_profile(segments, local)
            self.segment[2 * t], self.segment[2 * t + 1] = segment, second_segment
            self.gap[2 * t], self.gap[2 * t + 1] = gap, second_gap
            angle = float(state[ToolArrays].angle[t])
            self.normal[2 * t], self.normal[2 * t + 1] = turn_vectors(normal, angle), turn_vectors(second_normal, angle)

    def _pose(self, state: State, tool: int) -> ToolPose:
        placed = state[ToolArrays]
        return ToolPose(self._centres[tool], placed.displacement[tool], float(placed.angle[tool]))

    def carry(self, state_n: State, state: State, tools: IndexArray, points: FloatArray) -> FloatArray:
        """Return how far the tools have carried points (n, 2) of theirs, given at state_n, since then (n, 2) [mm]."""
        placed, placed_n = state[ToolArrays], state_n[ToolArrays]
        carried = placed.displacement[tools] - placed_n.displacement[tools]
        for t in np.unique(tools[placed.angle[tools] != placed_n.angle[tools]]):
            own = tools == t
            local = to_tool_frame(points[own], self._pose(state_n, t))
            carried[own] = place_points(local, self._pose(state, t)) - points[own]
        return carried

    def find_gaps(self, state: State, points: FloatArray) -> FloatArray:
        """Return the distance of points (n, 2) from each tool (n_tools, n) [mm]; infinite where there is none."""
        gaps = [
            _core.touch_profile(segments, np.ascontiguousarray(to_tool_frame(points, self._pose(state, t))))[0]
            for t, segments in enumerate(self._segments)
        ]
        return np.array(gaps).reshape(len(gaps), len(points))

    def begin(self, state: State, fixed: BoolArray) -> None:
        """Find the nodes that touch before the first increment; on sticking tools they are stuck at once.

        A node that a support holds along the normal needs no tool: both would pin it.
        """
        if not len(self.nodes):
            return
        touch = state[ContactArrays]
        self.search(state, state.nodes.displacement)
        touch.status[(self.gap <= self.tolerance) & self._free(fixed)] = SLIDING
        self._limit_faces(touch.status)
        self.stick_nodes(state)

    def begin_increment(self, state_n: State) -> None:
        """Forget the changes of the increment before."""
        self._changes[:], self._was_idle[:] = 0, False
        self._start = state_n[ToolArrays].displacement
        self._grazing.begin_increment()

    def stick_nodes(self, state: State) -> None:
        """At a converged state: nodes that slide on a sticking tool are stuck from now on, where they are."""
        if not len(self.nodes):
            return
        touch = state[ContactArrays]
        held = (touch.status > 0) & self._sticking.repeat(2)[:, None]
        fresh = held & (touch.status == SLIDING)
        touch.status[held] = STUCK
        touch.shear_part[~((touch.status > 0) & self._by_shear[:, None]).any(axis=0)] = 1.0
        face, node = np.nonzero(fresh)
        position = self._model.mesh.points[self.nodes[node]] + state.nodes.displacement[self.nodes[node]]
        for t in np.unique(face // 2):
            own = face // 2 == t
            touch.anchor[node[own]] = to_tool_frame(position[own], self._pose(state, t))

    def _limit_faces(self, contact: StatusArray, before: StatusArray | None = None) -> None:
        """Keep at most two faces a node: those held before, then those it is deepest in; one where both are flush."""
        crowded = np.nonzero((contact > 0).sum(axis=0) > 1)[0]
        for node in crowded:
            faces = np.nonzero(contact[:, node])[0]
            fresh = np.zeros(len(faces)) if before is None else before[faces, node] == 0
            order = faces[np.lexsort((self.gap[faces, node], fresh))]
            flush = self.normal[order[0], node] @ self.normal[order[1], node] > FLUSH
            contact[order[1:] if flush and len(order) == 2 else order[2:], node] = 0

    def update(
        self, trial: State, reaction: FloatArray, drag: Drag, fixed: BoolArray, *, near: bool, tolerance: float
    ) -> int:
        """Hold nodes inside tools and, near equilibrium, release those that pull; return the changes.

        tolerance: pull below which a node stays held [N].
        """
        if not len(self.nodes):
            return 0
        touch = trial[ContactArrays]
        self.n_undecided = 0
        before = touch.status.copy()
        lost = (touch.status == SLIDING) & ~np.isfinite(self.gap)  # slid off the end of a profile, or out of a corner
        touch.status[lost] = 0
        limit = np.where(lost.any(axis=0), self.tolerance, -self.tolerance)  # where tools adjoin, the next one takes it
        touch.status[(self.gap < limit) & (touch.status == 0) & self._free(fixed)] = SLIDING
        self._limit_faces(touch.status, before)
        if near:
            self._release_pulling(trial, before, self.normal_forces(trial, reaction, fixed), drag, tolerance)
        changed = (before != touch.status).any(axis=0)
        self._changes[changed] += 1
        return int(changed.sum())

    def _release_pulling(
        self, trial: State, before: StatusArray, push: FloatArray, drag: Drag, tolerance: float
    ) -> None:
        """Release nodes that pull, except those that their shear may drag off the tool."""
        touch = trial[ContactArrays]
        held = (before > 0) & (touch.status > 0)
        judged = np.where(held, self._judge(push), 0.0)
        pulls = judged < -tolerance
        by_shear = (self._changes >= 2) | (-judged.min(axis=0, initial=0.0) < drag.force)
        self._grazes = self._on_shear(trial) & (pulls.any(axis=0) & by_shear | (touch.shear_part < 1.0))
        pulls &= ~(self._grazes & (touch.shear_part > 0.0))
        pulls &= _leave_first(self._find_speed(trial), pulls)
        touch.status[pulls & (self._changes < MAX_CHANGES)] = 0
        self.n_undecided = int((pulls & (self._changes >= MAX_CHANGES)).any(axis=0).sum())

    def release_idle(self, trial: State, reaction: FloatArray, fixed: BoolArray, tolerance: float) -> int:
        """Release nodes in equilibrium that tools hold with no more force than may be out of balance; return how many.

        Each once in an increment.
        A body would follow a tool that leaves it by such a force. Where tools bear no part of it at all, it would go
        along a surface across its free motion to stay in touch, as a strip that shrinks between rolls.
        """
        status = trial[ContactArrays].status
        held = (status > 0) & ~self._was_idle
        if not held.any():
            return 0
        force = np.abs(np.where(status > 0, self._judge(self.normal_forces(trial, reaction, fixed)), 0.0))
        idle = held & (force <= tolerance) & self._may_follow(force, self._find_speed(trial), fixed, tolerance)
        status[idle] = 0
        changed = idle.any(axis=0)
        self._was_idle |= changed
        return int(changed.sum())

    def _may_follow(self, force: FloatArray, speed: FloatArray, fixed: BoolArray, tolerance: float) -> BoolArray:
        """Mark faces that a body would follow if they held it by next to no force (n_faces, n_candidates)."""
        fastest = float(speed[np.arange(len(speed)), self.gap.argmin(axis=1)].max())
        leaves = (speed > 0.0) & (speed >= SLOWER * fastest)
        borne, free = np.zeros(len(self._bodies)), np.zeros((len(self._bodies), 2))
        np.maximum.at(borne, self._body, force.max(axis=0))
        for number, body in enumerate(self._bodies):
            free[number] = ~fixed[body.points.start : body.points.stop, :2].any(axis=0)
        free[:, 0] *= self._model.analysis != "axisymmetric"
        along = np.linalg.norm(self.normal * free[self._body], axis=2)
        across = (borne[self._body] <= tolerance) & (along < ALONG)
        return np.asarray(leaves | across)

    def _find_speed(self, trial: State) -> FloatArray:
        """Return how far faces have left the candidates since the increment began (n_faces, n_candidates) [mm]."""
        moved = (trial[ToolArrays].displacement - self._start).repeat(2, axis=0)
        return -np.asarray((self.normal * moved[:, None]).sum(axis=2))

    def _on_shear(self, trial: State) -> BoolArray:
        """Mark nodes that one face alone holds, with constant shear (n_candidates,)."""
        held = trial[ContactArrays].status > 0
        return np.asarray((held & self._by_shear[:, None]).any(axis=0) & (held.sum(axis=0) == 1))

    def graze(
        self, trial: State, reaction: FloatArray, drag: Drag, fixed: BoolArray, *, tolerance: float,
        credible: float,
    ) -> int:  # fmt: skip
        """Find better parts of the shear where nodes neither push nor lift off; return how many are not right yet.

        After update() of the same iterate, near equilibrium. tolerance, credible: as in Grazing.update [N].
        """
        touch = trial[ContactArrays]
        grazes = self._grazes & self._on_shear(trial)
        if not grazes.any():
            return 0
        push = self.normal_forces(trial, reaction, fixed)
        own = np.where(touch.status > 0, self._judge(push), 0.0).sum(axis=0)
        largest = float(np.abs(push).max())
        return self._grazing.update(
            touch.shear_part, grazes, own, drag, tolerance=tolerance, credible=credible, largest=largest
        )

    def _free(self, fixed: BoolArray) -> BoolArray:
        """Faces whose normal has a part along a direction that supports leave free (n_faces, n_candidates)."""
        free = ~fixed[self.nodes]
        return np.asarray((np.abs(self.normal) * free).max(axis=2) > 1e-3, dtype=bool)

    def normal_forces(self, state: State, reaction: FloatArray, fixed: BoolArray) -> FloatArray:
        """Return the push of every held face on its node (n_faces, n_candidates) [N]; negative pulls."""
        if not len(self.nodes):
            return np.zeros(self.gap.shape)
        return find_normal_forces(self.nodes, self.normal, state[ContactArrays].status, reaction, fixed)

    def tool_forces(self, state: State, fixed: BoolArray) -> tuple[FloatArray, FloatArray]:
        """Return force (n_tools, 2) [N] and torque about its centre (n_tools,) [N mm] of the workpiece on each tool.

        As modelled. Where a node is also held by a support, that direction's reaction is the support's; where by two
        tools, each has the push of its own faces.
        """
        n_tools = len(self._model.plane_tools)
        forces, torques = np.zeros((n_tools, 2)), np.zeros(n_tools)
        if not n_tools:
            return forces, torques
        by_tool: BoolArray = np.asarray((state[ContactArrays].status > 0).reshape(n_tools, 2, -1).any(axis=1))
        shared: BoolArray = np.asarray(by_tool.sum(axis=0) > 1)
        push = self.normal_forces(state, state.nodes.reaction, fixed) if shared.any() else None
        at = self._model.mesh.points[self.nodes] + state.nodes.displacement[self.nodes]
        for t in range(n_tools):
            force = -state.nodes.reaction[self.nodes] * ~fixed[self.nodes] * by_tool[t][:, None]
            if push is not None:
                faces = slice(2 * t, 2 * t + 2)
                force[shared] = -np.einsum("fn,fni->ni", push[faces], self.normal[faces])[shared]
            arm = at - self._centres[t] - state[ToolArrays].displacement[t]
            forces[t] = force.sum(axis=0)
            torques[t] = float((arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]).sum())
        return forces, torques

    def pushes(self, state: State, fixed: BoolArray) -> tuple[BoolArray, FloatArray]:
        """Return which tool holds which candidate, and how it pushes it along the normal [N], (n_tools, n) each.

        As forces() has them, without what else it finds.
        """
        self.search(state, state.nodes.displacement)
        held = state[ContactArrays].status > 0
        force = state.nodes.reaction[self.nodes] * ~fixed[self.nodes]
        push = np.where(held, (self.normal * force).sum(axis=2), 0.0)
        both = held.sum(axis=0) > 1
        if both.any():
            push[:, both] = np.where(held, self.normal_forces(state, state.nodes.reaction, fixed), 0.0)[:, both]
        shape = (len(held) // 2, 2, len(self.nodes))
        by_tool: BoolArray = np.asarray(held.reshape(shape).any(axis=1))
        return by_tool, np.asarray(push.reshape(shape).sum(axis=1))

    def forces(self, state: State, fixed: BoolArray) -> ContactForces:
        """Return what each tool does to the nodes that it holds, as tool_forces() adds it up."""
        self.search(state, state.nodes.displacement)
        n_tools, n_points = len(self._model.plane_tools), len(state.nodes.displacement)
        held_as = state[ContactArrays].status if n_tools else np.zeros((0, 0), dtype=np.int8)
        held = held_as > 0
        both = held.sum(axis=0) > 1
        by_tool: BoolArray = np.asarray(held.reshape(n_tools, 2, len(self.nodes)).any(axis=1))
        tool, place = np.nonzero(by_tool)
        push = np.where(held, self.normal_forces(state, state.nodes.reaction, fixed), 0.0)
        by_face = (push[..., None] * self.normal).reshape(n_tools, 2, len(self.nodes), 2).sum(axis=1)
        plane = slice(0, 2)  # a shell, which no tool touches, has more freedoms
        whole = state.nodes.reaction[self.nodes[place], plane] * ~fixed[self.nodes[place], plane]
        force = np.where((by_tool.sum(axis=0) > 1)[place, None], by_face[tool, place], whole)
        face = 2 * tool + ~held[2 * tool, place]
        normal = self.normal[face, place]
        tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        along = np.einsum("ni,ni->n", normal, force)
        status, gap = np.zeros(n_points, dtype=np.int8), np.full(n_points, np.nan)
        status[self.nodes] = np.where(both, STUCK, held_as.max(axis=0, initial=0))
        nearest = self.gap.min(axis=0, initial=np.inf)
        gap[self.nodes] = np.where(np.isfinite(nearest), nearest, np.nan)
        return ContactForces(
            nodes=self.nodes[place],
            tool=tool,
            segment=self.segment[face, place],
            normal=normal,
            in_corner=both[place],
            push=np.where(both[place], push.reshape(n_tools, 2, len(self.nodes)).sum(axis=1)[tool, place], along),
            drag=np.where(both[place], 0.0, np.einsum("ni,ni->n", tangent, force)),
            force=force,
            status=status,
            gap=gap,
        )

    def constrain(self, trial: State, displacement: FloatArray, supports: Constraints) -> Constraints:
        """Return the supports' constraints together with those of the held nodes."""
        if not self._model.plane_tools:
            return supports
        touch = trial[ContactArrays]
        at = self._model.mesh.points[self.nodes] + displacement[self.nodes]
        missing = np.zeros_like(at)
        stuck = (touch.status == STUCK).any(axis=0)
        tools = (touch.status == STUCK).argmax(axis=0) // 2
        for t in np.unique(tools[stuck]):
            own = stuck & (tools == t)
            missing[own] = place_points(touch.anchor[own], self._pose(trial, t)) - at[own]
        return prescribe_held(self.nodes, self.normal, touch.status, -self.gap, missing, supports)

    def follow(self, trial: State, tool: int, direction: FloatArray, supports: Constraints) -> Constraints:
        """Return what the held nodes must do for each mm that a tool moves along a direction; supports stand still."""
        closing = np.zeros_like(self.gap)
        faces = [2 * tool, 2 * tool + 1]
        closing[faces] = self.normal[faces] @ direction
        own = (trial[ContactArrays].status[faces] == STUCK).any(axis=0)
        still = Constraints(supports.mask, np.zeros_like(supports.value), supports.turned, supports.frames)
        return prescribe_held(
            self.nodes, self.normal, trial[ContactArrays].status, closing, own[:, None] * direction, still
        )


def _leave_first(speed: FloatArray, pulls: BoolArray) -> BoolArray:
    """Mark the faces that leave their nodes fastest, of those that pull; all where none leaves (n_faces, n)."""
    fastest = float(speed[pulls].max(initial=0.0))
    return np.asarray(speed >= SLOWER * fastest) if fastest > 0.0 else np.ones_like(pulls)
