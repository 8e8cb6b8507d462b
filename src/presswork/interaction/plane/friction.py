# SPDX-License-Identifier: Apache-2.0
"""Friction of held nodes: the laws, and what they add to the residual and to the tangent.

A node in contact hangs on its tool by a stiff tangential spring: over an increment its friction changes by -k_t times
the slip, from T_n. Where that exceeds what the law allows, the node slides and T = T_max against the slip (return
mapping with a small elastic slip). The force is kept and not the spring's length, so that a change of the node's area
is no jump. k_t = k A' / the elastic slip, A' the node's share of all edges beside it, in contact or not: a lone node in
contact has friction, too. T_max by law, A the node's share of the surface in contact and k = flow stress / sqrt(3) at
the start of the increment:

    shear m k A        coulomb mu N        coulomb_capped min(mu N, m k A)

and what law/friction.py has for a pressure N / A. m and mu may depend on speed, path and temperature (sliding.py).

The converged answer is the same whatever the tangent; settings.friction_tangent chooses it:

    return_mapping   k_t where the node hangs, nothing where it slides, and Coulomb's dependence on N (unsymmetric);
                     where it slides in the opposite direction to the iteration before, the chord between both: with
                     nothing
                     Newton's method would throw it to and fro for ever
    bond             where it slides, a soft spring too (after the bond element of Cheng 1995, chapter 3): the full
                     friction stress over the slip of the increment before, softened
    residual         nothing: friction in the residual only
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.fields.contact_stress import edge_shares
from presswork.interaction.contract import Constraints, Matrix
from presswork.interaction.coulomb import return_to_limit
from presswork.interaction.plane.grazing import Drag
from presswork.interaction.plane.tool_contact import Contact
from presswork.interaction.sliding import Sliding
from presswork.interaction.tool_arrays import SLIDING, ContactArrays
from presswork.law.friction import is_plain, limit_stress
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Model, find_cell
from presswork.state import State

ELASTIC_SLIP = 2e-3
"""Slip at which the spring reaches k A, as a part of the shortest boundary edge."""
BOND_SOFTENING = 0.1
"""Stiffness of sliding over that of the bond (thesis: 0.05 to 0.15)."""


_NO_BLOCKS = np.zeros((0, 2), dtype=np.int32), np.zeros((0, 2, 2))


@dataclass(frozen=True)
class ByArea:
    """Friction in proportion to the nodes' shares of edges."""

    edges: IntArray
    """(n_edges, 2 | 3)."""
    part: FloatArray
    """Part of each edge that counts (n_edges,)."""
    slope: FloatArray
    """Friction of each node along its tangent over its share, as a vector (n_points, 2) [MPa]."""

    def find_blocks(self, points: FloatArray, depth: float | None) -> tuple[IntArray, FloatArray]:
        """Return pairs of nodes (n, 2), and what the first adds to the tangent by the place of the second (n, 2, 2).

        points: where the nodes are (n_points, 2) [mm]; depth [mm]: None for rings. Straight edges alone.
        """
        own = self.edges[np.any(self.slope[self.edges] != 0.0, axis=(1, 2))]
        part = self.part[np.any(self.slope[self.edges] != 0.0, axis=(1, 2))]
        pairs, blocks = [], []
        for first, second in ((0, 1), (1, 0)):
            a, b = own[:, first], own[:, second]
            along = points[b] - points[a]
            length = np.linalg.norm(along, axis=1, keepdims=True)
            by_length: FloatArray | float = 0.5
            by_radius = np.zeros(2)
            if depth is None:
                by_length = np.pi / 3.0 * (2.0 * points[a, :1] + points[b, :1])
                by_radius = np.array([np.pi / 3.0, 0.0])
            for other, sign, more in ((a, -1.0, 2.0), (b, 1.0, 1.0)):
                share = sign * by_length * along / length + more * length * by_radius
                share *= part[:, None] * (1.0 if depth is None else depth)
                pairs.append(np.column_stack([a, other]))
                blocks.append(-self.slope[a][:, :, None] * share[:, None, :])
        return np.concatenate(pairs).astype(np.int32), np.concatenate(blocks)


