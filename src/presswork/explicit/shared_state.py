# SPDX-License-Identifier: Apache-2.0
"""The state of an explicit loop whose mesh is divided over ranks: brought together in a whole loop, and handed out.

Rows of nodes, elements and edges come from the rank that answers for them. Each rank has a share of sums, such as work;
the rest is the same on all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork.ranks.parts import Part
from presswork.ranks.world import World

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.intp]
Ranks = npt.NDArray[np.integer[Any]]
State = dict[str, dict[str, Array]]
Name = tuple[str, str]
"""Owner and name."""
COUNTED = {"loop": {"work"}, "contact": {"friction", "damping", "squeeze", "external", "drag"}, "beads": {"work"}}
"""What each rank counts a share of, beside the forces of a sheet on its tools."""
OF_NODES = {"contact": ("half", "held", "room"), "tool": ("hint", "pairs"), "wall": ("force", "wake")}
"""What has a row, or a slot, for each node, beside what the owner `nodes` has."""

OF_POINTS = ("spring", "direction", "cell", "weight")
"""What drawbeads have of each point, which goes from rank to rank with the sheet beneath it."""


class SharedState:
    """A whole loop on every rank, and the rank's own loop on its part."""

    def __init__(self, whole: Any, own: Any, part: Part, world: World) -> None:
        self.whole, self.own, self._part, self._world = whole, own, part, world
        self.blocks = [block for block, elements in enumerate(part.elements) if len(elements)]
        """Blocks of the whole loop that the rank's own loop has."""
        self.n_walls = 0
        self._to_all = True
        self._answers = part.owner[part.nodes] == world.rank

    def bring_together(self, *, to_all: bool) -> None:
        """Let the whole loop, of all ranks or of rank 0, have the present state; all of them call this."""
        self._to_all, reads = to_all, to_all or self._world.rank == 0
        own, whole = self.own.state(), self.whole.state()
        nodes = [(whole[o][n], own[o][n]) for o, n in _list_of_nodes(own)]
        self._gather([*nodes, *(sums := self._list_sums_of_nodes())], self._answers, self._part.owner)
        for block, elements in enumerate(self._part.elements):
            answers, names = self._part.element_owner[block], whole[f"block_{block}"]
            found = own[f"block_{self.blocks.index(block)}"] if block in self.blocks else {}
            pairs = [(names[n], found.get(n, np.zeros((0, *names[n].shape[1:])))) for n in names]
            self._gather(pairs, answers[elements] == self._world.rank, answers)
        if edges := _list_of_edges(own):
            of_own, _, owner = self.find_edges()
            self._gather([(whole[o][n], own[o][n]) for o, n in edges], of_own == self._world.rank, owner)
        if beads := own.get("beads"):
            found, owner = [(whole["beads"][n], beads[n]) for n in OF_POINTS], self._find_owners_of_points(beads)
            self._gather(found, owner == self._world.rank, owner)
        counted = _list_counted(own)
        for (o, n), total in zip(counted, self._add_up([own[o][n] for o, n in counted]), strict=True):
            whole[o][n] = total
        for o, n in _list_common(own):
            whole[o][n] = own[o][n]
        if reads:
            self.whole.restore(whole)
            self._keep_sums_of_nodes([of_whole for of_whole, _ in sums])

    def gather_nodes(self, own: Array, *, to_all: bool = False) -> Array | None:
        """Return on rank 0, or on all, the rows (n_nodes, ...) of all ranks' nodes, of those of each's own loop."""
        return self._gather_rows(own, self._answers, self._part.owner, to_all=to_all)

    def gather_elements(self, block: int, read: Callable[[int], Array], shape: tuple[int, ...]) -> Array | None:
        """Return on rank 0 what `read` gives of each element (n, *shape) of a block, by its number in the own loop."""
        own = read(self.blocks.index(block)) if block in self.blocks else np.zeros((0, *shape))
        owner = self._part.element_owner[block]
        return self._gather_rows(own, owner[self._part.elements[block]] == self._world.rank, owner, to_all=False)

    def _gather_rows(self, own: Array, mine: npt.NDArray[np.bool_], owner: Ranks, *, to_all: bool) -> Array | None:
        width = int(np.prod(own.shape[1:], dtype=int))
        counts = (np.bincount(owner, minlength=self._world.size) * width).astype(np.int32)
        gather = self._world.gather if to_all else self._world.gather_to_lead
        found = gather(np.asarray(own[mine], dtype=float).reshape(-1), counts)
        if found is None:
            return None
        whole = np.empty((len(owner), *own.shape[1:]))
        whole[np.argsort(owner, kind="stable")] = found.reshape(len(owner), *own.shape[1:])
        return whole

    def hand_out(self) -> None:
        """Let the rank's own loop have its part of the whole state."""
        own, whole, part = self.own.state(), self.whole.state(), self._part
        for o, n in _list_of_nodes(own):
            own[o][n][: len(part.nodes)] = whole[o][n][part.nodes]
        for number, block in enumerate(self.blocks):
            for n, values in whole[f"block_{block}"].items():
                own[f"block_{number}"][n] = np.ascontiguousarray(values[part.elements[block]])
        for o, n in _list_of_edges(own):
            own[o][n] = np.ascontiguousarray(whole[o][n][self.find_edges()[1]])
        if "beads" in own:
            own["beads"] |= {n: whole["beads"][n] for n in OF_POINTS}
        for o, n in _list_counted(own):
            own[o][n] = whole[o][n] * (self._world.rank == 0)
        for o, n in _list_common(own):
            own[o][n] = whole[o][n]
        self.own.restore(own)
        self.own.force = self.whole.force[part.nodes]
        self.own.reaction_impulse = self.whole.reaction_impulse[part.nodes]

    def find_edges(self) -> tuple[Ranks, Numbers, Ranks]:
        """Return who answers for each of the rank's edges, their numbers in the whole loop, and who for each there."""
        n = len(self._part.owner)
        edges, own = self.whole.edges.astype(np.int64), self._part.nodes[self.own.edges]
        at = np.searchsorted(edges[:, 0] * n + edges[:, 1], own[:, 0] * n + own[:, 1])
        owner = self._part.owner[edges[:, 0]]
        return owner[at], at, owner

    def _find_owners_of_points(self, beads: dict[str, Array]) -> Ranks:
        """Return who answers for each point of drawbeads: for the shell beneath it, which all ranks know."""
        owner: Ranks = np.concatenate(self._part.element_owner)[beads["cell"][:, 0].astype(int)]
        return owner

    def _list_sums_of_nodes(self) -> list[tuple[Array, Array]]:
        """Return pairs of arrays, of the whole loop and the own one, that are summed up though no cycle needs them."""
        found: list[tuple[Array, Array]] = [(self.whole.reaction_impulse, self.own.reaction_impulse)]
        for wall in range(self.n_walls):
            found.append((self.whole.wall_pressed(wall), self.own.wall_pressed(wall)))
            found.append((self.whole.wall_rubbed(wall), self.own.wall_rubbed(wall)))
        return found

    def _keep_sums_of_nodes(self, values: Sequence[Array]) -> None:
        self.whole.reaction_impulse = values[0]
        for wall in range(self.n_walls):
            self.whole.set_wall_sums(wall, values[1 + 2 * wall], values[2 + 2 * wall])

    def _gather(self, pairs: Sequence[tuple[Array, Array]], mine: npt.NDArray[np.bool_], owner: Ranks) -> None:
        """Fill the first len(owner) rows of whole arrays by those rows of the rank's that it answers for."""
        widths = [int(np.prod(whole.shape[1:], dtype=int)) for whole, _ in pairs]
        rows = [own[: len(mine)][mine].reshape(int(mine.sum()), w) for (_, own), w in zip(pairs, widths, strict=True)]
        counts = (np.bincount(owner, minlength=self._world.size) * sum(widths)).astype(np.int32)
        packed = np.concatenate(rows, axis=1)
        gather = self._world.gather if self._to_all else self._world.gather_to_lead
        if (values := gather(packed.reshape(-1), counts)) is None:
            return
        found = values.reshape(-1, sum(widths))
        order = np.argsort(owner, kind="stable")
        for (whole, _), part in zip(pairs, np.split(found, np.cumsum(widths)[:-1], axis=1), strict=True):
            whole[order] = part.reshape(len(order), *whole.shape[1:])

    def _add_up(self, shares: Sequence[Array]) -> list[Array]:
        """Return the sums over ranks of arrays, in the order of the ranks."""
        flat = np.concatenate([share.ravel() for share in shares])
        counts = np.full(self._world.size, len(flat), dtype=np.int32)
        total = self._world.gather(flat, counts).reshape(self._world.size, -1).sum(axis=0)
        parts = np.split(total, np.cumsum([share.size for share in shares])[:-1])
        return [part.reshape(share.shape) for part, share in zip(parts, shares, strict=True)]


def _kind(owner: str) -> str:
    return owner.split("_")[0]


def _list_of_nodes(state: State) -> list[Name]:
    return [
        (owner, name) for owner, of in state.items() for name in of
        if owner == "nodes" or name in OF_NODES.get(_kind(owner), ())
    ]  # fmt: skip


def _list_of_edges(state: State) -> list[Name]:
    return [(owner, name) for owner, of in state.items() for name in of if name.startswith("edge_")]


def _list_counted(state: State) -> list[Name]:
    return [
        (owner, name) for owner, of in state.items() for name in of
        if name in COUNTED.get(owner, ()) or (_kind(owner) == "tool" and name == "force")
    ]  # fmt: skip


def _list_common(state: State) -> Iterable[Name]:
    others = {*_list_of_nodes(state), *_list_of_edges(state), *_list_counted(state)}
    others |= {("beads", name) for name in OF_POINTS}
    for owner, of in state.items():
        if _kind(owner) != "block":
            yield from ((owner, name) for name in of if (owner, name) not in others)
