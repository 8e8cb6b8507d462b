# SPDX-License-Identifier: Apache-2.0
"""The State: every array that changes during a run. Two exist: the converged one and the trial one."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, fields, replace
from typing import ClassVar, Self, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.model import FloatArray, IntArray, Model

ContactArray = NDArray[np.int8]

SLIDING = 1
STUCK = 2
EXTERNAL, PLASTIC, FRICTION, INERTIA, CONTACT = range(5)
"""Places in State.work."""
OF_RUN = (
    "tool_displacement", "tool_angle", "tool_restart", "tool_travel", "tool_travel_increment", "tool_gives",
    "tool_force", "tool_force_start", "sheet_tool_move", "sheet_tool_travel", "sheet_tool_travel_increment",
    "progress", "work", "peak_force",
)  # fmt: skip
"""Arrays of the State that fit any mesh."""


@dataclass
class Arrays:
    """What one owner keeps in the State: a subclass names each array, with shape and unit.

    A value is an array, a list of arrays (one for each block of cells) or a number.
    """

    owner: ClassVar[str]
    """Their prefix in a checkpoint."""
    of_run: ClassVar[tuple[str, ...]] = ()
    """Names of arrays that fit any mesh, and go along when the mesh changes."""

    def duplicate(self) -> Self:
        """Return a deep copy."""
        return replace(self, **{f.name: _copy(getattr(self, f.name)) for f in fields(self)})

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array under a name of its own, numbers as arrays without dimension."""
        listed: dict[str, NDArray[np.generic]] = {}
        for f in fields(self):
            name, value = f"{self.owner}.{f.name}", getattr(self, f.name)
            if isinstance(value, list):
                listed.update({f"{name}.{i}": a for i, a in enumerate(value)})
            else:
                listed[name] = np.asarray(value)
        return listed

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Take up what to_arrays() gave."""
        for f in fields(self):
            name, value = f"{self.owner}.{f.name}", getattr(self, f.name)
            if isinstance(value, list):
                setattr(self, f.name, [arrays[f"{name}.{i}"].copy() for i in range(len(value))])
            elif isinstance(value, np.ndarray):
                setattr(self, f.name, arrays[name].copy())
            else:
                setattr(self, f.name, type(value)(arrays[name]))


Owned = TypeVar("Owned", bound=Arrays)


def _copy(value: NDArray[np.generic] | list[NDArray[np.generic]] | float) -> object:
    if isinstance(value, list):
        return [a.copy() for a in value]
    return value.copy() if isinstance(value, np.ndarray) else value


@dataclass
class ShellArrays:
    """Arrays of shells per block: q points in the plane, k layers, from bottom to top."""

    director: FloatArray
    """Unit directors (n_directors, 3)."""
    thickness: list[FloatArray]
    """(n_cells, q) [mm]."""
    history: list[FloatArray]
    """What the law keeps, equivalent plastic strain first (n_cells, q, k, n_history)."""
    direction: list[FloatArray]
    """First covariant base vector in the lamina frame, which turns with the material (n_cells, q, k, 2), unit."""
    shear: list[FloatArray]
    """Transverse shear force per area of the reference cell, contravariant (n_cells, q, 2)."""
    internal: list[FloatArray]
    """What a cell keeps besides its points (n_cells, m): the bubble of shell3_mitc_plus; of shell4_1pt the hourglass
    forces (6), the energy stored by them and that lost to plastic flow [N mm]."""
    fading: FloatArray
    """What loads and supports of the stage before still do when a stage begins, and cease to over it (n_points, 6)
    [N, N mm]."""

    @classmethod
    def none(cls) -> ShellArrays:
        """Return those of a model without shells."""
        return cls(np.zeros((0, 3)), [], [], [], [], [], np.zeros((0, 6)))


@dataclass
class State:
    """Arrays at one instant; units mm, N, MPa. A checkpoint is a dump of the converged State."""

    displacement: FloatArray
    """Since the start (n_points, 2); of a solid in space (n_points, 3); of a shell (n_points, 6): x, y, z and the sum
    of the increments' rotation vectors [rad]."""
    increment: FloatArray
    """Of the last increment, in the same form: the first guess of the next."""
    reaction: FloatArray
    """Force that tools and supports exert on the nodes (n_points, 2) [N]; of a shell (n_points, 6) with moments
    [N mm]."""
    external_force: FloatArray
    """Applied loads, in the same form."""
    tool_displacement: FloatArray
    """(n_tools, 2)."""
    tool_angle: FloatArray
    """(n_tools,) [rad]."""
    tool_restart: FloatArray
    """Part of tool_displacement by which stages have placed tools anew (n_tools, 2)."""
    tool_travel: FloatArray
    """Part of tool_displacement that forces and springs have made (n_tools, 2)."""
    tool_travel_increment: FloatArray
    """Of the last increment (n_tools, 2)."""
    tool_gives: ContactArray
    """1 for a tool on a spring that is off its stop (n_tools,)."""
    tool_force: FloatArray
    """Force of the workpiece on each tool, as modelled, and torque about its centre (n_tools, 3) [N, N, N mm]."""
    tool_force_start: FloatArray
    """Force of the workpiece on each tool, as modelled, when the stage began (n_tools, 2) [N]."""
    sheet_tool_move: FloatArray
    """Of the tools in space, since the start (n_sheet_tools, 3) [mm]."""
    sheet_tool_travel: FloatArray
    """The part of it that forces have made, in the same form."""
    sheet_tool_travel_increment: FloatArray
    """Of the last increment."""
    sheet_tool_force: FloatArray
    """Of these tools on the nodes of a shell (n_sheet_tools, n_points, 3) [N]."""
    sheet_friction: FloatArray
    """The part of it along the tool, in the same form."""
    bead_force: FloatArray
    """Of each point of the drawbeads on the sheet across the line (n_bead_points,) [N]."""
    bead_cell: IntArray
    """The cell found beneath it last; -1: none yet (n_bead_points,)."""
    contact: ContactArray
    """Per face of each tool and candidate node: 0 apart, 1 SLIDING, 2 STUCK; (2 n_tools, n_candidates)."""
    anchor: FloatArray
    """Where a STUCK node sits, in its tool's frame (n_candidates, 2)."""
    drag: FloatArray
    """Friction of each candidate along its tangent, a quarter turn from the normal (n_candidates,) [N]."""
    shear_part: FloatArray
    """Part of constant shear that acts at each candidate: 1, but for nodes that neither push nor lift off
    (n_candidates,)."""
    interface_pressure: FloatArray
    """Between bodies, per slave node of each contact (n_slots,) [MPa]."""
    interface_shear: FloatArray
    """Along the slave edge (n_slots,) [MPa]."""
    interface_slip: FloatArray
    """Elastic slip of nodes that stick, still to be undone (n_slots,) [mm]."""
    interface_force: FloatArray
    """Of the bodies on each other, at the nodes (n_points, 2) [N]; no rows without contact of bodies."""
    interface_friction: FloatArray
    """The part of it that friction makes, in the same form."""
    search_displacement: FloatArray
    """At which edges that may touch were last looked for (n_points, 2) [mm]; no rows without contact of bodies."""
    stress: list[FloatArray]
    """Cauchy stress xx, yy, zz, xy per block (n_cells, n_points, 4), in space also yz, zx; of shells xx, yy, xy in the
    lamina frame, (n_cells, q k, 3), layers within points."""
    eqps: list[FloatArray]
    """Equivalent plastic strain per block (n_cells, n_points)."""
    history: list[FloatArray]
    """What a solid's law keeps besides, per block (n_cells, n_points, n_history): of von Mises with isotropic hardening
    nothing; of other laws the rise of temperature where they heat, back stresses, and the directions of the law's axes;
    of one from a shared library its state variables, then deformation gradient, strain, energies and work."""
    temperature: list[FloatArray]
    """Given to the points from outside at the end of the increment, per block in the shape of eqps [degrees C]; what a
    law heats itself comes on top. At rest that of the start; no rows where the material does not know of temperature.
    """
    hourglass: list[FloatArray]
    """Hourglass forces per block (n_cells, 2) [N]; zero but for quad4_1pt."""
    volume: list[FloatArray]
    """Volume of each integration point per block (n_cells, n_points) [mm3]."""
    shells: ShellArrays
    """What shells have besides; of solids empty."""
    owned: dict[type[Arrays], Arrays]
    """Arrays by their owner; state[kind] finds them."""
    progress: FloatArray
    """[time, stage, fraction of stage, increments, last increment, next size, iterations, cut-backs]."""
    work: FloatArray
    """[work of tools, supports and loads; plastic work; work lost in friction on tools and between bodies; work against
    inertia and damping; energy stored in the contact of a sheet with its tools] [N mm]."""
    peak_force: FloatArray
    """Largest nodal force so far (1,) [N]: what a residual is small beside once the load is taken off."""

    @classmethod
    def at_rest(cls, model: Model, n_candidates: int, n_slots: int = 0) -> State:
        """Return the State before the first increment; the arrays of shells and of laws are left empty."""
        n = len(model.mesh.points)
        n_coupled = n if model.contacts else 0
        solids = () if model.analysis == "shell" else model.mesh.blocks
        sizes = [(len(b.connectivity), _core.element_sizes(b.element)[1]) for b in solids]
        d, components = model.dimension, 6 if model.dimension == 3 else 4
        n_tools, n_sheet_tools = len(model.plane_tools), len(model.sheet_tools)
        n_bead_points = sum(len(b.place) for b in model.beads)
        return cls(
            displacement=np.zeros((n, d)),
            increment=np.zeros((n, d)),
            reaction=np.zeros((n, d)),
            external_force=np.zeros((n, d)),
            tool_displacement=np.zeros((n_tools, 2)),
            tool_angle=np.zeros(n_tools),
            tool_restart=np.zeros((n_tools, 2)),
            tool_travel=np.zeros((n_tools, 2)),
            tool_travel_increment=np.zeros((n_tools, 2)),
            tool_gives=np.zeros(n_tools, dtype=np.int8),
            tool_force=np.zeros((n_tools, 3)),
            tool_force_start=np.zeros((n_tools, 2)),
            sheet_tool_move=np.zeros((n_sheet_tools, 3)),
            sheet_tool_travel=np.zeros((n_sheet_tools, 3)),
            sheet_tool_travel_increment=np.zeros((n_sheet_tools, 3)),
            sheet_tool_force=np.zeros((n_sheet_tools, n, 3)),
            sheet_friction=np.zeros((n_sheet_tools, n, 3)),
            bead_force=np.zeros(n_bead_points),
            bead_cell=np.full(n_bead_points, -1, dtype=np.int32),
            contact=np.zeros((2 * n_tools, n_candidates), dtype=np.int8),
            anchor=np.zeros((n_candidates, 2)),
            drag=np.zeros(n_candidates),
            shear_part=np.ones(n_candidates),
            interface_pressure=np.zeros(n_slots),
            interface_shear=np.zeros(n_slots),
            interface_slip=np.zeros(n_slots),
            interface_force=np.zeros((n_coupled, 2)),
            interface_friction=np.zeros((n_coupled, 2)),
            search_displacement=np.zeros((n_coupled, 2)),
            stress=[np.zeros((*s, components)) for s in sizes],
            eqps=[np.zeros(s) for s in sizes],
            history=[np.zeros((*s, 0)) for s in sizes],
            temperature=[np.zeros((0, s[1])) for s in sizes],
            hourglass=[np.zeros((s[0], 2)) for s in sizes],
            volume=[np.zeros(s) for s in sizes],
            shells=ShellArrays.none(),
            owned={},
            progress=np.zeros(8),
            work=np.zeros(5),
            peak_force=np.zeros(1),
        )

    def __getitem__(self, kind: type[Owned]) -> Owned:
        """Return the arrays of an owner."""
        return cast(Owned, self.owned[kind])

    def add(self, arrays: Arrays) -> None:
        """Take in the arrays of an owner. Raises ValueError if there are others of this name."""
        if arrays.owner in {a.owner for a in self.owned.values()}:
            raise ValueError(f"two owners of arrays in the State have the name {arrays.owner!r}")
        self.owned[type(arrays)] = arrays

    def duplicate(self) -> State:
        """Return a deep copy."""
        return _duplicate(self)

    def take_over(self, before: State) -> None:
        """Take over from another mesh the arrays that fit any mesh."""
        for name in OF_RUN:
            setattr(self, name, getattr(before, name).copy())
        for kind, owned in self.owned.items():
            for name in owned.of_run:
                setattr(owned, name, _copy(getattr(before.owned[kind], name)))

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array under a name of its own, for a checkpoint."""
        listed = _list_arrays(self, "")
        for owned in self.owned.values():
            listed |= owned.to_arrays()
        return listed

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Fill this State from a checkpoint's arrays.

        Raises ValueError if they are those of another model.
        """
        own = self.to_arrays()
        if set(own) != set(arrays) or any(own[k].shape != arrays[k].shape for k in own):
            raise ValueError("the checkpoint belongs to another case: its arrays do not fit this mesh and these tools")
        for name, target in _list_arrays(self, "").items():
            target[...] = arrays[name]
        for owned in self.owned.values():
            owned.load_arrays(arrays)


_Arrays = TypeVar("_Arrays", State, ShellArrays)


def _duplicate(arrays: _Arrays) -> _Arrays:
    """Return a deep copy."""
    other = copy(arrays)
    for f in fields(arrays):
        value = getattr(arrays, f.name)
        if isinstance(value, ShellArrays):
            copied: object = _duplicate(value)
        elif isinstance(value, dict):
            copied = {kind: owned.duplicate() for kind, owned in value.items()}
        else:
            copied = [a.copy() for a in value] if isinstance(value, list) else value.copy()
        setattr(other, f.name, copied)
    return other


def _list_arrays(arrays: State | ShellArrays, prefix: str) -> dict[str, NDArray[np.generic]]:
    """Return every array by name."""
    listed: dict[str, NDArray[np.generic]] = {}
    for f in fields(arrays):
        value = getattr(arrays, f.name)
        if isinstance(value, ShellArrays):
            listed.update(_list_arrays(value, f"{prefix}{f.name}."))
        elif isinstance(value, dict):
            continue
        elif isinstance(value, list):
            listed.update({f"{prefix}{f.name}.{i}": a for i, a in enumerate(value)})
        else:
            listed[prefix + f.name] = value
    return listed
