# SPDX-License-Identifier: Apache-2.0
"""Contact of the nodes of a shell with rigid tools in space, and Coulomb friction.

A node touches where the gap between the tool and the sheet's surface, half a thickness off the node, closes. What
holds it is a part c of the sheet's elasticity across its thickness, k = c E A / t with A the node's share of the
surface and c = SolverSettings.contact_stiffness (space_contact.py has the forces). So a sheet may lie between two
tools, which exact constraints would not allow. It sinks in by t p / (c E) under a pressure p.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from presswork.body.contract import Look, Near
from presswork.body.shell_arrays import ShellArrays
from presswork.body.shells import ShellMechanics
from presswork.interaction.space.drawbeads import SheetBeads
from presswork.interaction.space.space_contact import SpaceContact, SpaceForces
from presswork.interaction.space.space_touch import TouchingNodes, choose_touched
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import FloatArray, IndexArray, IntArray, Model, find_cell
from presswork.state import Arrays, State

ROUNDING = 1e-3
"""Gap over the thickness below which a node begins to touch."""

FARTHEST_LED = 2.0
"""Thicknesses from a tool within which a node of a guess is led back to it."""

DEPTH = 2.0
"""Thicknesses that a node of a guess may lie in a tool and be found: behind that is another wall."""


class SheetContact(SpaceContact):
    """The tools in space of a sheet, and its drawbeads; what persists lies in the State."""

    def __init__(self, model: Model, cells: ShellMechanics) -> None:
        super().__init__(model, cells, DEPTH * model.thickest)
        self._shells = cells
        self._nodes = SheetNodes(model)
        self.beads = SheetBeads(model)

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of tools and beads that have not moved and touch nothing."""
        return (*super().at_rest(), self.beads.at_rest())

    def begin_increment(self, state_n: State) -> None:
        """Take the thickness at the nodes as it is when the increment begins."""
        super().begin_increment(state_n)
        self._nodes.begin_increment(state_n)
        self.beads.begin_increment(state_n)
        self._law_gap = None

    def _look(self, looks: Sequence[Look], x: FloatArray) -> list[Near]:
        return self._shells.look_near(looks, x)

    def predict(self, found: SpaceForces) -> None:
        """Take the law's tangent where a correction asks for it, at the next guess."""
        self._law_gap = found.law_gap

    def count_undecided(self, trial: State, found: SpaceForces, displacement: FloatArray, pull: float) -> int:
        """Return how many nodes the tangent of the law pushes otherwise than the law, by more than `pull` [N]."""
        x, placed, n_undecided = self._model.mesh.points + displacement[:, :3], trial[SpaceToolArrays], 0
        pushed = np.linalg.norm(found.by_tool - found.friction, axis=2)
        touching = self._nodes.touching()
        for t, near in enumerate(self._look_at_all(placed, touching.farthest, x)):
            touched = choose_touched(near, touching)
            n_undecided += int((np.abs(touched.push - pushed[t, touched.nodes]) > pull).sum())
        return n_undecided

    def lead(self, state_n: State, trial: State, guess: FloatArray) -> FloatArray:
        """Return a first guess (n_points, 6) with each node that touched a tool where it pushes as it did.

        Other nodes that the guess puts into a tool are put on it. A node moves along the tools' normals; one between
        two tools to the mean of the two places. trial: has the tools where they go.
        """
        self.begin_increment(state_n)
        x = self._model.mesh.points + state_n.nodes.displacement[:, :3] + guess[:, :3]
        move, tools = np.zeros_like(x), np.zeros(len(x))
        before, placed = state_n[SpaceToolArrays], trial[SpaceToolArrays]
        touching, reach = self._nodes.touching(), FARTHEST_LED * float(self._nodes.thickness.max())
        for t, (gap, normal) in enumerate(self._look_at_all(placed, reach, x)):
            push = np.linalg.norm(before.force[t] - before.friction[t], axis=1)
            missing = np.where(push > 0.0, touching.gap_at(push), 0.0) - (gap - touching.reach)
            led = np.isfinite(gap) & ((push > 0.0) | (missing > 0.0))
            move[led] += missing[led, None] * normal[led]
            tools[led] += 1.0
        led_guess = guess.copy()
        led_guess[:, :3] += move / np.maximum(tools, 1.0)[:, None]
        return led_guess

    def _look_at_all(self, placed: SpaceToolArrays, reach: float, x: FloatArray) -> list[Near]:
        """Return what is found of the nodes at x (n_points, 3) within a reach [mm] of each tool where it is placed."""
        return self._look([(self.placed(t, placed).nearest, reach) for t in range(len(self._surfaces))], x)

    def touching(self, tool: int) -> TouchingNodes:
        """Return what the contact with a tool must know of the nodes."""
        return self._nodes.touching()

    def evaluate(
        self, state_n: State, trial: State, displacement: FloatArray, stage: int = 0, fraction: float = 0.0
    ) -> SpaceForces:
        """Return the forces of tools and beads at a guess; tools stand where the trial state has them."""
        found = self.touch_all(state_n, trial, displacement)
        beads = self.beads.evaluate(state_n, trial, displacement, self.beads.share(stage, fraction))
        force = np.zeros_like(found.force)
        force[:, :3] = found.by_tool.sum(axis=0) + beads.force
        block = np.zeros((len(beads.pairs), *found.blocks.shape[1:]))
        block[:, :3, :3] = beads.blocks
        return replace(
            found,
            force=force,
            pairs=np.concatenate([found.pairs, beads.pairs]),
            blocks=np.concatenate([found.blocks, block]),
            tool=np.concatenate([found.tool, np.full(len(block), -1, dtype=np.int32)]),
            beads=beads,
        )

    def end_increment(self, trial: State, found: SpaceForces) -> None:
        """Keep what an increment has found."""
        super().end_increment(trial, found)
        assert found.beads is not None
        self.beads.end_increment(trial, found.beads)

    def held_directions(
        self, state: State, pushed_along: Mapping[int, FloatArray], least: float, *, lying: bool
    ) -> tuple[IndexArray, FloatArray]:
        """Return nodes (n,) and vectors (n, 3) along which beads and tools hold them; rough tools in all three."""
        nodes, directions = super().held_directions(state, pushed_along, least, lying=lying)
        beneath, across = self.beads.held_directions()
        return np.concatenate([beneath, nodes]), np.concatenate([across, directions])

    def work(self, state_n: State, trial: State) -> tuple[float, float]:
        """Return the work of tools and beads in an increment, by their own motion, and what friction takes [N mm]."""
        of_tools, lost = super().work(state_n, trial)
        carried, restrained = self.beads.work(state_n, trial)
        return of_tools + carried, lost + restrained

    def depths(self, state: State) -> FloatArray:
        """Return how deep the sheet's surface is in each tool at a converged state (n_tools,) [mm]."""
        self.begin_increment(state)
        x = self._model.mesh.points + state.nodes.displacement[:, :3]
        half = 0.5 * (self._nodes.thickness + self._nodes.relief)
        found = np.zeros(len(self._model.space_tools))
        for t in range(len(self._surfaces)):
            gap, _ = self.placed(t, state[SpaceToolArrays]).nearest(x, float(half.max()))
            found[t] = max(0.0, -float((gap - half).min()))
        return found


