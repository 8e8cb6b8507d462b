# SPDX-License-Identifier: Apache-2.0
"""The Model: everything that is known before the first increment, as frozen data without behaviour.

Units are mm, s, t, N, MPa throughout. The model plane is (x, y); in axisymmetry x is the radius and y the axis. A shell
lies in (x, y, z), and its nodes turn about x, y, z too.
Directions and boundaries have names, never integer tags.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.formability import Formability

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]
IndexArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]
MaskArray = NDArray[np.uint8]

Analysis = Literal["axisymmetric", "plane_strain", "shell"]
SolidElement = Literal[
    "tri3", "tri6_6pt", "tri6_7pt", "quad4", "quad4_fbar", "quad4_1pt", "quad8", "quad8_2x2", "quad9", "quad9_2x2"
]
ShellElement = Literal[
    "shell3", "shell3_mitc", "shell3_mitc_plus",
    "shell6", "shell6_selective", "shell6_reduced", "shell6_mitc",
    "shell4", "shell4_selective", "shell4_reduced", "shell4_mitc", "shell4_mitc_plus", "shell4_1pt",
    "shell8", "shell8_selective", "shell8_reduced",
    "shell9", "shell9_selective", "shell9_reduced", "shell9_mitc",
]  # fmt: skip
ExplicitElement = Literal["shell4_one_point", "shell4_mitc_plus", "shell3_one_point"]
ElementName = Literal[SolidElement, ShellElement, ExplicitElement]
ThicknessRule = Literal["gauss", "lobatto", "simpson"]
HardeningLaw = Literal["linear", "swift", "ludwik", "voce", "hockett_sherby", "table", "swift_voce", "monotone_table"]
Integrator = Literal["backward_euler", "radial_return", "direct", "tangent_radial_return", "secant", "substepping"]
StrainMeasure = Literal["log", "stretch", "green_lagrange", "small"]
ContactLaw = Literal["frictionless", "sticking", "shear", "coulomb", "coulomb_capped"]
UmatJacobian = Literal["stress_increment", "jaumann_kirchhoff"]
FrictionTangent = Literal["return_mapping", "bond", "residual"]


@dataclass(frozen=True)
class Section:
    """A sheet through its thickness."""

    thickness: float
    """[mm]"""
    points: int = 5
    """Integration points through the thickness, 2 to 51."""
    rule: ThicknessRule = "gauss"
    """gauss: the most accurate; lobatto, simpson: with points on both faces."""


@dataclass(frozen=True)
class CellBlock:
    """Cells of one kind and one element formulation."""

    element: ElementName
    connectivity: IntArray
    """Node indices, shape (n_cells, n_nodes), counter-clockwise: corners first, then mid-sides, then the centre."""
    material: int
    """Index into Model.materials."""
    section: Section | None = None
    """Of a shell."""


@dataclass(frozen=True)
class Mesh:
    """Points, cell blocks and named sets."""

    points: FloatArray
    """Coordinates [mm], shape (n_points, 2); of shells (n_points, 3)."""
    blocks: tuple[CellBlock, ...]
    node_sets: Mapping[str, IntArray]
    """Node indices by name, each sorted and unique."""
    edge_sets: Mapping[str, IntArray]
    """Boundary edges by name, shape (n_edges, 2 | 3): first end, last end[, mid-side], the body on the left."""
    boundary_edges: IntArray
    """Every boundary edge of the mesh, in the same form."""
    normals: FloatArray | None = None
    """Of a shell whose exact surface is known: its unit normals at the nodes (n_points, 3); without it, means of the
    cells' normals."""


@dataclass(frozen=True)
class Hardening:
    """Flow stress against equivalent plastic strain; see docs/theory/material.md for the laws' formulas."""

    law: HardeningLaw
    parameters: FloatArray
    """linear: [yield_stress, modulus]; swift: [K, e0, n]; ludwik: [yield_stress, K, n];
    voce: [yield_stress, saturation_stress, rate]; hockett_sherby: [yield_stress, saturation_stress, rate, exponent];
    table: [e0, s0, e1, s1, ...]; monotone_table: [e0, s0, slope0, e1, s1, slope1, ...];
    swift_voce: [voce_share, K, e0, n, yield_stress, saturation_stress, rate]. Stresses in MPa."""


