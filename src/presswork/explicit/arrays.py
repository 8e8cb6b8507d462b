# SPDX-License-Identifier: Apache-2.0
"""The State of an explicit run: every array that the next cycle depends on, by its owner.

The loop of the core fills these arrays, and takes them back (cpp/explicit/state_field.hpp). Its own owners have a
number in their name, such as block_1; here a list has an entry for each. An array that an owner lacks is empty there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from presswork.law.history import History
from presswork.state import ANEW, CELL, NODE, PLACE, POINT, RUN, SHARE, SURFACE, SURFACE_FORCE, Arrays, OnNewMesh, State

Array = npt.NDArray[np.float64]
LoopState = Mapping[str, Mapping[str, Array]]
"""Arrays of a loop, by its own owners and names."""
DAMAGE = "damage"
"""Prefix of names of damage in a loop."""


@dataclass
class LoopArrays(Arrays):
    """Sums of the loop."""

    owner = "loop"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"work": RUN}
    work: Array
    """Work of external forces, damping, contact and friction up to half a step back (4,) [N mm]."""


@dataclass
class MotionArrays(Arrays):
    """Motion of the nodes, f freedoms each: 2 in the plane, 6 in space."""

    owner = "nodes"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"position": PLACE, "velocity": NODE, "internal_force": ANEW}
    position: Array
    """(n_nodes, 2 | 3) [mm]."""
    velocity: Array
    """Half a step back (n_nodes, f) [mm/s, 1/s]."""
    internal_force: Array
    """Less the forces of tools (n_nodes, f) [N, N mm]."""


@dataclass
class SolidArrays(Arrays):
    """Cells of solids, an entry for each block of p points a cell; hourglass to force depend on the element."""

    owner = "solids"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "mass_factor": CELL,
        "points": POINT,
        "work": SHARE,
        "hourglass": CELL,
        "pressure": CELL,
        "force": CELL,
        "damage": POINT,
    }
    mass_factor: list[Array]
    """Factor of mass scaling (n_cells,)."""
    points: list[Array]
    """Stress and what the law keeps, as `kept` names it (n_cells, p, n_values)."""
    work: list[Array]
    """Work of the stress and, where there are any, of hourglass forces (n_cells, 1 | 2) [N mm]."""
    hourglass: list[Array]
    """Hourglass forces (n_cells, 2 | 12) [N]."""
    pressure: list[Array]
    """Nodal mean of the pressure, of tet4_nodal (n_cells, 1) [MPa]."""
    force: list[Array]
    """Force on the nodes in the last cycle (n_cells, 3 nodes) [N]."""
    damage: dict[str, list[Array]]
    """Damage by the quantity's name (n_cells, p); without rows where the block has no such law."""
    kept: list[History] = field(default_factory=list, metadata={"is_array": False})

    def find_kept(self, block: int, name: str) -> Array:
        """Return a view of a part of a block's points (n_cells, p, size), of one value (n_cells, p)."""
        return self.kept[block].of(name, self.points[block])


@dataclass
class LayerArrays(Arrays):
    """Shells, an entry for each block of q points in the plane and k layers."""

    owner = "shells"
    mass: list[Array]
    """Mass with what was added (n_cells,) [t]."""
    shell: list[Array]
    """What the element keeps beside its layers, thickness and work among it (n_cells, n), as the element has it."""
    layers: list[Array]
    """Sum, difference [MPa] and shear of the stress, then what the law keeps (n_cells, q, k, n)."""
    rounding: list[Array]
    """What rounding took from the layers, in single precision (n_cells, n)."""
    damage: dict[str, list[Array]]
    """Damage by the quantity's name (n_cells, q k)."""


@dataclass
class ProfileArrays(Arrays):
    """Rigid profiles in the plane, an entry for each."""

    owner = "profiles"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"offset": RUN, "impulse": RUN, "force": ANEW}
    offset: list[Array]
    """Displacement since the start (2,) [mm]."""
    impulse: list[Array]
    """Impulse given to the nodes since the start (2,) [N s]."""
    force: list[Array]
    """Force on the nodes in the last cycle (n_nodes, 2) [N]."""


@dataclass
class WallArrays(Arrays):
    """Rigid tools round solids in space, an entry for each."""

    owner = "walls"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "offset": RUN,
        "angle": RUN,
        "floating": RUN,
        "impulse": RUN,
        "force": ANEW,
        "travel": ANEW,
        "wake": ANEW,
    }
    offset: list[Array]
    """Displacement since the start (3,) [mm]."""
    angle: list[Array]
    """Angle by which it has turned about its axis (1,) [rad]."""
    floating: list[Array]
    """Travel [mm] and speed [mm/s] along the direction of a force or spring (2,)."""
    impulse: list[Array]
    """Impulse given to the nodes since the start (3,) [N s], and its moment about the axis [N mm s] (4,)."""
    force: list[Array]
    """Force on the nodes in the last cycle (n_nodes, 3) [N]."""
    travel: list[Array]
    """Largest possible approach of nodes and tool since the start, and its last value (2,) [mm]."""
    wake: list[Array]
    """Travel at which a node is looked at again (n_nodes,) [mm]."""


