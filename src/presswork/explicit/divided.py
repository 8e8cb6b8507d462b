# SPDX-License-Identifier: Apache-2.0
"""An explicit loop whose cycles ranks share, called like a loop of the core.

Each rank advances a loop on its part of the mesh (`ranks.parts`). Between calls the whole state is brought together on
every rank, in a whole loop, as soon as all ranks ask anything of it: every rank then reads the same, and takes the same
decisions. What is changed in the whole loop goes to the parts before the next cycles. While rank 0 does something
alone, such as a row of the history, it asks the others for the arrays that it reads, and they come to it alone. Both
loops number nodes and elements in the same order, so forces have the same bits for any number of ranks.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.shared_state import SharedState
from presswork.model import IntArray
from presswork.ranks.channel import Channel
from presswork.ranks.parts import Part
from presswork.ranks.world import World

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.intp]
MOST_TOOLS = 64
CHANGES = {"restore", "scale_mass", "set_contact_stiffness", "set_layers", "start_contact", "place_tool"}
"""Calls that change the state of the whole loop."""
FOR_BOTH = {
    "begin_wall_sums", "float_wall", "hold_wall", "move_tool", "move_wall", "place_wall", "push_tool", "push_wall",
    "limit_contact_friction", "remove_tool", "set_contact_step", "set_slower", "stop_tool",
}  # fmt: skip
"""Calls that are made alike on the whole loop and on the parts."""
OF_CONTACTS = {
    "contact_area", "contact_impulse", "contact_passed", "contact_pressure", "contact_push", "contact_rub",
    "contact_shear", "contact_work",
}  # fmt: skip
STATE = "state"
ENERGIES = ("kinetic", "internal", "hourglass", "external", "damping", "contact", "friction")
ARRAYS = ("velocity", "force", "internal_force")
"""Properties of the whole loop (n_nodes, freedoms) that are set, and then handed out."""


class DividedLoop:
    """A whole loop, and the rank's own loop on a part of it; as it stands, of solids in the plane."""

    sums_of_wall = 2
    """Numbers of a wall that ranks sum up in each cycle."""
    pulled: frozenset[str] = frozenset({"position"})
    """What rank 0 asks for by itself; where it reads anything else, the whole state comes to it."""

    def __init__(self, whole: Any, own: Any, part: Part, world: World, *, width: int) -> None:
        """whole, own: loops with their blocks; own has part's nodes and elements, without the blocks that have none.

        width: numbers that ranks exchange for a node (cpp/explicit/neighbours.hpp).
        """
        self._whole, self._own, self._part, self._world = whole, own, part, world
        self._state = SharedState(whole, own, part, world)
        sent, ghosts = (dict(sorted(of.items())) for of in (part.sent, part.ghosts))
        self._channel = Channel(world, _count(sent), _count(ghosts), 4 * MOST_TOOLS, width)
        own.join(
            self._channel,
            _join(sent),
            _join(ghosts),
            out=self._channel.out,
            into=self._channel.into,
            shared=self._channel.shared,
            leads=world.rank == 0,
        )
        self._walls = self._contacts = 0
        self._where: Literal["all", "lead", "parts"] = "all"
        """Which whole loops have the present state: of all ranks, of rank 0, or none."""
        self._own_is_old = True
        self._pulled: dict[tuple[Any, ...], Any] = {}
        self._shapes: dict[tuple[Any, ...], tuple[int, ...]] = {}
        self._number = world.register(self)
        self._reported: Array = np.zeros((0, 0))
        """What came of the last cycles on each rank: a row (6 + n) by rank."""
        self._sums = np.zeros(0)
        """Sums of the ranks' forces (n)."""

    def __getattr__(self, name: str) -> Any:
        """Return what the whole loop has, brought up to date."""
        if name.startswith("_"):
            raise AttributeError(name)
        if name in FOR_BOTH:
            return partial(self._call_both, name)
        if name in OF_CONTACTS:  # which every rank computes whole
            self._enter()
            return getattr(self._own, name)
        if name in self.pulled and self._world.leads and self._where == "parts":
            return self._pull(name) if name == "position" else partial(self._pull, name)
        self.bring_together()
        found = getattr(self._whole, name)
        self._own_is_old = self._own_is_old or name in CHANGES
        return found

    def __setattr__(self, name: str, value: Any) -> None:
        """Set an array of the whole loop, to be handed out."""
        if name not in ARRAYS:
            object.__setattr__(self, name, value)
            return
        self.bring_together()
        setattr(self._whole, name, value)
        self._own_is_old = True

    def bring_together(self) -> None:
        """Let the whole loop have the present state; all ranks call this, or rank 0 while it leads, for itself."""
        if self._world.leads:
            if self._where == "parts":
                self._world.ask(self._number, (STATE,))
        elif self._where != "all":
            self._where = "all"
            self._state.bring_together(to_all=True)

    # --- what rank 0 asks for -------------------------------------------------------------------------------------

    def _pull(self, *what: Any) -> Any:
        """Return what rank 0 reads: a name, and the arguments of a method."""
        if what not in self._pulled:
            self._world.ask(self._number, what)
        found = self._pulled[what]
        return found.copy() if isinstance(found, np.ndarray) else found

    def help(self, what: tuple[Any, ...]) -> None:
        """Give rank 0 what it asks for; all ranks call this."""
        name, *given = what
        if name == STATE:
            self._where = "lead"
            self._state.bring_together(to_all=False)
        elif name == "position":
            self._pulled[what] = self._state.gather_nodes(self._own.position)
        else:
            if what not in self._shapes:
                self._shapes[what] = getattr(self._whole, name)(*given).shape[1:]
            read: Callable[[int], Array] = getattr(self._own, name)
            self._pulled[what] = self._state.gather_elements(given[0], read, self._shapes[what])

    def energies(self, dt: float, dt_before: float, **scales: float) -> _core.Energies:
        """Return the energies as a loop of the core does, of which each rank counts a share."""
        if self._where == "all" or self._walls or self._contacts or self._world.leads:
            self.bring_together()
            found: _core.Energies = self._whole.energies(dt, dt_before, **scales)
            return found
        share = self._own.energies(dt, dt_before, **scales)
        own = np.array([getattr(share, name) for name in ENERGIES])
        rows = self._world.gather(own, np.full(self._world.size, len(own), dtype=np.int32))
        return _core.Energies(*rows.reshape(self._world.size, -1).sum(axis=0).tolist())

    def keep(self) -> Callable[[], dict[str, dict[str, Array]]]:
        """Keep the present state; return what goes back to it and gives it, which all ranks call."""
        self._enter()
        own, reported = self._own.state(), (self._reported, self._sums)

        def collect() -> dict[str, dict[str, Array]]:
            self._own.restore(own)
            self._reported, self._sums = reported
            self._where = "parts"
            self.bring_together()
            found: dict[str, dict[str, Array]] = self._whole.state()
            return found

        return collect

    # --- cycles ---------------------------------------------------------------------------------------------------

    def advance(
        self, time: float, dt: float, dt_before: float, force_scale: Array, velocity_scale: Array, *, damping: float
    ) -> tuple[int, _core.LawStatus, int]:
        """Advance as a loop of the core does; return the first failure of all ranks."""
        self._enter()
        self._prepare()
        failed, status, cycle = self._own.advance(time, dt, dt_before, force_scale, velocity_scale, damping=damping)
        self._where = "parts"
        self._pulled.clear()
        self._report(failed, status, cycle)
        when, element, fault = min((row[:3] for row in self._reported.tolist()), key=lambda row: (row[0], row[1]))
        if np.isinf(when):
            return -1, _core.LawStatus.done, -1
        return int(element), _core.LawStatus(int(fault)), int(when)

    def _enter(self) -> None:
        """Let the rank's own loop have its part of the present state."""
        if self._own_is_old:
            self._own_is_old = False
            self._state.hand_out()
            if self._contacts:
                self._own.set_ghost_masses(self._whole.nodal_masses[self._part.nodes])

    def _prepare(self) -> None:
        """Let ranks agree on what the next cycles need."""

    def _find_lost(self) -> float:
        """Return the number in the whole loop of a point of this rank that has gone through a tool; infinity: none."""
        return np.inf

    def _list_forces(self) -> list[float]:
        """Return this rank's part of forces that ranks sum up after cycles [N]."""
        return []

    def _report(self, failed: int, status: _core.LawStatus, cycle: int) -> None:
        """Let all ranks know what came of cycles on each."""
        own, mine = self._own, self._part.owner[self._part.nodes] == self._world.rank
        failure = (cycle, self._name_element(failed), status.value) if failed >= 0 else (np.inf, 0, 0)
        row = [*failure, self._find_lost(), np.isfinite(own.position[mine]).all(), own.bound_frequencies().max()]
        forces = self._list_forces()
        counts = np.full(self._world.size, len(row) + len(forces), dtype=np.int32)
        self._reported = self._world.gather(np.array([*row, *forces], dtype=float), counts).reshape(
            self._world.size, -1
        )
        self._sums = self._reported[:, len(row) :].sum(axis=0)  # of multiples of 2^-25 N: exact

    @property
    def highest_frequency(self) -> float:
        """Bound of the squared highest frequency of all elements [1/s2]."""
        highest = self._whole.bound_frequencies() if self._where == "all" else self._reported[:, 5]
        return float(highest.max())

    @property
    def is_finite(self) -> bool:
        """Whether the positions of all nodes are finite numbers after the last cycles."""
        return bool(self._reported[:, 4].all())

    @property
    def seconds(self) -> tuple[float, float, float, float]:
        """Wall time of this rank's cycles [s]."""
        found: tuple[float, float, float, float] = self._own.seconds
        return found

    def _name_element(self, element: int) -> int:
        """Return the number in the whole loop of an element of the rank's own."""
        return int(self._part.list_elements()[element])

    # --- calls on both loops ----------------------------------------------------------------------------------------

    def _call_both(self, name: str, *given: Any, **named: Any) -> None:
        for loop in (self._whole, self._own):
            getattr(loop, name)(*given, **named)
        self._channel.sums = self._count_sums()

    def _count_sums(self) -> int:
        """Return how many numbers ranks sum up in each cycle."""
        return self.sums_of_wall * self._walls

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms (n_nodes, freedoms) [N s]; nan where rank 0 alone knows it."""
        if self._where == "all" or self._walls or self._world.leads:
            self.bring_together()
            found: Array = self._whole.reaction_impulse
            return found
        own = self._own.reaction_impulse
        found_by_lead = self._state.gather_nodes(own)
        return np.full((len(self._part.owner), own.shape[1]), np.nan) if found_by_lead is None else found_by_lead

    @reaction_impulse.setter
    def reaction_impulse(self, value: Array) -> None:
        self._whole.reaction_impulse = value
        self._own.reaction_impulse = value[self._part.nodes]

    def prescribe(self, fixed: npt.NDArray[np.uint8], velocity: Array) -> None:
        """Prescribe velocities of freedoms (n_nodes, freedoms)."""
        self._whole.prescribe(fixed, velocity)
        self._own.prescribe(fixed[self._part.nodes], velocity[self._part.nodes])

    def set_temperature(self, block: int, temperature: Array) -> None:
        """Give the points of a block's elements temperatures (n, ...) [degrees C]."""
        self._whole.set_temperature(block, temperature)
        if block in self._state.blocks:
            part = np.ascontiguousarray(temperature[self._part.elements[block]])
            self._own.set_temperature(self._state.blocks.index(block), part)

    def add_damage(self, block: int, *law: Any, **start: Any) -> None:
        """Let damage grow at the points of a block."""
        self._whole.add_damage(block, *law, **start)
        if block in self._state.blocks:
            self._own.add_damage(self._state.blocks.index(block), *law, **start)
        self._own_is_old = True

    def add_wall(self, profile: Array, **motion: Any) -> None:
        """Let a rigid tool hold the nodes of the boundary off."""
        self._refuse_more()
        self._whole.add_wall(profile, **motion)
        self._own.add_wall(profile, **motion)
        self._count_wall()

    def add_contact(self, *sides: IntArray, **given: Any) -> None:
        """Let bodies touch; sides: nodes of faces and of the cells behind them, whose motion all ranks know."""
        self.bring_together()
        self._whole.add_contact(*sides, **given)
        self._own.add_contact(*(self._part.number(side) for side in sides), **given)
        self._contacts += 1
        self._own_is_old = True

    def _count_wall(self) -> None:
        self._walls += 1
        self._state.n_walls = self._walls
        self._own_is_old = True
        self._channel.sums = self._count_sums()

    def _refuse_more(self) -> None:
        self.bring_together()
        if self._count_tools() == MOST_TOOLS:
            raise ExplicitError(f"ranks share at most {MOST_TOOLS} tools: compute the case without mpiexec")

    def _count_tools(self) -> int:
        return self._walls


def _join(lists: dict[int, Numbers]) -> npt.NDArray[np.int32]:
    return np.concatenate([np.zeros(0, np.intp), *lists.values()]).astype(np.int32)


def _count(lists: dict[int, Numbers]) -> dict[int, int]:
    return {rank: len(nodes) for rank, nodes in lists.items()}