@dataclass(frozen=True)
class FrictionForces:
    """Friction on the nodes that are held along the normal alone."""

    nodes: IntArray
    tools: IndexArray
    tangent: FloatArray
    """Unit vectors (n, 2)."""
    slip: FloatArray
    """Slip of the node along its tool over the increment (n,) [mm]."""
    force: FloatArray
    """Force of the tool on the node, along the tangent (n,) [N]."""
    stiffness: FloatArray
    """What the tangent gets on the node's tangential diagonal (n,) [N/mm]."""
    normal_slope: FloatArray
    """d force / d normal force (n,), zero but for sliding under Coulomb's law."""
    points: FloatArray
    """Where all nodes are (n_points, 2) [mm]."""
    depth: float | None
    """Depth of the section [mm]; None for rings."""
    by_area: Sequence[ByArea]
    """What depends on the area of edges, which the tangent of Newton's method leaves out."""

    def vector(self, n_points: int) -> FloatArray:
        """Return the friction as nodal forces (n_points, 2) [N]."""
        forces = np.zeros((n_points, 2))
        forces[self.nodes] = self.force[:, None] * self.tangent
        return forces

    def add_stiffness(
        self,
        assembler: Matrix,
        constraints: Constraints,
        data: FloatArray,
        *,
        symmetric: bool,
    ) -> None:
        """Add the stiffness to the matrix; Coulomb's dependence on the normal force only to an unsymmetric one."""
        pairs = np.repeat(self.nodes[:, None], 2, axis=1).astype(np.int32)
        blocks = self.stiffness[:, None, None] * self.tangent[:, :, None] * self.tangent[:, None, :]
        assembler.add_blocks(pairs, np.ascontiguousarray(blocks), constraints.turned, constraints.frames, data)
        if symmetric:
            return
        start = assembler.indptr
        for node, slope in zip(self.nodes, self.normal_slope, strict=True):
            if slope:
                normal_row = data[start[2 * node] : start[2 * node + 1]]
                data[start[2 * node + 1] : start[2 * node + 2]] -= slope * normal_row

    def find_area_blocks(self) -> tuple[IntArray, FloatArray]:
        """Return how friction depends on the areas of straight edges, as pairs of nodes and blocks (contract.py)."""
        straight = [of for of in self.by_area if not find_cell(1, of.edges).is_quadratic]
        found = [of.find_blocks(self.points, self.depth) for of in straight]
        pairs, blocks = (np.concatenate(each) for each in zip(*found, strict=True)) if found else _NO_BLOCKS
        return pairs, blocks


def _pad(by_tool: list[FloatArray]) -> FloatArray:
    """Stack each tool's values by segment into (n_tools, most segments), zero beyond the tool's last."""
    padded = np.zeros((len(by_tool), max((len(values) for values in by_tool), default=0)))
    for row, values in zip(padded, by_tool, strict=True):
        row[: len(values)] = values
    return padded


