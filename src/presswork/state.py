# SPDX-License-Identifier: Apache-2.0
"""The State: every array that changes during a run, by its owner. Two exist: the converged one and the trial one.

Who needs an array to persist declares it in a subclass of Arrays: `state[ToolArrays].displacement`. Those that every
model has are `state.nodes` and `state.cells`. Units are mm, s, N, MPa.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import ClassVar, Literal, Self, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from presswork.law.history import History
from presswork.model import FloatArray


@dataclass(frozen=True)
class OnNewMesh:
    """What becomes of an array where the mesh changes.

    run: it fits any mesh and goes along. anew: the new mesh finds it for itself, as at rest. motion: moves of the
    nodes, by the shape functions of the old cells. node: a field given at the nodes. place: where nodes are; those of a
    new mesh begin where it has them. point: a field given at the integration points, one entry for each block. cell:
    values of cells; they begin anew with their cells, one entry for each block. share: what cells have a share of,
    whose sum over each block stays. surface: values at nodes of the boundary, carried along its arc, in a list one
    entry for each group of nodes. surface_force: the same of forces, carried per area.
    """

    kind: Literal["run", "anew", "motion", "node", "place", "point", "cell", "share", "surface", "surface_force"]
    axis: int = 0
    """Axis of the array along which nodes are counted."""


RUN, ANEW, MOTION, NODE = OnNewMesh("run"), OnNewMesh("anew"), OnNewMesh("motion"), OnNewMesh("node")
PLACE, POINT, CELL, SHARE = OnNewMesh("place"), OnNewMesh("point"), OnNewMesh("cell"), OnNewMesh("share")
SURFACE, SURFACE_FORCE = OnNewMesh("surface"), OnNewMesh("surface_force")


@dataclass
class Arrays:
    """What one owner keeps in the State: a subclass names each array, with shape and unit.

    A value is an array, a list of arrays (one for each block of cells), such lists by name, or a number.
    """

    owner: ClassVar[str]
    """Their prefix in a checkpoint."""
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {}
    """What becomes of each array where the mesh changes; solids with an array that is not named are not remeshed."""

    @classmethod
    def names(cls) -> list[str]:
        """Return the names of the arrays, without fields that describe how to read one."""
        return [f.name for f in fields(cls) if f.metadata.get("is_array", True)]

    def duplicate(self) -> Self:
        """Return a deep copy."""
        return replace(self, **{name: _copy(getattr(self, name)) for name in self.names()})

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array under a name of its own, numbers as arrays without dimension."""
        listed: dict[str, NDArray[np.generic]] = {}
        for own in self.names():
            name, value = f"{self.owner}.{own}", getattr(self, own)
            if isinstance(value, dict):
                listed.update({f"{name}.{key}.{i}": a for key, of in value.items() for i, a in enumerate(of)})
            elif isinstance(value, list):
                listed.update({f"{name}.{i}": a for i, a in enumerate(value)})
            else:
                listed[name] = np.asarray(value)
        return listed

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Take up copies of what to_arrays() gave."""
        self.take_arrays({name: arrays[name].copy() for name in self.to_arrays()})

    def take_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Take up what to_arrays() gave."""
        for own in self.names():
            name, value = f"{self.owner}.{own}", getattr(self, own)
            if isinstance(value, dict):
                found = {key: [arrays[f"{name}.{key}.{i}"] for i in range(len(of))] for key, of in value.items()}
                setattr(self, own, found)
            elif isinstance(value, list):
                setattr(self, own, [arrays[f"{name}.{i}"] for i in range(len(value))])
            elif isinstance(value, np.ndarray):
                setattr(self, own, arrays[name])
            else:
                setattr(self, own, type(value)(arrays[name]))


Owned = TypeVar("Owned", bound=Arrays)
_Value = NDArray[np.generic] | list[NDArray[np.generic]] | dict[str, list[NDArray[np.generic]]] | float


def _copy(value: _Value) -> object:
    if isinstance(value, dict):
        return {key: [a.copy() for a in of] for key, of in value.items()}
    if isinstance(value, list):
        return [a.copy() for a in value]
    return value.copy() if isinstance(value, np.ndarray) else value


@dataclass
class NodeArrays(Arrays):
    """Displacements of the nodes and forces on them, f freedoms a node: 2 in the plane, 3 in space, 6 in shells.

    Solids in space whose nodes have a pressure have 4: what belongs to the pressure comes last, as a length [mm]
    (Mechanics.pressure_scale), and its equation as a force.
    """

    owner = "nodes"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "displacement": ANEW,
        "increment": MOTION,
        "reaction": ANEW,
        "external_force": ANEW,
    }
    displacement: FloatArray
    """Displacement from the points of the mesh (n_points, f) [mm]; of a shell also the sum of the increments' rotation
    vectors [rad]."""
    increment: FloatArray
    """Displacement of the last increment, in the same form: the first guess of the next."""
    reaction: FloatArray
    """Force that tools and supports exert on the nodes (n_points, f) [N]; of a shell with moments [N mm]."""
    external_force: FloatArray
    """Applied loads, in the same form."""

    @property
    def moved(self) -> FloatArray:
        """How far the nodes have moved (n_points, 2 | 3) [mm], without rotations and pressures."""
        return self.displacement[:, :3]

    @classmethod
    def at_rest(cls, n_points: int, freedoms: int) -> NodeArrays:
        """Return the arrays of nodes that have not moved."""
        return cls(*(np.zeros((n_points, freedoms)) for _ in fields(cls)))