@dataclass(frozen=True)
class YieldFunction:
    """Anisotropic yield function of a sheet; see docs/theory/sheet_material.md for the formulas."""

    law: Literal["hill1948", "barlat1989", "yld2000"]
    parameters: tuple[float, ...]
    """hill1948: F, G, H, L, M, N; barlat1989: a, c, h, p; yld2000: alpha 1 to 8."""
    exponent: int = 2
    """6 or 8 of barlat1989 and yld2000."""


@dataclass(frozen=True)
class Kinematic:
    """Back stresses of a sheet; see docs/theory/sheet_material.md for the laws."""

    law: Literal["chaboche", "yoshida_uemori"]
    parameters: tuple[float, ...]
    """chaboche: every C [MPa], then every gamma; yoshida_uemori: B, C, m, b, Rsat, h (stresses in MPa)."""


@dataclass(frozen=True)
class Rate:
    """Factor on the flow stress of a sheet by plastic strain rate."""

    law: Literal["cowper_symonds", "johnson_cook", "logarithmic"]
    parameters: tuple[float, float]
    """cowper_symonds: D [1/s], q; johnson_cook, logarithmic: C, reference rate [1/s]."""


@dataclass(frozen=True, kw_only=True)
class Heating:
    """Adiabatic heating by plastic work, and softening by 1 - T*^exponent, T* from 0 at `reference` to 1 at `melting`.

    Temperatures in degrees C; heat_capacity [mm2/(s2 K)] (steel has 4.6e8, that is 460 J/(kg K)); plastic_fraction: of
    the plastic work that becomes heat (Taylor & Quinney 1934).
    """

    melting: float
    exponent: float
    heat_capacity: float
    plastic_fraction: float = 0.9
    reference: float = 20.0
    start: float = 20.0


@dataclass(frozen=True)
class Umat:
    """A material law from a shared library with Abaqus's interface UMAT."""

    library: str
    """Full path of the shared library."""
    props: tuple[float, ...]
    """PROPS, in mm, s, MPa as the routine wants them."""
    n_state: int
    """NSTATV."""
    jacobian: UmatJacobian = "stress_increment"
    """What DDSDDE is the derivative of; see docs/theory/material.md."""
    thread_safe: bool = False
    """Several threads may call it at once."""
    plastic_strain: int = 0
    """Which state variable is the equivalent plastic strain, from 1; 0: none."""


@dataclass(frozen=True)
class Material:
    """Isotropic elasticity with von Mises plasticity; in a shell with a sheet's laws beside; or a UMAT."""

    name: str
    young: float
    """Young's modulus [MPa]; of a UMAT that of its first tangent, by which stiffness and energy are judged."""
    poisson: float
    hardening: Hardening | None
    """None of a UMAT."""
    yield_function: YieldFunction | None = None
    """Of a shell, x along the rolling direction; None is von Mises."""
    kinematic: Kinematic | None = None
    rate: Rate | None = None
    young_decrease: tuple[float, float] | None = None
    """Young's modulus after large plastic strain [MPa], and the rate at which it gets there."""
    umat: Umat | None = None
    """Of a solid: the law, instead of hardening."""
    density: float = 0.0
    """[t/mm3]; only dynamics asks for it."""
    heating: Heating | None = None
    """Of a solid in explicit dynamics."""
    formability: Formability = field(default_factory=Formability)
    """Of a sheet: what its strains are judged by."""


@dataclass(frozen=True)
class Spring:
    """A spring behind a tool, which rests against a stop until the workpiece pushes it with more than the preload."""

    stiffness: float
    """[N/mm] of the whole tool."""
    preload: float
    """[N] on the whole tool."""
    direction: tuple[float, float]
    """Unit vector along which the tool gives way."""