@dataclass
class BodyContactArrays(Arrays):
    """Contacts of bodies, an entry for each; slots are the nodes of its slave."""

    owner = "bodies"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "work": RUN,
        "impulse": RUN,
        "pressure": SURFACE,
        "shear": SURFACE,
        "push": SURFACE_FORCE,
        "rub": SURFACE_FORCE,
        "slave_depth": ANEW,
        "master_depth": ANEW,
        "since_cut": ANEW,
        "cut_position": ANEW,
    }
    work: list[Array]
    """Work that pressure and friction have taken since the start (2,) [N mm]."""
    impulse: list[Array]
    """Impulse that the slave has given to the master since the start (3,) [N s]."""
    pressure: list[Array]
    """(n_slots,) [MPa]."""
    shear: list[Array]
    """Shear on the slave (n_slots, 3) [MPa]."""
    push: list[Array]
    """Forces of the pressure in the last cycle on the nodes of both surfaces (n, 3) [N]."""
    rub: list[Array]
    """The same of friction (n, 3) [N]."""
    slave_depth: list[Array]
    """How far the body reaches behind each face (n_faces,) [mm]."""
    master_depth: list[Array]
    since_cut: list[Array]
    """Way of the nodes since the surfaces were last cut [mm], and cycles since then (2,)."""
    cut_position: list[Array]
    """Where the nodes were then (3 n,) [mm]."""


@dataclass
class SheetToolArrays(Arrays):
    """Tools that a sheet touches, an entry for each; units as cpp/explicit/contact/tool_contact.hpp has them."""

    owner = "sheet_tools"
    displacement: list[Array]
    """(3,) [mm]."""
    velocity: list[Array]
    """(3,) [mm/s]."""
    force: list[Array]
    """Force of the sheet (3,) [N]."""
    push: list[Array]
    """Force that pushes it (1,) [N]."""
    was_pushed: list[Array]
    """The same in the cycle before (1,) [N]."""
    travel: list[Array]
    """Largest possible approach of points and tool since the start (1,) [mm]."""
    pairs: list[Array]
    """What points remember of the tool (n_slots, n)."""
    hint: list[Array]
    """Place on the tool where a point is looked for first (n_slots,)."""
    edge_asked: list[Array]
    """Edges of the sheet at which the tool was last looked for (n_edges, n)."""
    edge_force: list[Array]
    """(n_edges, 8) [N]."""
    edge_hint: list[Array]
    """(n_edges, 2)."""
    edge_wake: list[Array]
    """Travel at which an edge is looked at again (n_edges,) [mm]."""


@dataclass
class ToolContactArrays(Arrays):
    """Contact of a sheet with its tools, beside what it keeps of each tool; arrays of one number are sums."""

    owner = "sheet_contact"
    half: Array
    """Half of the thickness at each point [mm]."""
    room: Array
    """How far a point may move until contact is looked for [mm]."""
    held: Array
    """Energy held at each point [N mm]."""
    friction: Array
    """Work (1,) [N mm]."""
    damping: Array
    """Work (1,) [N mm]."""
    squeeze: Array
    """Work (1,) [N mm]."""
    external: Array
    """Work on pushed tools (1,) [N mm]."""
    drag: Array
    """Work of the drag of pushed tools (1,) [N mm]."""
    step: Array
    """Longest step for which springs are stable (1,) [s]."""
    started: Array
    """Whether contact has begun (1,)."""
    cycle: Array
    """(1,)."""


@dataclass
class BeadPointArrays(Arrays):
    """Points of drawbeads."""

    owner = "beads"
    spring: Array
    """Force [N] and stiffness [N/mm] (n_points, 2)."""
    direction: Array
    """Unit vectors (n_points, 3)."""
    cell: Array
    """Shell beneath a point, and whether the point is within it (n_points, 2)."""
    weight: Array
    """Weight of the nodes of that shell (n_points, 4)."""
    work: Array
    """(1,) [N mm]."""
    cycle: Array
    """(1,)."""


@dataclass
class SheetPressureArrays(Arrays):
    """Pressures on a sheet, an entry for each."""

    owner = "sheet_pressures"
    pressure: list[Array]
    """(1,) [MPa]."""
    swept: list[Array]
    """Volume that the sheet has swept under it (1,) [mm3]."""


