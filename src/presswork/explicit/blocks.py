# SPDX-License-Identifier: Apache-2.0
"""Blocks of elements of an explicit run in space: what a run is made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.evolution.damage import DamageLaw
from presswork.explicit.input_checks import check_density, check_shells, check_space_solids
from presswork.explicit.options import ShellOptions, layer_rule
from presswork.law.at_rest import history_at_rest
from presswork.law.umat import SheetLaw, SheetUmat, first_yield_stress
from presswork.mesh.topology import is_triangle, with_four_nodes
from presswork.model import ELEMENTS

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Parts = list[npt.NDArray[np.intp]]


@dataclass(frozen=True, kw_only=True)
class Shells:
    """4-node and 3-node shells of one law and density.

    connectivity (n, 4), nodes in turn round each shell, a triangle with its last node twice, or (n, 3) of triangles
    alone; thickness [mm], one or (n); law in plane stress: law.umat.open_sheet_law makes it of a material; density
    [t/mm3]; axis: x of the law (rolling direction), one vector or (n, 3), projected on each shell;
    damage: criteria whose damage grows in the layers; heating: for them, temperature at the start [degrees C] and
    whether the law heats. relief: how much nearer tools are to each other at each shell than they are drawn (n) [mm];
    empty: nowhere.
    """

    connectivity: npt.ArrayLike
    thickness: npt.ArrayLike
    law: SheetLaw
    density: float
    axis: npt.ArrayLike = (1.0, 0.0, 0.0)
    damage: tuple[DamageLaw, ...] = ()
    heating: tuple[float, bool] = (20.0, False)
    relief: npt.ArrayLike = ()
    options: ShellOptions = field(default_factory=ShellOptions)

    @property
    def cells(self) -> Ints:
        """The nodes (n, 4)."""
        return with_four_nodes(np.array(self.connectivity, dtype=np.int32))

    @property
    def axes(self) -> Array:
        """x of the law in each shell (n, 3)."""
        return np.broadcast_to(np.asarray(self.axis, dtype=float), (len(self.cells), 3))

    @property
    def thicknesses(self) -> Array:
        """Thickness of each shell (n) [mm]."""
        return np.broadcast_to(np.asarray(self.thickness, dtype=float), len(self.cells)).copy()

    def check(self, points: Array) -> None:
        """Raise ExplicitError for what no run can start from."""
        check_shells(points, self.cells, self.thicknesses, self.density, self.axes)

    def split(self, curve: npt.NDArray[np.intp]) -> Parts:
        """Return the numbers of quadrilaterals and of triangles in the order of a curve: blocks of the loop."""
        triangular = is_triangle(self.cells)[curve]
        return [part for part in (curve[~triangular], curve[triangular]) if len(part)]

    measures_nodes = False
    """Whether cells depend on the volumes of all cells round their nodes."""

    def add(
        self,
        loop: _core.SpaceLoop | _core.SpaceLoopSingle,
        part: npt.NDArray[np.intp],
        place: Ints,
        around: npt.NDArray[np.intp] | None = None,
    ) -> None:
        """Add a part to a loop; place: number there of each node. Raises ValueError."""
        cells, options, relief = self.cells[part], self.options, np.asarray(self.relief, dtype=float)
        height, weight = layer_rule(options.n_points, options.rule)
        loop.add_shells(
            np.ascontiguousarray(place[cells[:, : 3 if is_triangle(cells)[0] else 4]]),
            self.thicknesses[part],
            np.ascontiguousarray(self.axes[part]),
            self.law.umat if isinstance(self.law, SheetUmat) else self.law,
            self.density,
            height,
            weight,
            tabulate=options.tabulate,
            treatment=options.treatment,
            viscous=options.hourglass == "viscous",
            hourglass=options.coefficients,
            elastic=(self.law.young, self.law.poisson),
            yield_stress=first_yield_stress(self.law),
            number=part.tolist() if isinstance(self.law, SheetUmat) else [],
            relief=relief[part].tolist() if relief.size else [],
        )


@dataclass(frozen=True, kw_only=True)
class Solids:
    """Solids of one law and density: hexahedra "hex8" or "hex8_fbar", "hex8_1pt" of one point, tetrahedra "tet4_nodal".

    connectivity (n, 8 | 4), as cpp/reference has the nodes; law in space; density [t/mm3]. hourglass_fraction: of the
    shear modulus, that resists hourglass modes of hex8_1pt, and cells of tet4_nodal whose volume changes while that of
    their nodes stays. elastic: Young's modulus and Poisson's ratio of a UMAT's first tangent; rolling: unit vector
    along the law's x; porosity: at the start, of a metal with pores. Tools do not touch them.
    """

    connectivity: npt.ArrayLike
    law: _core.VonMises | _core.SolidLaw | _core.Umat
    density: float
    element: Literal["hex8", "hex8_fbar", "hex8_1pt", "tet4_nodal"] = "hex8_fbar"
    hourglass_fraction: float = 0.05
    elastic: tuple[float, float] = (0.0, 0.0)
    rolling: tuple[float, float, float] = (1.0, 0.0, 0.0)
    porosity: float = 0.0

    @property
    def cells(self) -> Ints:
        """The nodes (n, 8 | 4)."""
        return np.array(self.connectivity, dtype=np.int32)

    def check(self, points: Array) -> None:
        """Raise ExplicitError for what no run can start from."""
        check_space_solids(points, self.cells, ELEMENTS[self.element].nodes)
        check_density(self.density)

    def split(self, curve: npt.NDArray[np.intp]) -> Parts:
        """Return the numbers of the cells in the order of a curve: they are one block of the loop."""
        return [curve]

    @property
    def measures_nodes(self) -> bool:
        """Whether cells depend on the volumes of all cells round their nodes."""
        return self.element == "tet4_nodal"

    def add(
        self,
        loop: _core.SpaceLoop | _core.SpaceLoopSingle,
        part: npt.NDArray[np.intp],
        place: Ints,
        around: npt.NDArray[np.intp] | None = None,
    ) -> None:
        """Add the cells to a loop in double precision; place: number there of each node. Raises ValueError.

        around: cells round the nodes of the part, it and others, where others are computed elsewhere.
        """
        if not isinstance(loop, _core.SpaceLoop):
            raise ValueError("solids in space are computed in double precision")
        cells = np.ascontiguousarray(place[self.cells[part]])
        measured = np.ascontiguousarray(place[self.cells[part if around is None else around]])
        kept = history_at_rest(self.law, (), 6, rolling=self.rolling, porosity=self.porosity)
        loop.add_solids(
            self.element,
            cells,
            self.law,
            self.density,
            self.hourglass_fraction,
            measured,
            kept=kept.tolist(),
            elastic=self.elastic,
            number=part.tolist() if isinstance(self.law, _core.Umat) else [],
        )
