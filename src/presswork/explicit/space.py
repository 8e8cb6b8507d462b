# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics in space: shells and solids in one model, with tools and drawbeads that hold the shells.

    run = SpaceDynamics(points, [Shells(...), Solids(...)])
    run.fix(nodes, "uvw")
    run.advance(1000)
    run.energies().error_percent

A node has six freedoms: displacements u, v, w and rotations p, q, r about x, y, z; rotations rest at nodes of solids.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.blocks import Shells, Solids
from presswork.explicit.device import DEVICES, Device, check_device
from presswork.explicit.divided_space import DividedSpaceLoop
from presswork.explicit.drawbeads import BeadsOfRun
from presswork.explicit.dynamics import Dynamics
from presswork.explicit.input_checks import ExplicitError, check_points
from presswork.explicit.layers import LayersOfRun
from presswork.explicit.resident import ResidentLoop, Traffic
from presswork.explicit.sheet_pressure import PressuresOfRun
from presswork.explicit.shell_contact import ShellContactOfRun
from presswork.explicit.tools import ToolsOfRun
from presswork.law.history import RISE, STRESS
from presswork.law.umat import STATUS_MESSAGES, SheetUmat, list_sheet_history
from presswork.ranks.parts import make_part
from presswork.ranks.world import World

Array = npt.NDArray[np.float64]
Precision = Literal["double", "single"]
LOOPS: dict[str, type[_core.SpaceLoop] | type[_core.SpaceLoopSingle]] = {
    "double": _core.SpaceLoop,
    "single": _core.SpaceLoopSingle,
}


def choose_precision(law: _core.SheetLaw | SheetUmat) -> Precision:
    """Return the precision in which shells of a law take the least time: laws but the fast one compute in double."""
    return "single" if isinstance(law, _core.SheetLaw) and _core.is_tabulated(law) else "double"