class Friction:
    """The friction of one run; what persists is ContactArrays.drag."""

    def __init__(self, model: Model, contact: Contact) -> None:
        self._model = model
        self._contact = contact
        self.is_needed = any(t.friction.law not in ("frictionless", "sticking") for t in model.plane_tools)
        edges = model.mesh.boundary_edges
        length = np.linalg.norm(model.mesh.points[edges[:, 1]] - model.mesh.points[edges[:, 0]], axis=1)
        self._slip = ELASTIC_SLIP * float(length.min(initial=np.inf))
        self._m, self._mu = (_pad([t.friction_by_segment()[i] for t in model.plane_tools]) for i in (0, 1))
        laws = [t.friction.law for t in model.plane_tools]
        self._by_shear = np.array([law in ("shear", "coulomb_capped") for law in laws], dtype=bool)
        self._by_push = np.array([law in ("coulomb", "coulomb_capped") for law in laws], dtype=bool)
        self._has_friction = np.array([law not in ("frictionless", "sticking") for law in laws], dtype=bool)
        self._of_pressure = [t for t, tool in enumerate(model.plane_tools) if not is_plain(tool.friction)]
        self.sliding = Sliding(model.plane_tools, len(contact.nodes))
        self._factor: FloatArray | None = None
        self.softness = 1.0
        """How many times softer than they are the springs are taken, during the iteration to equilibrium."""
        self.lost = 0.0
        """What friction has taken in the last converged increment [N mm]."""
        self._shear_flow = np.zeros(len(contact.nodes))
        self._bond = np.zeros(len(contact.nodes))
        self._slip_before = np.zeros(len(contact.nodes))  # in the last iteration of this increment
        self._force_before = np.zeros(len(contact.nodes))
        self._used = np.ones(len(contact.nodes))
        self.lost_at = np.zeros(len(contact.nodes))
        """Work lost at each candidate in the last converged increment (n_candidates,) [N mm]."""
        self._slid = np.zeros(len(contact.nodes))

    @property
    def has_factors(self) -> bool:
        """Whether m or mu of any tool depends on speed, path or temperature."""
        return self.sliding.is_needed or self.sliding.needs_temperature

    @property
    def drag(self) -> Drag:
        """Friction of the candidates in the last iteration."""
        return Drag(np.abs(self._force_before), self._used)

    def begin_increment(self, state_n: State, flow_stress: FloatArray, temperature: FloatArray | None) -> None:
        """Take shear flow stress and factors of every candidate.

        flow_stress, temperature: at the nodes (n_points,) [MPa], [degrees C].
        """
        self._factor = self.find_factors(state_n, temperature) if self._of_pressure else None
        self._slip_before[:], self._force_before[:], self._used[:] = 0.0, 0.0, 1.0
        if self.is_needed:
            self._shear_flow = flow_stress[self._contact.nodes] / np.sqrt(3.0)
            slip = np.abs(state_n.nodes.increment[self._contact.nodes]).max(axis=1)
            self._bond = BOND_SOFTENING / np.maximum(slip, self._slip)

    def find_factors(self, state: State, temperature: FloatArray | None) -> FloatArray:
        """Return what m and mu are multiplied by at each candidate, whatever its pressure (n_tools, n_candidates).

        temperature: at the nodes (n_points,) [degrees C], if it is known.
        """
        return self.sliding.find_factors(state, None if temperature is None else temperature[self._contact.nodes])

    def _places(self, trial: State, held_alone: BoolArray) -> tuple[IndexArray, IndexArray]:
        """Return places among the candidates, and tools, of the nodes that friction acts on."""
        face, place = np.nonzero((trial[ContactArrays].status == SLIDING) & held_alone)
        rough = self._has_friction[face // 2]
        return place[rough], face[rough]

    def evaluate(
        self, state_n: State, trial: State, displacement: FloatArray, reaction: FloatArray, free: BoolArray
    ) -> FrictionForces:
        """Return the friction at a guess; `free` marks nodes (n_points,) whose tangential freedom is not prescribed."""
        touch = trial[ContactArrays]
        contact = self._contact
        place, face = self._places(trial, free[contact.nodes])
        tool, nodes = face // 2, contact.nodes[place]
        normal = contact.normal[face, place]
        tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        points = self._model.mesh.points
        # 1. slip since the start of the increment
        moved = displacement[nodes] - state_n.nodes.displacement[nodes]
        carried = contact.carry(state_n, trial, tool, points[nodes] + state_n.nodes.displacement[nodes])
        slip = np.einsum("ni,ni->n", tangent, moved - carried)
        # 2. what the law allows
        held = np.zeros(len(displacement), dtype=bool)
        held[contact.nodes[(touch.status > 0).any(axis=0)]] = True
        edges = self._model.mesh.boundary_edges
        deformed = points + displacement
        touching = edges[held[edges].all(axis=1)]
        part = np.ones(len(displacement))
        part[contact.nodes] = touch.shear_part
        part = part[touching].min(axis=1)
        area = edge_shares(self._model, deformed, touching, part)[nodes]
        beside = edge_shares(self._model, deformed, edges)[nodes]
        push = np.maximum(np.einsum("ni,ni->n", normal, reaction[nodes]), 0.0)
        segment = contact.segment[face, place]
        m, mu = self._m[tool, segment], self._mu[tool, segment]
        by_shear = np.where(self._by_shear[tool], m * self._shear_flow[place] * area, np.inf)
        by_push = np.where(self._by_push[tool], mu * push, np.inf)
        limit, rise = np.minimum(by_shear, by_push), np.where(by_push < by_shear, mu, 0.0)
        for t in self._of_pressure:
            own = tool == t
            limit[own], rise[own] = self._limit_by_pressure(t, m[own], mu[own], push[own], area[own], place[own])
        # 3. hang or slide
        stiffness = self._shear_flow[place] * beside / (self._slip * self.softness)
        spring = state_n[ContactArrays].drag[place] - stiffness * slip
        returned = return_to_limit(spring, limit)
        force, slides = returned.force, returned.slides
        slope = np.where(slides & (push > 0), rise * returned.along, 0.0)
        on_diagonal, slope = self._tangent(place, limit, stiffness, slides, slope)
        turned_round = slides & (force * self._force_before[place] < 0)
        if self._model.solver.friction_tangent == "return_mapping":
            chord = np.abs(force - self._force_before[place])
            change = np.abs(slip - self._slip_before[place])
            on_diagonal = np.where(turned_round, np.minimum(chord / np.maximum(change, 1e-300), stiffness), on_diagonal)
        self._slip_before[place], self._force_before[place] = slip, force
        self._used[place] = np.abs(force) / np.maximum(limit, 1e-300)
        # 4. what depends on areas: the limit by the part that touches, the spring by all edges beside
        by_limit, by_spring = (np.zeros_like(deformed) for _ in range(2))
        of_area = 1.0 - rise * push / np.maximum(limit, 1e-300)  # part of the limit that goes with the area
        at_limit, spring_only = slides & (of_area != 0.0), ~slides
        by_limit[nodes[at_limit]] = (of_area * force / np.maximum(area, 1e-300))[at_limit, None] * tangent[at_limit]
        of_spring = (force - state_n[ContactArrays].drag[place]) / np.maximum(beside, 1e-300)
        by_spring[nodes[spring_only]] = of_spring[spring_only, None] * tangent[spring_only]
        by_area = ByArea(touching, part, by_limit), ByArea(edges, np.ones(len(edges)), by_spring)
        depth = None if self._model.analysis == "axisymmetric" else self._model.depth
        return FrictionForces(nodes, tool, tangent, slip, force, on_diagonal, slope, deformed, depth, by_area)

    def _limit_by_pressure(
        self, t: int, m: FloatArray, mu: FloatArray, push: FloatArray, area: FloatArray, place: IndexArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the largest friction of a tool at nodes (n,) [N], and its derivative by their push (n,)."""
        assert self._factor is not None
        factor, safe = self._factor[t, place], np.maximum(area, 1e-300)
        law = self._model.plane_tools[t].friction
        stress, rise = limit_stress(law, m * factor, mu * factor, push / safe, self._shear_flow[place])
        return np.where(area > 0.0, stress * area, 0.0), np.where(area > 0.0, rise, 0.0)

    def _tangent(
        self, place: IndexArray, limit: FloatArray, stiffness: FloatArray, slides: BoolArray, slope: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        kind = self._model.solver.friction_tangent
        if kind == "return_mapping":
            return np.where(slides, 0.0, stiffness), slope
        if kind == "bond":
            return np.where(slides, limit * self._bond[place], stiffness), np.zeros(len(limit))
        return np.zeros(len(limit)), np.zeros(len(limit))

    def end_increment(self, state_n: State, trial: State, free: BoolArray) -> None:
        """Keep the friction of a converged state for the next increment."""
        touch = trial[ContactArrays]
        self.lost = 0.0
        self.lost_at[:], self._slid[:] = 0.0, 0.0
        touch.drag[:] = 0.0
        if self.is_needed:
            place, _ = self._places(trial, free[self._contact.nodes])
            friction = self.evaluate(state_n, trial, trial.nodes.displacement, trial.nodes.reaction, free)
            touch.drag[place], self._slid[place] = friction.force, np.abs(friction.slip)
            self.lost_at[place] = -0.5 * (state_n[ContactArrays].drag[place] + friction.force) * friction.slip
            self.lost = -0.5 * float((state_n[ContactArrays].drag[place] + friction.force) @ friction.slip)

    def commit(self, state_n: State, trial: State, dt: float) -> None:
        """Keep how far and how fast nodes have slid in an increment of dt [s]."""
        self.sliding.advance(state_n, trial, self._slid, dt)