@dataclass
class SheetOnItselfArrays(Arrays):
    """Contact of a sheet with itself."""

    owner = "shell_contact"
    touching: Array
    """What each slot remembers of the shell that it touches (n_slots, n)."""
    work: Array
    """Elastic, of friction and of damping (3,) [N mm]."""
    step: Array
    """Longest step for which springs are stable (1,) [s]."""


@dataclass
class RunArrays(Arrays):
    """What a run keeps beside its loop."""

    owner = "run"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "clock": RUN,
        "energy": RUN,
        "scales": RUN,
        "temperature": ANEW,
        "contact_step": ANEW,
    }
    clock: Array
    """Cycle, time, step and last step (4,) [1, s, s, s]."""
    energy: Array
    """Energy at the start, and the largest since then (2,) [N mm]; not a number: none is counted yet."""
    scales: Array
    """Damping [1/s], scale of forces and of velocities in the last cycle (3,)."""
    temperature: Array
    """Temperature given from outside [degrees C]; no rows: that of the laws' start."""
    contact_step: Array
    """Longest step for which contact of a sheet with tools is stable (1,) [s]; no rows where there is none."""


OWNERS: dict[str, tuple[type[Arrays], ...]] = {
    "loop": (LoopArrays,),
    "nodes": (MotionArrays,),
    "block": (LayerArrays, SolidArrays),
    "wall": (ProfileArrays, WallArrays),
    "bodies": (BodyContactArrays,),
    "tool": (SheetToolArrays,),
    "contact": (ToolContactArrays,),
    "beads": (BeadPointArrays,),
    "pressure": (SheetPressureArrays,),
    "shell_contact": (SheetOnItselfArrays,),
    "run": (RunArrays,),
}
"""Owners in a loop, without their numbers, and what may be theirs; of blocks shells come first."""


def to_state(arrays: LoopState) -> State:
    """Return the State of a loop's arrays and those of its run, which are taken as they are.

    Raises KeyError that names an array that nobody declares.
    """
    grouped: dict[type[Arrays], list[Mapping[str, Array]]] = {}
    for owner in sorted(arrays, key=_split_owner):
        kind = _find_kind(_split_owner(owner)[0], arrays[owner])
        grouped.setdefault(kind, []).append(arrays[owner])
    return State(*(_gather(kind, owned) for kind, owned in grouped.items()))


def _split_owner(owner: str) -> tuple[str, int]:
    """Return an owner of a loop without its number, and that; -1: it has none."""
    name, _, number = owner.rpartition("_")
    return (name, int(number)) if number.isdigit() else (owner, -1)


def _find_kind(owner: str, arrays: Mapping[str, Array]) -> type[Arrays]:
    """Return what declares the arrays of an owner."""
    names = {name for name in arrays if not name.startswith(DAMAGE)}
    for kind in OWNERS.get(owner, ()):
        if names <= set(kind.names()):
            return kind
    raise KeyError(f"no owner declares {owner}: {', '.join(sorted(names))}")


def _gather(kind: type[Arrays], owned: list[Mapping[str, Array]]) -> Arrays:
    """Return the arrays of all owners of a kind; a number for each owner is the place in lists."""
    values: dict[str, Any] = {}
    for name in kind.names():
        if name == DAMAGE:
            names = dict.fromkeys(key for of in owned for key in of if key.startswith(f"{DAMAGE}_"))
            absent = np.zeros((0, 1))
            values[name] = {key.removeprefix(f"{DAMAGE}_"): [of.get(key, absent) for of in owned] for key in names}
        elif _is_list(kind, name):
            values[name] = [of.get(name, np.zeros((0, 0))) for of in owned]
        else:
            values[name] = owned[0].get(name, np.zeros(0))
    return kind(**values)


def _is_list(kind: type[Arrays], name: str) -> bool:
    return next(str(f.type) for f in fields(kind) if f.name == name).startswith("list")


def to_loop(arrays: Mapping[str, npt.NDArray[Any]]) -> dict[str, dict[str, Array]]:
    """Return the arrays of a State (State.to_arrays) by the owners and names of its loop, without those that are empty.

    Names without an owner are left alone.
    """
    kinds = {kind.owner: (owner, kind) for owner, of in OWNERS.items() for kind in of}
    n_shells = sum(name.startswith(f"{LayerArrays.owner}.layers.") for name in arrays)
    found: dict[str, dict[str, Array]] = {}
    for key, values in arrays.items():
        owner, _, name = key.partition(".")
        if owner not in kinds or not values.size:
            continue
        own, kind = kinds[owner]
        if "." in name:
            name, _, number = name.rpartition(".")
            name = name.replace(".", "_")
            own = f"{own}_{int(number) + (n_shells if kind is SolidArrays else 0)}"
        found.setdefault(own, {})[name] = np.ascontiguousarray(values, dtype=float)
    return found
