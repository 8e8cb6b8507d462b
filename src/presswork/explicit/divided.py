# SPDX-License-Identifier: Apache-2.0
"""An explicit loop whose cycles ranks share, called like a loop of the core.

Each rank advances a loop on its part of the mesh (`ranks.parts`). Between calls the whole state is brought together on
every rank, in a whole loop, as soon as anything is asked of it: every rank then reads the same, and takes the same
decisions. What is changed in the whole loop goes to the parts before the next cycles. Both loops number nodes and
elements in the same order, so sums over elements have the same bits for any number of ranks.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.ranks.channel import Channel
from presswork.ranks.parts import Part
from presswork.ranks.world import World

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.intp]
State = dict[str, dict[str, Array]]
Ranks = npt.NDArray[np.integer[Any]]
MOST_TOOLS = 64
CHANGES = {
    "restore", "scale_mass", "set_contact_stiffness", "set_layers", "start_contact", "place_tool", "remove_tool",
}  # fmt: skip
"""Calls that change the state of the whole loop."""
COUNTED = {
    "loop": {"work"},
    "contact": {"friction", "damping", "squeeze", "external", "drag"},
}
"""What each rank counts a share of, beside the forces on tools."""
OF_SLOTS, OF_PAIRS = {"half", "room", "held"}, {"pairs", "hint"}
"""What contact keeps of each node, and each tool of each node."""


class DividedLoop:
    """A whole loop, and the rank's own loop on a part of it."""

    def __init__(self, whole: Any, own: Any, part: Part, world: World) -> None:
        """whole, own: loops with their blocks; own has part's nodes and elements, without the blocks that have none."""
        self._whole, self._own, self._part, self._world = whole, own, part, world
        self._blocks = [block for block, elements in enumerate(part.elements) if len(elements)]
        sent, ghosts = (dict(sorted(of.items())) for of in (part.sent, part.ghosts))
        self._channel = Channel(world, _count(sent), _count(ghosts), 3 * MOST_TOOLS)
        own.join(
            self._channel,
            _join(sent),
            _join(ghosts),
            out=self._channel.out,
            into=self._channel.into,
            shared=self._channel.shared,
            leads=world.rank == 0,
        )
        own.ironing, own.sheet_sizes = whole.ironing, whole.sheet_sizes
        self._pushed: set[int] = set()
        self._tools = 0
        self._whole_is_old, self._own_is_old = False, True
        self._told: Array = np.zeros((0, 0))
        self._forces = np.zeros((0, 3))

    def __getattr__(self, name: str) -> Any:
        """Return what the whole loop has, brought up to date."""
        self.bring_together()
        found = getattr(self._whole, name)
        if name in CHANGES:
            self._own_is_old = True
        return found

    # --- cycles ---------------------------------------------------------------------------------------------------

    def advance(
        self, time: float, dt: float, dt_before: float, force_scale: Array, velocity_scale: Array, *, damping: float
    ) -> tuple[int, _core.LawStatus, int]:
        """Advance as a loop of the core does; return the first failure of all ranks."""
        if self._own_is_old:
            self._hand_out()
        failed, status, cycle = self._own.advance(time, dt, dt_before, force_scale, velocity_scale, damping=damping)
        self._whole_is_old = True
        self._tell(failed, status, cycle)
        when, element, told = min((row[:3] for row in self._told.tolist()), key=lambda row: (row[0], row[1]))
        if np.isinf(when):
            return -1, _core.LawStatus.done, -1
        return int(element), _core.LawStatus(int(told)), int(when)

    def _tell(self, failed: int, status: _core.LawStatus, cycle: int) -> None:
        """Let all ranks know what came of cycles on each: a row (7 + 3 tools) by rank."""
        own = self._own
        lost = own.lost_point
        finite = np.isfinite(own.position[self._part.owner[self._part.nodes] == self._world.rank]).all()
        failure = (cycle, self._name_element(failed), status.value) if failed >= 0 else (np.inf, 0, 0)
        row = [*failure, self._name_point(lost) if lost >= 0 else np.inf, finite, own.bound_frequencies().max()]
        forces = [force for tool in range(self._tools) for force in own.tool_state(tool)[2]]
        counts = np.full(self._world.size, len(row) + len(forces))
        self._told = self._world.gather(np.array([*row, *forces], dtype=float), counts).reshape(self._world.size, -1)
        self._forces = self._told[:, len(row) :].sum(axis=0).reshape(-1, 3)  # multiples of 2^-25 N: exact

    @property
    def highest_frequency(self) -> float:
        """Bound of the squared highest frequency of all elements [1/s2]."""
        if self._whole_is_old:
            return float(self._told[:, 5].max())
        return float(self._whole.bound_frequencies().max())

    @property
    def is_finite(self) -> bool:
        """Whether the positions of all nodes are finite numbers after the last cycles."""
        return bool(self._told[:, 4].all())

    @property
    def lost_point(self) -> int:
        """A point that has gone through a tool; -1: none."""
        if not self._whole_is_old:
            return int(self._whole.lost_point)
        first = self._told[:, 3].min()
        return -1 if np.isinf(first) else int(first)

    @property
    def seconds(self) -> tuple[float, float, float, float]:
        """Wall time of this rank's cycles [s]."""
        found: tuple[float, float, float, float] = self._own.seconds
        return found

    def _name_element(self, element: int) -> int:
        """Return the number in the whole loop of an element of the rank's own."""
        before = 0
        for kept, of in zip(self._part.elements, self._part.element_owner, strict=True):
            if element < len(kept):
                return before + int(kept[element])
            element, before = element - len(kept), before + len(of)
        raise AssertionError("an element of the loop")

    def _name_point(self, point: int) -> int:
        """Return the number in the whole loop of a node, or of the number of nodes + an edge."""
        nodes = self._part.nodes
        return (
            int(nodes[point])
            if point < len(nodes)
            else len(self._part.owner) + int(self._edges()[1][point - len(nodes)])
        )

    # --- what is said to both loops ---------------------------------------------------------------------------------

    def prescribe(self, fixed: npt.NDArray[np.uint8], velocity: Array) -> None:
        """Prescribe velocities of freedoms (n_nodes, freedoms)."""
        self._whole.prescribe(fixed, velocity)
        self._own.prescribe(fixed[self._part.nodes], velocity[self._part.nodes])

    @property
    def velocity(self) -> Array:
        """Velocities (n_nodes, freedoms), half a step back."""
        return self._read("velocity")

    @velocity.setter
    def velocity(self, value: Array) -> None:
        self._write("velocity", value)

    @property
    def force(self) -> Array:
        """Forces from outside (n_nodes, freedoms)."""
        return self._read("force")

    @force.setter
    def force(self, value: Array) -> None:
        self._write("force", value)

    @property
    def internal_force(self) -> Array:
        """Internal forces, less those of tools (n_nodes, freedoms)."""
        return self._read("internal_force")

    @internal_force.setter
    def internal_force(self, value: Array) -> None:
        self._write("internal_force", value)

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms (n_nodes, freedoms)."""
        return self._read("reaction_impulse")

    @reaction_impulse.setter
    def reaction_impulse(self, value: Array) -> None:
        self._whole.reaction_impulse = value
        self._own.reaction_impulse = value[self._part.nodes]

    def _read(self, name: str) -> Array:
        self.bring_together()
        found: Array = getattr(self._whole, name)
        return found

    def _write(self, name: str, value: Array) -> None:
        self.bring_together()
        setattr(self._whole, name, value)
        self._own_is_old = True

    def set_slower(self, factor: float) -> None:
        """Let laws take their rates by another time."""
        self._whole.set_slower(factor)
        self._own.set_slower(factor)

    def set_temperature(self, block: int, temperature: Array) -> None:
        """Give the points of a block's elements temperatures (n, ...) [degrees C]."""
        self._whole.set_temperature(block, temperature)
        if block in self._blocks:
            part = np.ascontiguousarray(temperature[self._part.elements[block]])
            self._own.set_temperature(self._blocks.index(block), part)

    def add_tool(self, surface: _core.ToolSurface, **grip: Any) -> int:
        """Add a rigid tool; return its number."""
        if self._tools == MOST_TOOLS:
            raise ExplicitError(f"ranks share at most {MOST_TOOLS} tools")
        self.bring_together()
        self._own_is_old = True
        self._own.sheet_sizes = self._whole.sheet_sizes if self._tools == 0 else self._own.sheet_sizes
        self._own.add_tool(surface, **grip)
        self._tools += 1
        return int(self._whole.add_tool(surface, **grip))

    def remove_tool(self, tool: int) -> None:
        """Take a tool away."""
        self.bring_together()
        self._own_is_old = True
        for loop in (self._whole, self._own):
            loop.remove_tool(tool)
        self._pushed.discard(tool)
        self._count_sums()

    def _count_sums(self) -> None:
        """Let ranks share the forces on tools in every cycle where a force places one."""
        self._channel.sums = 3 * self._tools if self._pushed else 0

    def push_tool(self, tool: int, direction: list[float], mass: float, drag: float) -> None:
        """Let a force place a tool."""
        for loop in (self._whole, self._own):
            loop.push_tool(tool, direction, mass, drag)
        self._pushed.add(tool)
        self._count_sums()

    def stop_tool(self, tool: int, other: int, furthest: float) -> None:
        """Let a pushed tool stand on another."""
        for loop in (self._whole, self._own):
            loop.stop_tool(tool, other, furthest)

    def move_tool(self, tool: int) -> None:
        """Let velocities move a tool again."""
        for loop in (self._whole, self._own):
            loop.move_tool(tool)
        self._pushed.discard(tool)
        self._count_sums()

    def drive_tool(self, tool: int, drive: Array) -> None:
        """Say what the next cycles do with a tool."""
        self._own.drive_tool(tool, drive)

    def tool_state(self, tool: int) -> tuple[Any, Any, Any]:
        """Return displacement [mm], velocity [mm/s] and the sheet's force [N] of a tool."""
        if not self._whole_is_old:
            found: tuple[Any, Any, Any] = self._whole.tool_state(tool)
            return found
        place, velocity, _ = self._own.tool_state(tool)
        return place, velocity, self._forces[tool]

    # --- the whole state and its parts ------------------------------------------------------------------------------

    def bring_together(self) -> None:
        """Let the whole loop have the present state of all ranks; all of them call this."""
        if not self._whole_is_old:
            return
        self._whole_is_old = False
        own, part, rank = self._own.state(), self._part, self._world.rank
        whole: State = self._whole.state()
        mine = part.owner[part.nodes] == rank
        nodes = self._find_node_arrays(own, whole)
        whole_impulse, own_impulse = np.empty_like(self._whole.reaction_impulse), self._own.reaction_impulse
        self._gather_rows(
            [*((whole[o][n], own[o][n]) for o, n in nodes), (whole_impulse, own_impulse)], mine, part.owner
        )
        for block, kept in enumerate(part.elements):
            owner = part.element_owner[block]
            of_own = own[f"block_{self._blocks.index(block)}"] if block in self._blocks else {}
            names = whole[f"block_{block}"]
            pairs = [(names[name], of_own.get(name, np.zeros((0, *names[name].shape[1:])))) for name in names]
            self._gather_rows(pairs, owner[kept] == rank, owner)
        self._gather_edges(own, whole)
        self._sum_up(own, whole)
        self._whole.restore(whole)
        self._whole.reaction_impulse = whole_impulse

    def _gather_rows(self, pairs: Iterable[tuple[Array, Array]], mine: npt.NDArray[np.bool_], owner: Ranks) -> None:
        """Fill the first len(owner) rows of whole arrays by those rows of the rank's that it answers for."""
        listed = list(pairs)
        if not listed:
            return
        rows = [array[: len(mine)][mine].reshape(int(mine.sum()), -1) for _, array in listed]
        widths = [int(np.prod(array.shape[1:], dtype=int)) for array, _ in listed]
        packed = np.concatenate(rows, axis=1) if len(rows[0]) else np.zeros((0, sum(widths)))
        counts = (np.bincount(owner, minlength=self._world.size) * sum(widths)).astype(np.int32)
        found = self._world.gather(packed.reshape(-1), counts).reshape(-1, sum(widths))
        order = np.argsort(owner, kind="stable")
        for (array, _), part in zip(listed, np.split(found, np.cumsum(widths)[:-1], axis=1), strict=True):
            array[order] = part.reshape(len(order), *array.shape[1:])

    def _gather_edges(self, own: State, whole: State) -> None:
        names = [(o, n) for o in whole for n in whole[o] if n.startswith("edge_")]
        if names:
            of_own, _, owner = self._edges()
            self._gather_rows([(whole[o][n], own[o][n]) for o, n in names], of_own == self._world.rank, owner)

    def _edges(self) -> tuple[Ranks, Numbers, Ranks]:
        """Return of each of the rank's edges who answers for it and its number in the whole loop; owners of all."""
        n = len(self._part.owner)
        edges, own = self._whole.edges.astype(np.int64), self._part.nodes[self._own.edges]
        at = np.searchsorted(edges[:, 0] * n + edges[:, 1], own[:, 0] * n + own[:, 1])
        owner = self._part.owner[edges[:, 0]]
        return owner[at], at, owner

    def _sum_up(self, own: State, whole: State) -> None:
        """Take what is the same on all ranks, and sum up what each counts a share of."""
        names = list(_find_counted(own))
        shares = np.concatenate([own[o][n].ravel() for o, n in names])
        found = self._world.gather(shares, np.full(self._world.size, len(shares))).reshape(self._world.size, -1)
        total, first = found.sum(axis=0), 0
        for o, n in names:
            whole[o][n] = total[first : first + own[o][n].size].reshape(own[o][n].shape)
            first += own[o][n].size
        for o, n in _find_common(own):
            whole[o][n] = own[o][n]

    def _find_node_arrays(self, own: State, whole: State) -> list[tuple[str, str]]:
        """Return owners and names of arrays that have a row for each node, or for each slot of contact."""
        found = [("nodes", name) for name in own["nodes"]]
        if "contact" in own:
            found += [("contact", name) for name in sorted(OF_SLOTS)]
            found += [(o, name) for o in own if o.startswith("tool_") for name in sorted(OF_PAIRS)]
        return found

    def _hand_out(self) -> None:
        """Let the rank's own loop have its part of the whole state."""
        self._own_is_old = False
        whole, part = self._whole.state(), self._part
        own: State = self._own.state()
        for o, n in self._find_node_arrays(own, whole):
            own[o][n][: len(part.nodes)] = whole[o][n][part.nodes]
        for number, block in enumerate(self._blocks):
            for n in own[f"block_{number}"]:
                own[f"block_{number}"][n] = np.ascontiguousarray(whole[f"block_{block}"][n][part.elements[block]])
        edges = [(o, n) for o in own for n in own[o] if n.startswith("edge_")]
        for o, n in edges:
            own[o][n] = np.ascontiguousarray(whole[o][n][self._edges()[1]])
        for o, n in _find_counted(own):
            own[o][n] = whole[o][n] * (self._world.rank == 0)
        for o, n in _find_common(own):
            own[o][n] = whole[o][n]
        self._own.restore(own)
        self._own.force = self._whole.force[part.nodes]
        self._own.reaction_impulse = self._whole.reaction_impulse[part.nodes]


def _find_counted(state: State) -> Iterable[tuple[str, str]]:
    """Return owners and names of what each rank counts a share of."""
    for owner, arrays in state.items():
        for name in arrays:
            if name in COUNTED.get(owner, ()) or (owner.startswith("tool_") and name == "force"):
                yield owner, name


def _find_common(state: State) -> Iterable[tuple[str, str]]:
    """Return owners and names of what is the same on all ranks."""
    counted = set(_find_counted(state))
    for owner, arrays in state.items():
        if owner == "nodes" or owner.startswith("block_"):
            continue
        for name in arrays:
            if (
                name not in OF_SLOTS | {"pairs", "hint"}
                and not name.startswith("edge_")
                and (owner, name) not in counted
            ):
                yield owner, name


def _join(lists: dict[int, Numbers]) -> npt.NDArray[np.int32]:
    return np.concatenate([np.zeros(0, np.intp), *lists.values()]).astype(np.int32)


def _count(lists: dict[int, Numbers]) -> dict[int, int]:
    return {rank: len(nodes) for rank, nodes in lists.items()}