@dataclass
class CellArrays(Arrays):
    """Arrays of the integration points of the cells, a list entry for each block.

    p points a cell; of shells q points in the plane times k layers from bottom to top, layers within points.
    """

    owner = "cells"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "stress": POINT,
        "eqps": POINT,
        "temperature": POINT,
        "rate": POINT,
        "history": POINT,
        "volume": ANEW,
        "hourglass": CELL,
        "mixture": POINT,
    }
    stress: list[FloatArray]
    """Cauchy stress xx, yy, zz, xy (n_cells, p, 4), in space also yz, zx (n_cells, p, 6); of shells xx, yy, xy in the
    lamina frame (n_cells, p, 3) [MPa]."""
    eqps: list[FloatArray]
    """Equivalent plastic strain (n_cells, p)."""
    temperature: list[FloatArray]
    """Temperature given to the points at the end of the increment (n_cells, p) [degrees C]; the rise that a law
    computes from plastic work is added. At rest that of the start; no rows where the material does not depend on
    temperature."""
    rate: list[FloatArray]
    """Rate of the equivalent plastic strain in the increment (n_cells, p) [1/s]; no rows where the material does not
    depend on it."""
    history: list[FloatArray]
    """What the law keeps, as `kept` names it: in solids besides eqps (n_cells, p, n_history), in shells with eqps first
    (n_cells, q, k, n_history)."""
    volume: list[FloatArray]
    """Volume of each point (n_cells, p) [mm3]."""
    hourglass: list[FloatArray]
    """Hourglass data of solids (n_cells, 2): hourglass forces of quad4_1pt [N]; how fast flow relaxes the bubble of
    tet4_mini [1/s] and 0; else zero."""
    mixture: list[FloatArray] = field(default_factory=list)
    """What the phases of a point make (n_cells, p, 3): strain, K phi [1/MPa] and factor on the flow stress, as
    law/phase_mixture.py has them; no rows where a material has no phases, no entries in shells."""
    kept: list[History] = field(default_factory=list, metadata={"is_array": False})
    """The parts of `history` by name, as the law of each block declares them."""

    def find_kept(self, block: int, name: str) -> FloatArray:
        """Return a view of a part of a block's history (n_cells, p | q, k, size), of one value (n_cells, p | q, k)."""
        return self.kept[block].of(name, self.history[block])


class State:
    """All owners' arrays at one instant. A checkpoint is a dump of the converged State."""

    def __init__(self, *owned: Arrays) -> None:
        self._owned: dict[type[Arrays], Arrays] = {}
        self.add(*owned)

    def add(self, *owned: Arrays) -> None:
        """Take in the arrays of owners. Raises ValueError if there are others of this name."""
        for arrays in owned:
            if arrays.owner in {a.owner for a in self._owned.values()}:
                raise ValueError(f"two owners of arrays in the State have the name {arrays.owner!r}")
            self._owned[type(arrays)] = arrays

    def replace(self, arrays: Arrays) -> None:
        """Take these arrays of an owner in place of those that there are."""
        self._owned[type(arrays)] = arrays

    def drop(self, kind: type[Arrays]) -> None:
        """Leave out the arrays of an owner."""
        del self._owned[kind]

    def __getitem__(self, kind: type[Owned]) -> Owned:
        """Return the arrays of an owner. Raises KeyError if the model does not have it."""
        return cast(Owned, self._owned[kind])

    def __contains__(self, kind: type[Arrays]) -> bool:
        """Return whether the model has an owner of such arrays."""
        return kind in self._owned

    @property
    def nodes(self) -> NodeArrays:
        """Arrays of the nodes."""
        return self[NodeArrays]

    @property
    def cells(self) -> CellArrays:
        """Arrays of the cells."""
        return self[CellArrays]

    def duplicate(self) -> State:
        """Return a deep copy."""
        return State(*(arrays.duplicate() for arrays in self._owned.values()))

    def __iter__(self) -> Iterator[Arrays]:
        """Go through the arrays of all owners."""
        return iter(self._owned.values())

    def take_over(self, before: State) -> None:
        """Take over from another mesh the arrays that fit any mesh."""
        for kind, owned in self._owned.items():
            for name, becomes in owned.on_new_mesh.items():
                if becomes == RUN:
                    setattr(owned, name, _copy(getattr(before._owned[kind], name)))

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array as `owner.name`, for a checkpoint."""
        return {name: a for arrays in self._owned.values() for name, a in arrays.to_arrays().items()}

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Fill this State from a checkpoint's arrays.

        Raises ValueError if they are those of another model.
        """
        own = self.to_arrays()
        if set(own) != set(arrays) or any(own[k].shape != arrays[k].shape for k in own):
            raise ValueError("the checkpoint belongs to another case: its arrays do not fit this mesh and these tools")
        for owned in self._owned.values():
            owned.load_arrays(arrays)
