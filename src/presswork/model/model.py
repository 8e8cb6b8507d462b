# SPDX-License-Identifier: Apache-2.0
"""The Model: all data of a forming problem."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from itertools import groupby
from typing import Literal

import numpy as np

from presswork.formability import Formability, Judged
from presswork.model.arrays import FloatArray, IntArray
from presswork.model.contact import Body, BodyContact
from presswork.model.draw_in import DrawInDirection
from presswork.model.elements import ELEMENTS
from presswork.model.formed_sheet import FormedSheet
from presswork.model.gradients import Gradients
from presswork.model.heat import Heat, Series
from presswork.model.limits import Limits
from presswork.model.marked_point import MarkedPoint
from presswork.model.material import Material
from presswork.model.mesh import CellBlock, Mesh, Section
from presswork.model.operation import Operation
from presswork.model.remeshing import Remeshing, Separation
from presswork.model.settings import LARGE, ExplicitSheet, ExplicitSolid, OutputSettings, SolverSettings
from presswork.model.sheet import Hem, Refinement, SheetPressure, SheetSelfContact, Springback, TrimLine
from presswork.model.stage import CyclicSector, Stage, Support
from presswork.model.tool import Drawbead, Profile, Tool

Analysis = Literal["axisymmetric", "plane_strain", "solid", "shell", "stamping"]


_OF_THE_LINE = ("name", "place", "laid", "spaced", "closings")
"""Data of an operation beyond those of a Model of one operation."""


@dataclass(frozen=True)
class Model:
    """A complete forming problem.

    The blank of a stamping lies about z = 0 between tools that move along z; forces and strokes of its tools are those
    of the whole part, with symmetry planes too.
    """

    title: str
    analysis: Analysis
    mesh: Mesh
    materials: tuple[Material, ...]
    supports: tuple[Support, ...]
    stages: tuple[Stage, ...]
    solver: SolverSettings
    """Settings of the implicit procedure."""
    output: OutputSettings
    depth: float = 1.0
    """Plane strain: extent normal to the plane [mm]; 1 in axisymmetry."""
    tools: tuple[Tool, ...] = ()
    bodies: tuple[Body, ...] = ()
    """The workpiece first; empty for a single body."""
    beads: tuple[Drawbead, ...] = ()
    sheet_pressures: tuple[SheetPressure, ...] = ()
    """Stampings: pressures of fluids on the sheet; their courses are in the stages."""
    contacts: tuple[BodyContact, ...] = ()
    rolling_direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Shells: unit vector whose projection into the sheet is x of its laws."""
    zones: tuple[str, ...] = ()
    """Shells: names of the zones of a welded blank, the remaining blank first; empty: it has none."""
    is_relieved: bool = True
    """Stampings: whether tools are stepped for zones thinner than the thickest, half of the difference on each face."""
    symmetry: tuple[bool, bool] = (False, False)
    """Stampings: whether x = 0 and y = 0 are symmetry planes of the whole part."""
    explicit: ExplicitSolid | ExplicitSheet | None = None
    """Settings of the explicit procedure, for a solid or a stamping; None: the implicit procedure computes."""
    formed: FormedSheet | None = None
    """Stampings: the state of the sheet at the start; its mesh has these points. None: the blank is flat and free."""
    refinement: Refinement | None = None
    """Explicit stampings: refinement of the blank; None: the mesh stays as it is."""
    self_contact: SheetSelfContact | None = None
    """Stampings: contact of the sheet with itself; None: it passes through itself."""
    trim: tuple[TrimLine, ...] = ()
    """Stampings: lines along which the part is cut after the last stage."""
    springback: Springback | None = None
    """Stampings: springback after the last stage and the trimming; None: the part stays as it is."""
    hem: Hem | None = None
    """Stampings: the hem that is measured at the end; None: there is none."""
    operation: str = ""
    """Stampings: name of the operation that tools, beads, stages, trim and springback describe; empty: there is one."""
    following: tuple[Operation, ...] = ()
    """Stampings: the operations after it, in turn."""
    heat: Heat | None = None
    """Conduction of heat; None: temperatures are those of the materials' own heating."""
    series: Series | None = None
    """Solids with heat: parts formed one after another; None: one part."""
    gravity: tuple[float, ...] = ()
    """Acceleration of gravity (d,) [mm/s2], over the first stage of an implicit run and from the first cycle on of an
    explicit one; empty: none."""
    limits: Limits = field(default_factory=Limits)
    points: tuple[MarkedPoint, ...] = ()
    """Points of the material whose path, stress and strain the history has."""
    draw_in: tuple[DrawInDirection, ...] = ()
    """Stampings: directions in which the history has the draw-in of the edge."""
    one_step_thinning: float | None = None
    """Stampings: largest thinning that one step has estimated [%]; None: it was not asked."""
    cyclic: CyclicSector | None = None
    """Solids in space: the sector that is modelled of a body of cyclic symmetry; None: it is whole, or mirrored."""
    remeshing: Remeshing | None = None
    """Solids in the plane or in axisymmetry: new meshes in the run; None: one mesh to the end."""
    separation: Separation | None = None
    """Explicit solids in the plane or in axisymmetry: cracks that are cut into the mesh; None: cracks are reported."""
    gradients: Gradients | None = None
    """Derivatives that an implicit run finds as it goes; None: none."""
    case_text: str = ""
    """The case file as read, kept with the results."""

    def supports_in(self, stage: int) -> list[Support]:
        """Return the supports that hold in a stage."""
        return [s for s in self.supports if s.name not in self.stages[stage].released]

    @property
    def lasting_supports(self) -> list[Support]:
        """The supports that hold in every stage."""
        return [s for s in self.supports if not any(s.name in stage.released for stage in self.stages)]

    @property
    def operations(self) -> list[str]:
        """Names of all operations of a line, in turn; of one operation without a name that is empty."""
        return [self.operation, *(each.name for each in self.following)]

    def of_operation(self, number: int) -> Model:
        """Return the Model of an operation of a line alone, on the mesh of the blank."""
        if number == 0:
            return replace(self, following=())
        own = self.following[number - 1]
        parts = {each.name: getattr(own, each.name) for each in fields(own) if each.name not in _OF_THE_LINE}
        return replace(self, operation=own.name, following=(), **parts)

    @property
    def dimension(self) -> int:
        """How many coordinates a point has: 2 in the plane and in axisymmetry, else 3."""
        return 3 if self.analysis in ("solid", "shell", "stamping") else 2

    @property
    def freedoms(self) -> int:
        """How many freedoms a node has: displacements, then rotations in shells, or a pressure; one in heat alone."""
        if self.heat is not None and self.heat.alone:
            return 1
        if self.analysis in ("shell", "stamping"):
            return 6
        return max((ELEMENTS[block.element].freedoms for block in self.mesh.blocks), default=self.dimension)

    @property
    def takes_multigrid(self) -> bool:
        """Whether linear systems are solved by iteration, not by factors."""
        choice, n = self.solver.linear_solver, self.freedoms * len(self.mesh.points)
        is_large = n >= LARGE and not self.contacts  # bodies in contact hang on stiff springs
        return self.analysis == "solid" and (choice == "multigrid" or (choice == "auto" and is_large))

    @property
    def plane_tools(self) -> tuple[Tool, ...]:
        """Tools with a profile, which touch solids in the plane."""
        return tuple(tool for tool in self.tools if isinstance(tool.shape, Profile))

    @property
    def space_tools(self) -> tuple[Tool, ...]:
        """Tools with a surface in space, which touch sheets and solids in space."""
        return tuple(tool for tool in self.tools if not isinstance(tool.shape, Profile))

    @property
    def cells(self) -> IntArray:
        """Connectivity of a sheet's corners (n, 4), block after block, a triangle with its last node twice."""
        return self.mesh.corners

    @property
    def sheet(self) -> tuple[Section, Material]:
        """Section and material of a sheet; of a welded blank those of the first block."""
        block = self.mesh.blocks[0]
        assert block.section is not None
        return block.section, self.materials[block.material]

    @property
    def thickest(self) -> float:
        """Largest thickness of an undeformed sheet [mm]: tools leave room for it."""
        return max(float(block.thickness.max()) for block in self.mesh.blocks if block.section is not None)

    @property
    def sheet_materials(self) -> tuple[Material, ...]:
        """Materials of a sheet's blocks, each once."""
        return tuple(self.materials[i] for i in dict.fromkeys(block.material for block in self.mesh.blocks))

    @property
    def blocks_of_zones(self) -> list[tuple[CellBlock, ...]]:
        """Blocks of a sheet's cells, zone after zone."""
        return [tuple(of_zone) for _, of_zone in groupby(self.mesh.blocks, lambda block: block.zone)]

    @property
    def judged(self) -> Judged:
        """What the strains of a sheet are judged by, block after block; of one material once."""
        found: list[tuple[Formability, int]] = []
        for block in self.mesh.blocks:
            own, n = self.materials[block.material].formability, len(block.connectivity)
            if found and found[-1][0] is own:
                own, n = found[-1][0], n + found.pop()[1]
            found.append((own, n))
        return found

    def find_relief(self) -> list[FloatArray]:
        """Return by how much tools come nearer to each shell of the blocks than to the thickest (n_cells,) [mm]."""
        least = self.thickest if self.is_relieved else 0.0
        return [np.maximum(least - block.thickness, 0.0) for block in self.mesh.blocks]

    @property
    def whole(self) -> int:
        """How many times larger the whole part is than what is modelled."""
        return int(2 ** sum(self.symmetry))
