# SPDX-License-Identifier: Apache-2.0
"""The State: every array that changes during a run. Two exist: the converged one and the trial one."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.model import FloatArray, Model

ContactArray = NDArray[np.int8]

SLIDING = 1
STUCK = 2


@dataclass
class State:
    """Arrays at one instant; units mm, N, MPa. A checkpoint is a dump of the converged State."""

    displacement: FloatArray
    """Since the start (n_points, 2)."""
    increment: FloatArray
    """Of the last increment (n_points, 2): the first guess of the next."""
    reaction: FloatArray
    """Force that tools and supports exert on the nodes (n_points, 2) [N]."""
    external_force: FloatArray
    """Applied loads (n_points, 2) [N]."""
    tool_displacement: FloatArray
    """(n_tools, 2)."""
    tool_angle: FloatArray
    """(n_tools,) [rad]."""
    tool_travel: FloatArray
    """Part of tool_displacement that forces and springs have made (n_tools, 2)."""
    tool_travel_increment: FloatArray
    """Of the last increment (n_tools, 2)."""
    tool_gives: ContactArray
    """1 for a tool on a spring that is off its stop (n_tools,)."""
    tool_force_start: FloatArray
    """Force of the workpiece on each tool, as modelled, when the stage began (n_tools, 2) [N]."""
    contact: ContactArray
    """Per face of each tool and candidate node: 0 apart, 1 SLIDING, 2 STUCK; (2 n_tools, n_candidates)."""
    anchor: FloatArray
    """Where a STUCK node sits, in its tool's frame (n_candidates, 2)."""
    drag: FloatArray
    """Friction of each candidate along its tangent, a quarter turn from the normal (n_candidates,) [N]."""
    interface_pressure: FloatArray
    """Between bodies, per slave node of each contact (n_slots,) [MPa]."""
    interface_shear: FloatArray
    """Along the slave edge (n_slots,) [MPa]."""
    interface_slip: FloatArray
    """Elastic slip of nodes that stick, still to be undone (n_slots,) [mm]."""
    interface_force: FloatArray
    """Of the bodies on each other, at the nodes (n_points, 2) [N]; no rows without contact of bodies."""
    search_displacement: FloatArray
    """At which edges that may touch were last looked for (n_points, 2) [mm]; no rows without contact of bodies."""
    stress: list[FloatArray]
    """Cauchy stress xx, yy, zz, xy per block (n_cells, n_points, 4)."""
    eqps: list[FloatArray]
    """Equivalent plastic strain per block (n_cells, n_points)."""
    hourglass: list[FloatArray]
    """Hourglass forces per block (n_cells, 2) [N]; zero but for quad4_1pt."""
    volume: list[FloatArray]
    """Volume of each integration point per block (n_cells, n_points) [mm3]."""
    progress: FloatArray
    """[time, stage, fraction of stage, increments, last increment, next size, iterations, cut-backs]."""
    work: FloatArray
    """[work done on the nodes by tools, supports and loads; plastic work; work lost in friction on tools] [N mm]."""
    peak_force: FloatArray
    """Largest nodal force so far (1,) [N]: what a residual is small beside once the load is taken off."""

    @classmethod
    def at_rest(cls, model: Model, n_candidates: int, n_slots: int = 0) -> State:
        """Return the State before the first increment."""
        n = len(model.mesh.points)
        n_coupled = n if model.contacts else 0
        sizes = [(len(b.connectivity), _core.element_sizes(b.element)[1]) for b in model.mesh.blocks]
        n_tools = len(model.tools)
        return cls(
            displacement=np.zeros((n, 2)),
            increment=np.zeros((n, 2)),
            reaction=np.zeros((n, 2)),
            external_force=np.zeros((n, 2)),
            tool_displacement=np.zeros((n_tools, 2)),
            tool_angle=np.zeros(n_tools),
            tool_travel=np.zeros((n_tools, 2)),
            tool_travel_increment=np.zeros((n_tools, 2)),
            tool_gives=np.zeros(n_tools, dtype=np.int8),
            tool_force_start=np.zeros((n_tools, 2)),
            contact=np.zeros((2 * n_tools, n_candidates), dtype=np.int8),
            anchor=np.zeros((n_candidates, 2)),
            drag=np.zeros(n_candidates),
            interface_pressure=np.zeros(n_slots),
            interface_shear=np.zeros(n_slots),
            interface_slip=np.zeros(n_slots),
            interface_force=np.zeros((n_coupled, 2)),
            search_displacement=np.zeros((n_coupled, 2)),
            stress=[np.zeros((*s, 4)) for s in sizes],
            eqps=[np.zeros(s) for s in sizes],
            hourglass=[np.zeros((s[0], 2)) for s in sizes],
            volume=[np.zeros(s) for s in sizes],
            progress=np.zeros(8),
            work=np.zeros(3),
            peak_force=np.zeros(1),
        )

    def duplicate(self) -> State:
        """Return a deep copy."""
        other = copy(self)
        for f in fields(self):
            value = getattr(self, f.name)
            setattr(other, f.name, [a.copy() for a in value] if isinstance(value, list) else value.copy())
        return other

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array under a name of its own, for a checkpoint."""
        arrays: dict[str, NDArray[np.generic]] = {}
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, list):
                arrays.update({f"{f.name}.{i}": a for i, a in enumerate(value)})
            else:
                arrays[f.name] = value
        return arrays

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Fill this State from a checkpoint's arrays.

        Raises ValueError if they are those of another model.
        """
        own = self.to_arrays()
        if set(own) != set(arrays) or any(own[k].shape != arrays[k].shape for k in own):
            raise ValueError("the checkpoint belongs to another case: its arrays do not fit this mesh and these tools")
        for name, target in own.items():
            target[...] = arrays[name]