def order_along_curve(points: Array) -> npt.NDArray[np.intp]:
    """Give the order of points (n, 3) along a Morton curve: neighbours in space come near each other in memory."""
    low, high = points.min(axis=0), points.max(axis=0)
    cells = ((points - low) / max(float((high - low).max()), 1e-300) * 1023).astype(np.uint64)
    code = np.zeros(len(points), dtype=np.uint64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(3 * bit + axis)
    return np.argsort(code, kind="stable")


@dataclass(frozen=True)
class SolidState:
    """State of a block of solids at its q points."""

    stress: Array
    """xx, yy, zz, xy, yz, zx (n, q, 6) [MPa]."""
    equivalent_plastic_strain: Array
    """(n, q)."""


class SpaceDynamics(LayersOfRun, ToolsOfRun, BeadsOfRun, PressuresOfRun, ShellContactOfRun, Dynamics):
    """Blocks of shells and of solids in explicit dynamics.

    points (n_nodes, 3) [mm]; blocks: those of Shells, which the properties of layers, thickness and tools mean, come
    first; several of them are one sheet, whose laws keep the same quantities.
    hanging: nodes that follow the ends of sides (n, 7), as SplitMesh.hanging gives them.
    precision: "single" computes shells and velocities in single precision, positions and energies in double: about half
    the time and memory; docs/theory/explicit.md states where it is accurate enough. device: "cuda" computes the cycles
    on the first NVIDIA card, "host" runs the card's code on the CPU, for tests; docs/theory/graphics_card.md lists what
    a device computes. The state is that of the CPU's loop: a dump goes on anywhere. world: ranks that share the cycles.
    tied: pairs of nodes (n, 2) that will be tied, which ranks must know.
    """

    FREEDOMS = "uvwpqr"

    def __init__(
        self,
        points: npt.ArrayLike,
        blocks: Sequence[Shells | Solids],
        *,
        precision: Precision = "double",
        device: Device = "cpu",
        hanging: npt.ArrayLike = (),
        tied: npt.NDArray[np.int32] | None = None,
        world: World | None = None,
        known: npt.NDArray[np.int32] | None = None,
    ) -> None:
        x = np.array(points, dtype=float)
        _check(x, blocks, precision, device)
        self.device = device
        self.start, self.blocks = x, list(blocks)
        sizes = [len(block.cells) for block in blocks]
        curves = [order_along_curve(x[block.cells].mean(axis=1)) for block in blocks]
        nodes = _order_nodes(len(x), np.concatenate([b.cells[c].ravel() for b, c in zip(blocks, curves, strict=True)]))
        place = np.empty(len(x), dtype=np.int32)
        place[nodes] = np.arange(len(x))
        elements: list[npt.NDArray[np.intp]] = []
        self._counts: list[int] = []
        self._first_of: list[int] = []
        pieces: list[tuple[Shells | Solids, npt.NDArray[np.intp]]] = []
        for block, curve in zip(blocks, curves, strict=True):
            before = sum(sizes[: len(self._first_of)])
            self._first_of.append(len(elements))
            for part in block.split(curve):
                pieces.append((block, part))
                elements.append(before + part)
                if isinstance(block, Shells):
                    self._counts.append(len(part))
        loop = _make_loop(precision, x[nodes], pieces, place)
        self._shells = np.concatenate([np.zeros(0, np.intp), *elements[: len(self._counts)]])
        if sheet := [block for block in blocks if isinstance(block, Shells)]:
            of_sheet = [len(block.cells) for block in sheet]
            self._young = np.repeat([block.law.young for block in sheet], of_sheet)
            self._poisson = np.repeat([block.law.poisson for block in sheet], of_sheet)
            self._damage_names = tuple(law.name for law in sheet[0].damage)
            self.connectivity = np.concatenate([block.cells for block in sheet])
            self.axis, self.options = np.concatenate([block.axes for block in sheet]), sheet[0].options
        self.hanging = follow = np.array(hanging, dtype=np.int32).reshape(-1, 7)
        if len(follow):
            loop.set_hanging(place[follow])
        self._start_tools()
        self._start_beads()
        self._start_pressures()
        self._start_shell_contact()
        check_device(device, loop)
        self._resident = None if device == "cpu" else ResidentLoop(loop, device)
        whole: Any = self._resident or loop
        if world:
            rows, leaders = (follow, 2) if tied is None else (tied[:, ::-1], 1)
            whole = _divide(loop, precision, pieces, x, nodes, place, (place[rows], leaders), world, known)
        super().__init__(whole, nodes, np.concatenate(elements))

    @property
    def mass(self) -> Array:
        """Mass and rotary inertia of each node (n_nodes, 2) [t, t mm2]; 0 where no element gives it any."""
        inverse = self._by_node(self._loop.inverse_mass)
        return np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0)

    def solid_state(self, block: int) -> SolidState:
        """Return the state of a block of solids, by its number among the blocks."""
        if not isinstance(self.blocks[block], Solids):
            raise ExplicitError(f"block {block} has shells: their layers are properties of the run")
        loop: Any = self._loop  # in double precision, which has solids
        inside = loop.point_measures(self._first_of[block])
        first = sum(len(each.cells) for each in self.blocks[:block])
        points = np.empty_like(inside)
        points[self._elements[first : first + len(points)] - first] = inside
        return SolidState(points[..., :6], points[..., 6])

    def set_slower(self, factor: float) -> None:
        """Let laws of shells take their rates by a time so many times that of the cycles from now on."""
        self._loop.set_slower(factor)

    def trial_force(self, increment: npt.ArrayLike) -> Array:
        """Give the internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed."""
        return self._by_node(self._loop.trial_force(self._shaped(increment, "increment")[self._nodes]))

    def check_device(self) -> None:
        """Raise ExplicitError where the device does not compute what the run has, or has too little memory for it."""
        if self._resident:
            check_device(self.device, self._resident.loop)
            self._resident.enter()

    def find_contact(self) -> None:
        """Find the contact of tools that are new.

        Raises ExplicitError where the sheet starts in a tool, or the device does not compute what the run has or has
        too little memory for it.
        """
        if self._resident:
            check_device(self.device, self._resident.loop)
        self._prepare_tools(np.empty(0))
        if self._reference is None:
            self._begin_balance(0.0, 1.0, 1.0)
        self._check_tools()
        if self._resident:
            self._resident.enter()

    def _last_step(self) -> float:
        # a step differs little from the one before: velocities are taken to stand half of the present one back
        return self.dt

    def _masses_have_changed(self) -> None:
        self._contact_step = 0.0

    def _energy_with_mass(self) -> float:
        return self._kinetic()

    def _kinetic(self) -> float:
        return float(self._loop.energies(self.dt, self.dt).kinetic)

    def _prepare(self, velocity_scale: Array) -> None:
        self._prepare_tools(velocity_scale)
        self._prepare_beads(len(velocity_scale))
        self._prepare_pressures(len(velocity_scale))

    # What a device measures it measures in every run, so that a run that goes on from a dump has the same bits; before
    # the first cycle the loop does, which a run begins with.

    def stable_step(self) -> float:
        """Give the bound of the stable time step [s] of the elements as they are now."""
        if self._resident and self.cycle > 0:
            return float(2.0 / np.sqrt(self._resident.measure_frequency()))
        return super().stable_step()

    def _energies(self, damping: float, force_scale: float, velocity_scale: float) -> _core.Energies:
        if self._resident and self.cycle > 0:
            scales = {"damping": damping, "force_scale": force_scale, "velocity_scale": velocity_scale}
            found: _core.Energies = self._resident.measure_energies(self._last_step(), self._last_step(), **scales)
            return found
        return super()._energies(damping, force_scale, velocity_scale)

    @property
    def traffic(self) -> Traffic:
        """Copies of arrays to the device and back so far."""
        return self._resident.traffic if self._resident else Traffic()

    def _check(self) -> None:
        self._check_tools()

    def _explain(self, element: int, status: _core.LawStatus, when: str) -> str:
        if element >= len(self._shells):
            return super()._explain(element, status, when)
        if status != _core.LawStatus.no_stress:
            return f"{STATUS_MESSAGES[status]} in shell {element} {when}: shorten the step"
        return (
            f"the material law of shell {element} has failed {when}, it finds no stress for the strain of this step: "
            f"the step {self.dt:g} s is too long, the shell has collapsed, or the law's parameters are not those of a "
            "metal"
        )

    def _dump_run(self) -> dict[str, Array]:
        given = self.prescribed_temperature
        return {
            **super()._dump_run(),
            "contact_step": np.array([self._contact_step]),
            "temperature": np.zeros(0) if given is None else given,
        }

    def _restore_run(self, own: Mapping[str, Array]) -> None:
        super()._restore_run(own)
        self._contact_step, self._new_tools = float(own["contact_step"][0]), []
        if "temperature" in own:
            self.prescribed_temperature = own["temperature"]