class SheetNodes:
    """What contact must know of the nodes of one run's sheet: their share of its surface, and its thickness there."""

    def __init__(self, model: Model) -> None:
        self._model = model
        n = len(model.mesh.points)
        self._area, self._cells = np.zeros(n), np.zeros(n)
        for block in model.mesh.blocks:
            self._area += share_surface(model.mesh.points, block.connectivity)
            np.add.at(self._cells, block.connectivity, 1.0)
        self._stiffness = model.solver.contact_stiffness * max(m.young for m in model.materials)
        self.thickness = np.zeros(n)
        """When the increment begins (n_points,) [mm]."""
        self.relief = np.zeros(n)
        """How much nearer tools are to each other than they are drawn (n_points,) [mm]."""
        for block, relief in zip(model.mesh.blocks, model.find_relief(), strict=True):
            np.add.at(self.relief, block.connectivity, relief[:, None])
        self.relief /= np.maximum(self._cells, 1.0)

    def begin_increment(self, state_n: State) -> None:
        """Take the thickness at the nodes as it is when the increment begins."""
        total = np.zeros_like(self._cells)
        for block, thickness in zip(self._model.mesh.blocks, state_n[ShellArrays].thickness, strict=True):
            np.add.at(total, block.connectivity, thickness.mean(axis=1)[:, None])
        self.thickness = total / np.maximum(self._cells, 1.0)

    def touching(self) -> TouchingNodes:
        """Return what contact must know of the nodes."""
        nodes = sheet_nodes(self._area, self.thickness, self._stiffness)
        return replace(nodes, reach=nodes.reach + 0.5 * self.relief) if self.relief.any() else nodes


def sheet_nodes(area: FloatArray, thickness: FloatArray, stiffness: float) -> TouchingNodes:
    """Return what contact must know of a sheet's nodes.

    area: share of the surface (n_points,) [mm2]. thickness: (n_points,) [mm]. stiffness: of contact, per area and
    thickness [MPa].
    """
    return TouchingNodes(stiffness * area / thickness, 0.5 * thickness, ROUNDING * thickness, area)


def share_surface(points: FloatArray, connectivity: IntArray, weight: FloatArray | float = 1.0) -> FloatArray:
    """Return each node's share of the surface (n_points,) [mm2], times a weight of cells: of each node the same."""
    share = np.zeros(len(points))
    np.add.at(share, connectivity, (weight * _cell_areas(points, connectivity) / connectivity.shape[1])[:, None])
    return share


def _cell_areas(points: FloatArray, connectivity: IntArray) -> FloatArray:
    """Return the areas of flat triangles or quadrilaterals, by their corners [mm2]."""
    one, other = (
        points[connectivity[:, last]] - points[connectivity[:, first]]
        for first, last in find_cell(2, connectivity).spans
    )
    return np.asarray(0.5 * np.linalg.norm(np.cross(one, other), axis=1))