@dataclass(frozen=True)
class Tool:
    """A rigid profile that moves without deforming."""

    name: str
    segments: FloatArray
    """Shape (n_segments, 7): x0, y0, x1, y1, centre x, centre y, turn; turn is 0 for a line, +1 for an arc that runs
    counter-clockwise, -1 clockwise. Directed so that the tool's metal is on the right, the workpiece on the left."""
    contact: ContactLaw
    m: FloatArray
    """Friction factor of "shear" and "coulomb_capped" by segment (n_segments,), 0 to 1: tau = m k, k the shear flow
    stress."""
    mu: FloatArray
    """Coefficient of friction of "coulomb" and "coulomb_capped" by segment (n_segments,)."""
    mirrored_across: tuple[bool, bool] = (False, False)
    """Plane strain: whether the whole tool is twice what is modelled, mirrored by a symmetry plane normal to x | y."""
    centre: tuple[float, float] = (0.0, 0.0)
    """About which it turns, and its torque is taken [mm]."""
    spring: Spring | None = None
    """On which it rests; its stages move the spring's foot."""


@dataclass(frozen=True)
class SheetTool:
    """A rigid tool in space, with Coulomb's friction, for shells."""

    name: str
    surface: _core.ToolSurface
    """In the tool's own frame."""
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of its frame at the start [mm]."""
    mu: float = 0.0


@dataclass(frozen=True)
class SheetBead:
    """A drawbead: a line in the plan x, y, cut into points, that holds a shell back from flowing across it."""

    name: str
    place: FloatArray
    """Of its points in the plan (n, 2) [mm]."""
    across: FloatArray
    """Unit normals of the line there (n, 2)."""
    length: FloatArray
    """Of the line that each point stands for (n,) [mm]."""
    force: float
    """Restraining force per length [N/mm]."""
    tool: str | None = None
    """That it moves with; None: it stands still."""


@dataclass(frozen=True)
class Body:
    """A body of its own: a run of the mesh's points and cell blocks that no other body uses."""

    name: str
    points: range
    blocks: range

    def owns(self, edges: IntArray) -> BoolArray:
        """Say which edges (n, 2 | 3) belong to the body, shape (n,)."""
        return np.asarray((edges[:, 0] >= self.points.start) & (edges[:, 0] < self.points.stop), dtype=bool)


@dataclass(frozen=True)
class BodyContact:
    """Contact between two bodies, or of a body with itself where both are the same."""

    name: str
    between: tuple[int, int]
    """Indices into Model.bodies, as the case names them."""
    slave: int
    """Index of the body whose nodes carry the pressure: one of the two."""
    contact: ContactLaw
    m: float = 0.0
    mu: float = 0.0

    @property
    def master(self) -> int:
        """The other body, or the same."""
        return self.between[1] if self.slave == self.between[0] else self.between[0]


@dataclass(frozen=True)
class Support:
    """Displacement components held at zero in every stage: symmetry planes, the axis, clamps."""

    node_set: str
    fix: tuple[bool, ...]
    """Of x, y; of a shell x, y, z and the rotations about x, y, z."""


@dataclass(frozen=True)
class PrescribedDisplacement:
    """A displacement component that grows linearly over the stage by `value` [mm]; of a shell also a rotation [rad]."""

    node_set: str
    component: Literal[0, 1, 2, 3, 4, 5]
    value: float


@dataclass(frozen=True)
class PointForce:
    """A total force [N] on a node set, shared equally by its nodes, reached linearly at the end of the stage.

    In axisymmetry it is the force on the whole ring; in plane strain on the whole depth. On a shell it has x, y, z and
    the moments about x, y, z [N mm]; its directions stay as they are.
    """

    node_set: str
    force: tuple[float, ...]


@dataclass(frozen=True)
class Pressure:
    """A follower pressure [MPa] on an edge set, positive into the body, reached linearly at the end of the stage."""

    edge_set: str
    value: float