Piece = tuple[Shells | Solids, npt.NDArray[np.intp]]
"""A block, and the elements of it that make a block of the loop."""


def _check(x: Array, blocks: Sequence[Shells | Solids], precision: Precision, device: Device) -> None:
    """Raise ExplicitError for input that cannot be computed."""
    if precision not in LOOPS:
        raise ExplicitError(f"precision = {precision!r}: give 'double' or 'single'")
    if device not in DEVICES:
        raise ExplicitError(f"device = {device!r}: give {' or '.join(map(repr, DEVICES))}")
    sheet = [block for block in blocks if isinstance(block, Shells)]
    if not blocks or any(isinstance(block, Shells) for block in blocks[len(sheet) :]):
        raise ExplicitError("blocks: give one at least, and those of Shells first")
    if precision != "double" and any(isinstance(block.law, SheetUmat) for block in sheet):
        raise ExplicitError(f"precision = {precision!r}: a UMAT computes in double precision")
    if (
        len(
            {(block.options, list_sheet_history(block.law), tuple(law.name for law in block.damage)) for block in sheet}
        )
        > 1
    ):
        raise ExplicitError(
            "blocks of Shells are one sheet: their options, what their laws keep, and damage are the same"
        )
    check_points(x, 3)
    for block in blocks:
        block.check(x)


def _make_loop(
    precision: Precision,
    points: Array,
    pieces: Sequence[Piece],
    place: npt.NDArray[np.int32],
    around: Sequence[npt.NDArray[np.intp] | None] | None = None,
) -> _core.SpaceLoop | _core.SpaceLoopSingle:
    """Return a loop with its blocks; place: number in it of each node. Raises ExplicitError.

    around: of each piece, cells round its nodes, where others are computed elsewhere.
    """
    loop = LOOPS[precision](points)
    for number, (block, part) in enumerate(pieces):
        try:
            block.add(loop, part, place, around[number] if around else None)
        except ValueError as error:
            raise ExplicitError(str(error)) from None
        if not isinstance(block, Shells):
            continue
        kept = list_sheet_history(block.law).behind(STRESS, 3)
        rise = kept[RISE].start if block.heating[1] else -1
        for law in block.damage:
            loop.add_damage(number, law.name, law.kernel, temperature=block.heating[0], rise=rise)
        loop.ironing = block.options.ironing
    return loop


def _divide(
    whole: _core.SpaceLoop | _core.SpaceLoopSingle,
    precision: Precision,
    pieces: Sequence[Piece],
    x: Array,
    nodes: npt.NDArray[np.intp],
    place: npt.NDArray[np.int32],
    following: tuple[npt.NDArray[np.int32], int],
    world: World,
    known: npt.NDArray[np.int32] | None,
) -> DividedSpaceLoop:
    """Return a loop whose cycles ranks share; the arguments are those of the whole loop; following: as of make_part."""
    cells = [place[block.cells[part]] for block, part in pieces]
    measures = [block.measures_nodes for block, _ in pieces]
    try:
        mine = make_part(
            x[nodes],
            cells,
            world.size,
            world.rank,
            measures,
            following=following,
            known=None if known is None else place[known],
        )
    except ValueError as error:
        raise ExplicitError(f"{error}: start fewer ranks") from None
    kept = [number for number, elements in enumerate(mine.elements) if len(elements)]
    own = [(pieces[number][0], pieces[number][1][mine.elements[number]]) for number in kept]
    near = [None if (of := mine.around[number]) is None else pieces[number][1][of] for number in kept]
    of_own = np.full(len(x), -1, dtype=np.int32)
    of_own[nodes[mine.nodes]] = np.arange(len(mine.nodes))
    loop = _make_loop(precision, x[nodes[mine.nodes]], own, of_own, near)
    rows, leaders = following
    if leaders == 2 and len(rows):  # those of hanging nodes
        loop.set_hanging(mine.number(rows[np.isin(rows[:, 0], mine.nodes)]))
    sheet = any(isinstance(block, Shells) for block, _ in pieces)
    return DividedSpaceLoop(whole, loop, mine, world, width=8 if sheet else 3)


def _order_nodes(n: int, used_in_turn: npt.NDArray[np.int32]) -> npt.NDArray[np.intp]:
    """Return node numbers in the order in which elements first use them, then the others."""
    _, at = np.unique(used_in_turn, return_index=True)
    used = used_in_turn[np.sort(at)]
    return np.concatenate([used, np.setdiff1d(np.arange(n), used)]).astype(np.intp)
