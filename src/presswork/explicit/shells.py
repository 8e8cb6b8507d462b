# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics of shells alone, and of a sheet that is refined during the run.

    run = ExplicitShells(points, connectivity, thickness, law, density)
    run.fix(nodes, "uvw")
    run.velocity = ...
    run.scale_mass(2e-7)
    run.advance(1000)
    run.energies().error_percent

Units are mm, s, t, N, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork.evolution.damage import DamageLaw
from presswork.explicit.blocks import Shells
from presswork.explicit.device import Device as Device
from presswork.explicit.dynamics import PHASES as PHASES
from presswork.explicit.dynamics import SAFETY as SAFETY
from presswork.explicit.input_checks import ExplicitError as ExplicitError
from presswork.explicit.options import ShellOptions as ShellOptions
from presswork.explicit.space import Precision as Precision
from presswork.explicit.space import SpaceDynamics
from presswork.law.umat import SheetLaw
from presswork.ranks.world import World

FREEDOMS = SpaceDynamics.FREEDOMS


class ExplicitShells(SpaceDynamics):
    """4-node and 3-node shells in explicit dynamics: one block of Shells, whose arguments these are."""

    def __init__(
        self,
        points: npt.ArrayLike,
        connectivity: npt.ArrayLike,
        thickness: npt.ArrayLike,
        law: SheetLaw,
        density: float,
        *,
        axis: npt.ArrayLike = (1.0, 0.0, 0.0),
        damage: tuple[DamageLaw, ...] = (),
        heating: tuple[float, bool] = (20.0, False),
        options: ShellOptions | None = None,
        precision: Precision = "double",
        device: Device = "cpu",
        hanging: npt.ArrayLike = (),
        world: World | None = None,
    ) -> None:
        shells = Shells(
            connectivity=connectivity,
            thickness=thickness,
            law=law,
            density=density,
            axis=axis,
            damage=damage,
            heating=heating,
            options=options or ShellOptions(),
        )
        super().__init__(points, [shells], precision=precision, device=device, hanging=hanging, world=world)

    @classmethod
    def of_zones(
        cls,
        points: npt.ArrayLike,
        zones: Sequence[Shells],
        *,
        precision: Precision = "double",
        device: Device = "cpu",
        hanging: npt.ArrayLike = (),
        world: World | None = None,
    ) -> ExplicitShells:
        """Return a sheet of several laws, whose zones share nodes; shells are numbered zone after zone."""
        made = cls.__new__(cls)
        SpaceDynamics.__init__(made, points, zones, precision=precision, device=device, hanging=hanging, world=world)
        return made

    @property
    def zones(self) -> list[slice]:
        """Where the shells of each zone are among all."""
        ends = np.cumsum([len(block.cells) for block in self.blocks]).tolist()
        return [slice(begin, end) for begin, end in zip([0, *ends[:-1]], ends, strict=True)]

    def inherit(
        self,
        other: ExplicitShells,
        position: npt.ArrayLike,
        node_parents: npt.NDArray[np.int32],
        parent: npt.NDArray[np.int32],
    ) -> float:
        """Begin with the state of another run some shells of which are split here, at positions (n_nodes, 3).

        parent: shell of the other run that each comes from, or is (n,); node_parents: nodes of it whose mean velocity
        and traction each node gets (n_nodes, 4). Tools must be like those of the other run. Mass goes by undeformed
        area. Returns the kinetic energy that interpolation has taken [N mm], which is no error of the balance.
        """
        before = other._kinetic()
        area = self._by_element(self._loop.element_mass)
        share = area / np.bincount(parent, area)[parent]
        share[np.bincount(parent)[parent] == 1] = 1.0
        place, element_place = np.empty(len(other.start), np.int32), np.empty(len(other.connectivity), np.int32)
        place[other._nodes], element_place[other._elements] = np.arange(len(place)), np.arange(len(element_place))
        loop: Any = self._loop  # of the same precision as the other
        loop.inherit(
            other._loop,
            np.asarray(position, dtype=float)[self._nodes],
            np.ascontiguousarray(place[node_parents][self._nodes]),
            element_place[parent[self._elements]],
            share[self._elements],
            other.dt,
        )
        if other.prescribed_temperature is not None:
            self.prescribed_temperature = other.prescribed_temperature[parent]
        self.cycle, self.time = other.cycle, other.time
        self.dt = min(other.dt, SAFETY * self.stable_step())
        self._contact_step, self._new_tools = other._contact_step, []
        lost = before - self._kinetic()
        if other._reference:
            start, largest = other._reference
            self._reference = (start - lost, largest)
        return lost