@dataclass(frozen=True)
class ShellPressure:
    """A follower pressure [MPa] on the cells of a shell whose nodes are all in a set, along the cells' normals, reached
    linearly at the end of the stage.
    """

    node_set: str
    value: float


@dataclass(frozen=True)
class EdgeForce:
    """A force per length [N/mm] on an edge set of a shell, and a moment per length [N], of fixed directions and per
    undeformed length, reached linearly at the end of the stage.
    """

    edge_set: str
    force: tuple[float, ...]
    """x, y, z; or x, y, z and the moments about them."""


@dataclass(frozen=True)
class BodyForce:
    """A force per undeformed volume [N/mm3] on a whole shell, such as its weight, reached linearly at the end of the
    stage.
    """

    force: tuple[float, float, float]


@dataclass(frozen=True)
class ToolMotion:
    """What a tool does over a stage: it moves and turns linearly in time, or pushes with a force."""

    move: tuple[float, float] = (0.0, 0.0)
    """Displacement [mm]."""
    turn: float = 0.0
    """Angle [rad], counter-clockwise, about the tool's centre."""
    force: float | None = None
    """Instead of a move along `direction`: what the whole tool pushes with at the end of the stage [N], reached
    linearly from what it pushed with at its start."""
    direction: tuple[float, float] = (0.0, 0.0)
    """Unit vector along which a tool with a force pushes and is free to move."""


@dataclass(frozen=True)
class Push:
    """A force that places a tool in space."""

    direction: tuple[float, float, float]
    """Unit vector along which it pushes, and the tool is free to move."""
    force: FloatArray
    """Rows of part of the stage (0 to 1, increasing) and force on what is modelled [N] (n, 2), linear between them and
    constant beyond."""


@dataclass(frozen=True)
class Stage:
    """A part of the process in which every motion and load grows in proportion to the part that is done."""

    name: str
    duration: float = 1.0
    """[s]; counts for laws with a strain rate and for inertia alone."""
    clock: FloatArray | None = None
    """Of shells: rows of part done (0 to 1) and time [s] (n, 2), linear between them; None: in proportion."""
    tool_motion: Mapping[str, ToolMotion] = field(default_factory=dict)
    """Motion of each moving tool; a tool not named stands still."""
    sheet_tool_move: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    """Displacement of each moving tool in space [mm]; a tool not named stands still."""
    sheet_tool_push: Mapping[str, Push] = field(default_factory=dict)
    """Of each tool in space that a force places in this stage."""
    bead_share: Mapping[str, FloatArray] = field(default_factory=dict)
    """Of each bead: rows of part of the stage (0 to 1) and share of its force (n, 2), linear between them."""
    prescribed: tuple[PrescribedDisplacement, ...] = ()
    forces: tuple[PointForce, ...] = ()
    pressures: tuple[Pressure, ...] = ()
    shell_pressures: tuple[ShellPressure, ...] = ()
    edge_forces: tuple[EdgeForce, ...] = ()
    body_forces: tuple[BodyForce, ...] = ()

    def time_between(self, start: float, end: float) -> float:
        """Return the time between two parts of the stage [s]."""
        if self.clock is None:
            return self.duration * (end - start)
        first, last = np.interp([start, end], *self.clock.T)
        return float(last - first)


@dataclass(frozen=True)
class TangentTerms:
    """Which parts of the thesis's tangent are built; used only with SolverSettings.tangent = "thesis"."""

    strain_matrix: Literal["B0", "Bbar"] = "B0"
    """K_o = int B^T D B with the linear B0, or with the Green-Lagrange B0 + B_L on both sides."""
    k_e: bool = True
    k_u: bool = True
    k_v: bool = False
    modulus: Literal["consistent", "continuum"] = "continuum"
    """D of K_o: the derivative of the integrator, or the elastic-plastic matrix of the rate equation (Yamada)."""


@dataclass(frozen=True)
class SolverSettings:
    """How the implicit procedure integrates and iterates."""

    newton: Literal["full", "modified"] = "full"
    tangent: Literal["consistent", "thesis"] = "consistent"
    terms: TangentTerms = TangentTerms()
    symmetric: bool = True
    """Factorise the symmetric part of the tangent (see docs/theory/solver.md for what it costs in iterations)."""
    pressure_stiffness: bool = True
    """K_t: the follower stiffness of pressures."""
    friction_tangent: FrictionTangent = "return_mapping"
    """What friction adds to the tangent; the answer does not depend on it."""
    line_search: bool = True
    force_tolerance: float = 1e-4
    """Largest out-of-balance force over the largest internal nodal force."""
    displacement_tolerance: float = 1e-3
    """Largest correction over the largest displacement of the increment."""
    max_iterations: int = 20
    initial_increment: float = 0.01
    """Fraction of the stage."""
    min_increment: float = 1e-5
    max_increment: float = 0.02
    target_iterations: int = 6
    """Increments grow while they take fewer iterations than this."""
    strain_measure: StrainMeasure = "log"
    integrator: Integrator = "backward_euler"
    substeps: int = 10
    """Sub-increments of the "substepping" integrator."""
    hourglass_stiffness: float = 0.05
    """quad4_1pt: hourglass stiffness as a fraction of the material's current shear modulus."""
    control: Literal["load", "arc_length"] = "load"
    """What an increment prescribes: a part of the stage, or, on shells under loads alone, the length of path."""
    kirchhoff_penalty: float = 0.0
    """Shells: transverse shear stiffness added to the tangent alone, over the elastic one (C_p of K_p)."""
    contact_stiffness: float = 0.01
    """Shells on tools in space: stiffness of contact over that of the sheet across its thickness."""
    inertia: float = 0.0
    """Shells: mass over that of the sheet; what moves then resists, by backward Euler in the time of the stages."""
    damping: float = 0.0
    """Of this mass [1/s]."""


@dataclass(frozen=True)
class OutputSettings:
    """What is saved, and when."""

    every: int = 0
    """Save fields every so many increments; 0 saves at `steps` equally spaced times of each stage."""
    steps: int = 20
    at: tuple[float, ...] = ()
    """Further stage fractions at which an increment ends and fields are saved, counted in the last stage."""
    checkpoint_every: int = 10
    """Increments between checkpoints; of an explicit run rows."""
    rows: int = 200
    """Explicit: rows of the history of each stage."""


@dataclass(frozen=True)
class ExplicitSolid:
    """How the explicit procedure computes a solid."""

    velocity: tuple[float, float] = (0.0, 0.0)
    """Of the whole workpiece at the start [mm/s]."""
    target_step: float | None = None
    """Time step to reach by adding mass [s]; None: no mass is added."""
    damping: float = 0.0
    """Mass damping [1/s]."""
    hourglass_stiffness: float = 0.05
    """quad4_1pt: fraction of the shear modulus."""


@dataclass(frozen=True)
class Model:
    """A complete forming problem."""

    title: str
    analysis: Analysis
    depth: float
    """Plane strain: extent normal to the plane [mm]; 1 in axisymmetry."""
    mesh: Mesh
    materials: tuple[Material, ...]
    tools: tuple[Tool, ...]
    supports: tuple[Support, ...]
    stages: tuple[Stage, ...]
    solver: SolverSettings
    output: OutputSettings
    bodies: tuple[Body, ...] = ()
    """The workpiece first; empty stands for a single body."""
    sheet_tools: tuple[SheetTool, ...] = ()
    """Tools that a shell touches; `tools` are those of solids in the plane."""
    sheet_beads: tuple[SheetBead, ...] = ()
    """Drawbeads of a shell."""
    contacts: tuple[BodyContact, ...] = ()
    rolling_direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Of a shell: unit vector that, laid into the sheet, is x of its laws."""
    explicit: ExplicitSolid | None = None
    """Of a solid by the explicit procedure; None: the implicit one."""
    case_text: str = ""
    """The case file as read, kept with the results."""
