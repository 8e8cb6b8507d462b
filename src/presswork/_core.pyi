"""Compiled kernels: elements, materials, contact and assembly."""

from collections.abc import Callable, Mapping, Sequence
import enum
from typing import Annotated, overload

import numpy
from numpy.typing import NDArray


pack_width: int = 4

architecture: str = 'native'

def set_threads(n: int) -> None:
    """Set the number of threads of every loop."""

def max_threads() -> int:
    """Number of threads that loops use."""

class StrainMeasure(enum.Enum):
    """Strain of an increment as a function of its stretch U."""

    log = 0

    stretch = 1

    green_lagrange = 2

    small = 3

def measure_increments(F: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], measure: StrainMeasure) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Strain (n, 4: xx, yy, zz, xy), rotation (n, 2: cosine, sine) and d strain / d l* (n, 4, 5) of increments F (n, 5).
    """

class HardeningLaw(enum.Enum):
    """Flow stress against equivalent plastic strain."""

    linear = 0

    swift = 1

    ludwik = 2

    voce = 3

    linear_voce = 4

    hockett_sherby = 5

    table = 6

    swift_voce = 7

    monotone_table = 8

    hensel_spittel = 9

    norton_hoff = 10

    sinh_arrhenius = 11

    johnson_cook = 12

    hot_table = 13

@overload
def parameter_names(law: HardeningLaw) -> list[str]:
    """
    Names of a hardening law's parameters, in the order in which they are given; a table has points.
    """

@overload
def parameter_names(law: RateLaw) -> list[str]:
    """Names of a rate law's parameters."""

def is_hot(law: HardeningLaw) -> bool:
    """
    Whether its flow stress is one of strain, strain rate and temperature together.
    """

class Integrator(enum.Enum):
    """Stress integrator of the von Mises law."""

    backward_euler = 0

    radial_return = 1

    direct = 2

    tangent_radial_return = 3

    secant = 4

    substepping = 5

class Modulus(enum.Enum):
    """Derivative of the integrator, or the rate equation's matrix."""

    consistent = 0

    continuum = 1

class VonMises:
    """Isotropic elasticity with von Mises plasticity; stresses in MPa."""

    def __init__(self, young: float, poisson: float, hardening: HardeningLaw, parameters: Sequence[float], *, integrator: Integrator = Integrator.backward_euler, substeps: int = 10, modulus: Modulus = Modulus.consistent) -> None: ...

    def flow_stress(self, eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """Flow stress and its slope [MPa] at equivalent plastic strains (n)."""

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Advance points by strain increments (n, 4), or (n, 6) in space: xx, yy, zz, xy, yz, zx; returns stress, eqps (n) and tangent (n, 4, 4) or (n, 6, 6).
        """

class RateLaw(enum.Enum):
    """Factor on the flow stress by strain rate."""

    none = 0

    cowper_symonds = 1

    johnson_cook = 2

    logarithmic = 3

class YieldFunction:
    """Equivalent stress, homogeneous of degree one."""

    @staticmethod
    def hill1948(parameters: Sequence[float]) -> YieldFunction:
        """
        Hill 1948 from F, G, H, L, M, N; von Mises is 1/2, 1/2, 1/2, 3/2, 3/2, 3/2.
        """

    @staticmethod
    def barlat1989(a: float, c: float, h: float, p: float, exponent: int) -> YieldFunction:
        """Barlat & Lian 1989, of plane stress; the exponent is 6 or 8."""

    @staticmethod
    def yld2000(alpha: Sequence[float], exponent: int) -> YieldFunction:
        """Yld2000-2d from alpha 1 to 8, of plane stress; the exponent is 6 or 8."""

    @staticmethod
    def yld2004(prime: Sequence[float], double_prime: Sequence[float], exponent: int) -> YieldFunction:
        """
        Yld2004-18p from c12, c13, c21, c23, c31, c32, c44 (yz), c55 (zx), c66 (xy) of both transformations; the exponent is 6 or 8.
        """

    @property
    def of_plane_stress_alone(self) -> bool:
        """Whether there is no such function of a stress in space."""

    def evaluate(self, stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Equivalent stress (n), its gradient (n, N) and Hessian (n, N, N) at stresses (n, N): xx, yy, xy; xx, yy, zz, xy; or xx, yy, zz, xy, yz, zx.
        """

class Chaboche:
    """Back stresses d a = C (stress - back)/flow dp - gamma a dp."""

    def __init__(self, C: Sequence[float], gamma: Sequence[float]) -> None: ...

class YoshidaUemori:
    """Two surfaces: Yoshida & Uemori 2002; stresses in MPa."""

    def __init__(self, *, Y: float, B: float, C: float, m: float, b: float, Rsat: float, h: float) -> None: ...

class Thermal:
    """Softening by temperature and adiabatic heating; degrees C."""

    def __init__(self, *, start: float, reference: float, melting: float, exponent: float, heating: float) -> None:
        """heating: rise of temperature per plastic work and volume [degree/MPa]."""

class SheetLaw:
    """Elastic-plastic sheet in plane stress; stresses in MPa."""

    def __init__(self, young: float, poisson: float, yield_function: YieldFunction, hardening: HardeningLaw, parameters: Sequence[float], *, rate: RateLaw = RateLaw.none, rate_parameters: Mapping[str, float] = {}, chaboche: Chaboche | None = None, yoshida_uemori: YoshidaUemori | None = None, thermal: Thermal | None = None, young_saturated: float = 0.0, young_rate: float = 0.0, expansion: Sequence[float] = [], young_factor: Sequence[float] = [], poisson_curve: Sequence[float] = [], phases: bool = False) -> None:
        """
        expansion, young_factor, poisson_curve: rows of a temperature and c0, c1, c2 from there on. phases: whether points may be given a mixture: strain, K phi [1/MPa] and factor on the flow stress, each since the start.
        """

    @property
    def young(self) -> float:
        """Young's modulus at the start [MPa]."""

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""

    @property
    def history_size(self) -> int:
        """
        Values a point keeps: eqps, the rise of temperature if the law heats, then back stresses.
        """

    @property
    def heats(self) -> bool:
        """Whether plastic work raises the temperature."""

    def flow_stress(self, eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rate: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Flow stress and its slope by plastic strain [MPa] at equivalent plastic strains (n), their rates (n) [1/s], without them at rest, and temperatures (n) [degrees C], without them that of the start.
        """

    def rate_factor(self, rate: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Factor on the flow stress and its slope [s] at equivalent plastic strain rates (n) [1/s].
        """

    def differentiate(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float = 1.0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> NDArray[numpy.float64]:
        """
        d stress/d strain (n, N, N) of update by dual numbers: what its tangent must be.
        """

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float = 1.0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, tangent: bool = True, packed: bool = True, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.uint8]]:
        """
        Advance points by strain increments (n, 3) over dt [s] at temperatures (n), without them that of the start; returns stress (n, 3), history (n, history_size), thickness strain increment (n), tangent (n, 3, 3; (0, 3, 3) if not asked for) and failed (n).
        """

class PlaneLaw:
    """Elastic-plastic solid in plane strain or axisymmetry; stresses in MPa."""

    def __init__(self, young: float, poisson: float, yield_function: YieldFunction, hardening: HardeningLaw, parameters: Sequence[float], *, rate: RateLaw = RateLaw.none, rate_parameters: Mapping[str, float] = {}, chaboche: Chaboche | None = None, yoshida_uemori: YoshidaUemori | None = None, thermal: Thermal | None = None, young_saturated: float = 0.0, young_rate: float = 0.0, expansion: Sequence[float] = [], young_factor: Sequence[float] = [], poisson_curve: Sequence[float] = [], phases: bool = False) -> None:
        """
        expansion, young_factor, poisson_curve: rows of a temperature and c0, c1, c2 from there on. phases: whether points may be given a mixture: strain, K phi [1/MPa] and factor on the flow stress, each since the start.
        """

    @property
    def young(self) -> float:
        """Young's modulus at the start [MPa]."""

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""

    @property
    def history_size(self) -> int:
        """
        Values a point keeps: eqps, the rise of temperature if the law heats, then back stresses.
        """

    @property
    def heats(self) -> bool:
        """Whether plastic work raises the temperature."""

    def flow_stress(self, eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rate: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Flow stress and its slope by plastic strain [MPa] at equivalent plastic strains (n), their rates (n) [1/s], without them at rest, and temperatures (n) [degrees C], without them that of the start.
        """

    def rate_factor(self, rate: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Factor on the flow stress and its slope [s] at equivalent plastic strain rates (n) [1/s].
        """

    def differentiate(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float = 1.0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> NDArray[numpy.float64]:
        """
        d stress/d strain (n, N, N) of update by dual numbers: what its tangent must be.
        """

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float = 1.0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, tangent: bool = True, packed: bool = True, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.uint8]]:
        """
        Advance points by strain increments (n, 4): xx, yy, zz, xy; as SheetLaw.update, without thickness.
        """

class SolidLaw:
    """Elastic-plastic solid in space; stresses in MPa."""

    def __init__(self, young: float, poisson: float, yield_function: YieldFunction, hardening: HardeningLaw, parameters: Sequence[float], *, rate: RateLaw = RateLaw.none, rate_parameters: Mapping[str, float] = {}, chaboche: Chaboche | None = None, yoshida_uemori: YoshidaUemori | None = None, thermal: Thermal | None = None, young_saturated: float = 0.0, young_rate: float = 0.0, expansion: Sequence[float] = [], young_factor: Sequence[float] = [], poisson_curve: Sequence[float] = [], phases: bool = False) -> None:
        """
        expansion, young_factor, poisson_curve: rows of a temperature and c0, c1, c2 from there on. phases: whether points may be given a mixture: strain, K phi [1/MPa] and factor on the flow stress, each since the start.
        """

    @property
    def young(self) -> float:
        """Young's modulus at the start [MPa]."""

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""

    @property
    def history_size(self) -> int:
        """
        Values a point keeps: eqps, the rise of temperature if the law heats, then back stresses.
        """

    @property
    def heats(self) -> bool:
        """Whether plastic work raises the temperature."""

    def flow_stress(self, eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rate: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Flow stress and its slope by plastic strain [MPa] at equivalent plastic strains (n), their rates (n) [1/s], without them at rest, and temperatures (n) [degrees C], without them that of the start.
        """

    def rate_factor(self, rate: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Factor on the flow stress and its slope [s] at equivalent plastic strain rates (n) [1/s].
        """

    def differentiate(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float = 1.0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> NDArray[numpy.float64]:
        """
        d stress/d strain (n, N, N) of update by dual numbers: what its tangent must be.
        """

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float = 1.0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, tangent: bool = True, packed: bool = True, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.uint8]]:
        """
        Advance points by strain increments (n, 6): xx, yy, zz, xy, yz, zx; as SheetLaw.update, without thickness.
        """

class UmatJacobian(enum.Enum):
    """What a UMAT's DDSDDE is the derivative of."""

    stress_increment = 0

    jaumann_kirchhoff = 1

class LawStatus(enum.Enum):
    """How the call of a law ended."""

    done = 0

    smaller = 1

    not_finite = 2

    overrun = 3

    stopped = 4

    no_stress = 5

    components = 6

class LawFault:
    """The worst of what the calls of a law have told."""

    def __init__(self) -> None: ...

    @property
    def status(self) -> LawStatus: ...

    @property
    def cell(self) -> int:
        """In the block."""

    @property
    def step_factor(self) -> float:
        """Least PNEWDT."""

class UmatPlace:
    """Which increment a UMAT is called in."""

    def __init__(self, *, stage: int = 1, increment: int = 1, stage_time: float = 0.0, time: float = 0.0, dt: float = 1.0) -> None:
        """Counted from 1; times [s] are those of the increment's start."""

class Umat:
    """A material law from a shared library with Abaqus's UMAT interface."""

    def __init__(self, library: str, properties: Sequence[float], n_state: int, *, jacobian: UmatJacobian = UmatJacobian.stress_increment, thread_safe: bool = False, plastic_strain: int = 0) -> None:
        """
        Open the library; raises RuntimeError that says what is missing. plastic_strain: which state variable is the equivalent plastic strain, from 1, or 0.
        """

    @staticmethod
    def make_gtn(properties: Sequence[float]) -> Umat:
        """
        The law of a metal with pores; properties (20) as cpp/material/gtn.hpp has them.
        """

    @property
    def n_state(self) -> int: ...

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], state: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], dt: float = 1.0) -> tuple[LawStatus, NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Call it once at a small strain increment from no deformation: xx, yy, xy; xx, yy, zz, xy; or xx, yy, zz, xy, yz, zx (n). Returns status, stress (n), state (n_state) and tangent (n, n).
        """

class Rule:
    """A quadrature rule of a cell."""

    @property
    def points(self) -> int: ...

    @property
    def weights(self) -> NDArray[numpy.float64]:
        """Shape (points,)."""

    @property
    def shapes(self) -> NDArray[numpy.float64]:
        """Shape functions at the points (points, nodes)."""

    @property
    def slopes(self) -> NDArray[numpy.float64]:
        """Their derivatives (points, nodes, dimension)."""

class Cell:
    """
    A row of the table of cells; cpp/reference/quadrature.hpp says what its entries are.
    """

    @property
    def name(self) -> str: ...

    @property
    def plural(self) -> str: ...

    @property
    def dimension(self) -> int: ...

    @property
    def corners(self) -> int: ...

    @property
    def places(self) -> NDArray[numpy.float64]: ...

    @property
    def edges(self) -> list[list[int]]: ...

    @property
    def faces(self) -> list[list[int]]: ...

    @property
    def simplices(self) -> list[list[int]]: ...

    @property
    def pieces(self) -> list[list[int]]: ...

    @property
    def spans(self) -> list[list[int]]: ...

    @property
    def reversed(self) -> list[int]: ...

    @property
    def mass_shares(self) -> list[float]: ...

    @property
    def rules(self) -> list[Rule]: ...

def cells() -> list[Cell]:
    """The table of cells, a row each."""

class TangentKind(enum.Enum):
    """Which tangent an element builds."""

    none = 0

    consistent = 1

    thesis = 2

class PointSettings:
    """Kinematics and tangent of an integration point."""

    def __init__(self, *, measure: StrainMeasure = StrainMeasure.log, tangent: TangentKind = TangentKind.consistent, green_lagrange_matrix: bool = False, k_e: bool = True, k_u: bool = True, k_v: bool = False, small_displacements: bool = False) -> None: ...

class Family(enum.Enum):
    """Where an element serves."""

    plane = 0
    """Solids in plane strain and in axisymmetry."""

    space = 1
    """Solids in space."""

    shell = 2
    """Shells."""

class Element:
    """A row of the table of elements."""

    @property
    def name(self) -> str: ...

    @property
    def cell(self) -> str:
        """Kind of cell of the mesh."""

    @property
    def nodes(self) -> int: ...

    @property
    def points(self) -> int:
        """Integration points of a cell; of a shell those in its plane."""

    @property
    def family(self) -> Family: ...

    @property
    def description(self) -> str: ...

    @property
    def in_implicit(self) -> bool:
        """Whether the implicit procedure has it."""

    @property
    def in_explicit(self) -> bool:
        """Whether the explicit procedure has it."""

    @property
    def freedoms(self) -> int:
        """Of a node: displacements, then a pressure or rotations."""

def element_sizes(element: str) -> tuple[int, int]:
    """Number of nodes and of integration points of a solid."""

def elements() -> list[Element]:
    """The table of elements, a row each."""

def list_history(law: VonMises | AdiabaticMises | SheetLaw | PlaneLaw | SolidLaw | Umat, components: int) -> list[tuple[str, int, bool]]:
    """
    What a point keeps for a law behind its stress of so many components: name, number of values, and whether these are the directions of its axes (x in the plane, x and y in space), in their order.
    """

def evaluate_block(element: str, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], increment: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], law: VonMises | PlaneLaw | SolidLaw | Umat, settings: PointSettings, *, axisymmetric: bool, depth: float, hourglass_fraction: float, pressure: tuple[float, float, float] | None = None, stress_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], hourglass_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], hourglass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], volume: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], force: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], stiffness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')] | None, symmetric: bool = False, history_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, history: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')] | None = None, dt: float = 0.0, first_cell: int = 0, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, temperature_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, when: UmatPlace | None = None, fault: LawFault | None = None, mixture: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> int:
    """
    Evaluate a block of cells over one increment; fills stress, eqps, hourglass, volume, force and stiffness. history (n_cells, points, n_history) is what the law keeps besides stress and eqps; temperature (n_cells, points) [degrees C] is given at the end of the increment, without it that of the law's start; mixture (n_cells, points, 3) what phases make of a point: strain, K phi [1/MPa], factor on the flow stress. Returns the index of a cell turned inside out, or -1; what the law told is in fault.
    """

def differentiate_cell(element: str, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], increment: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], along: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], law: VonMises, settings: PointSettings, *, axisymmetric: bool, depth: float, hourglass_fraction: float, pressure: tuple[float, float, float] | None = None, stress_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], hourglass_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Forces (nodes, d) of one solid cell and their exact derivative along a move of its nodes, by dual numbers.
    """

class ShellFault(enum.Enum):
    """Why a shell could not be evaluated."""

    none = 0

    inside_out = 1

    turned_too_far = 2

    law = 3

    bubble = 4

def shell_sizes(element: str) -> tuple[int, int, int]:
    """
    Number of nodes of a shell, of integration points in its plane, and of values it keeps besides its points.
    """

def shell_shape(element: str) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Shape functions (q, nodes), their slopes (q, nodes, 2) and weights (q) at a shell's points, and the slopes at its nodes (nodes, nodes, 2).
    """

def evaluate_shells(element: str, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], director_of: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], undeformed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], increment: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], director: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], layer_position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], layer_weight: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], law: SheetLaw | Umat, *, dt: float, penalty: float, state_n: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]], state: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]], volume: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], force: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], stiffness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')] | None, symmetric: bool, small_displacements: bool = False, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None, young: float = 0.0, poisson: float = 0.0, first_cell: int = 0, when: UmatPlace | None = None, fault: LawFault | None = None) -> tuple[int, ShellFault]:
    """
    Evaluate a block of shells over one increment (n, 6): displacement and rotation vector. state: [thickness (n_cells, q), stress (n_cells, q, k, 3), history (n_cells, q, k, h), direction (n_cells, q, k, 2), shear (n_cells, q, 2)]. temperature (n_cells, q, k) [degrees C] is given at the end of the increment, without it that of the law's start. young and poisson are the elastic constants of a law from a shared library; what it told is in fault. Fills state, volume, force and stiffness; returns the first cell that failed, or -1, and why.
    """

def find_facing(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], own: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], other: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], reach: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], thickness: float) -> tuple[NDArray[numpy.int32], NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Points of a rule on edges own (n, 2) that edges other (m, 2) face within reach (n,): the two edges of each, the shape functions there, gap [mm] and area [mm2]; thickness 0: rings.
    """

def touch_profile(segments: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.int32]]:
    """
    Gap (n) and normal (n, 2) of points to a tool profile, those of the second face where a point lies in an inner corner (infinite elsewhere), and the indices of the segments touched by the first and the second (-1: none).
    """

class InterfaceResult:
    """Forces, tangent and slots of an interface between bodies."""

    @property
    def too_deep(self) -> int:
        """Pairs that have gone through each other in this increment."""

    @property
    def force(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the nodes (n_points, 2) [N]."""

    @property
    def pairs(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]:
        """Nodes of the blocks (n_blocks, 2)."""

    @property
    def blocks(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """d(-force) / d(position) (n_blocks, 2, 2) [N/mm]."""

    @property
    def pressure(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """(n_slots,) [MPa]."""

    @property
    def shear(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Along the slave edge (n_slots,) [MPa]."""

    @property
    def gap(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Weighted mean (n_slots,) [mm]; infinite where none faces."""

    @property
    def slip(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Weighted mean (n_slots,) [mm]."""

    @property
    def slope_places(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]:
        """Slots and nodes of the slopes (n, 2)."""

    @property
    def pressure_slopes(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """d pressure / d position of active slots (n, 2) [MPa/mm]."""

    @property
    def status(self) -> Annotated[NDArray[numpy.uint8], dict(writable=False)]:
        """0 apart, 1 sticks, 2 slides (n_slots,)."""

    @property
    def weight(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Surface in contact (n_slots,) [mm2]."""

    @property
    def push(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the master's nodes (n_points,) [N]."""

    @property
    def drag(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the master's nodes (n_points,) [N]."""

    @property
    def area(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Share of the master's nodes in the contact [mm2]."""

    @property
    def master_force(self) -> tuple[float, float]:
        """Of the slave on the master [N]."""

def evaluate_interface(slave: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], slots: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], x: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], x_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, slave_depth: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], master_depth: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], held: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], pressure: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], shear: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], slip: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], believed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], least_weight: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stiffness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], shear_limit: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mu: float, tangential_part: float, reach: float, touching: float, thickness: float, with_tangent: bool) -> InterfaceResult:
    """
    Mortar contact of slave and master edges at positions x; see interface.hpp.
    """

def find_edge_pairs(slave: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], x: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], margin: float, self: bool) -> NDArray[numpy.int32]:
    """
    Pairs of half-edges (n, 2) that may touch within the margin [mm], slave and master.
    """

class FaceInterfaceResult:
    """Forces, tangent and slots of an interface between bodies in space."""

    @property
    def too_deep(self) -> int:
        """Pairs that have gone through each other in this increment."""

    @property
    def force(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the nodes (n_points, 3) [N]."""

    @property
    def pairs(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]:
        """Nodes of the blocks (n_blocks, 2)."""

    @property
    def blocks(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """d(-force) / d(position) (n_blocks, 3, 3) [N/mm]."""

    @property
    def pressure(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """(n_slots,) [MPa]."""

    @property
    def shear(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the slave (n_slots, 3) [MPa]."""

    @property
    def gap(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Weighted mean (n_slots,) [mm]; infinite where none faces."""

    @property
    def slip(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Weighted mean (n_slots, 3) [mm]."""

    @property
    def normal(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Out of the slave (n_slots, 3); zero where none faces."""

    @property
    def slope_places(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]:
        """Slots and nodes of the slopes (n, 2)."""

    @property
    def pressure_slopes(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """d pressure / d position of active slots (n, 3) [MPa/mm]."""

    @property
    def status(self) -> Annotated[NDArray[numpy.uint8], dict(writable=False)]:
        """0 apart, 1 sticks, 2 slides (n_slots,)."""

    @property
    def weight(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Surface in contact (n_slots,) [mm2]."""

    @property
    def push(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the master's nodes (n_points,) [N]."""

    @property
    def drag(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """On the master's nodes (n_points, 3) [N]."""

    @property
    def area(self) -> Annotated[NDArray[numpy.float64], dict(writable=False)]:
        """Share of the master's nodes in the contact [mm2]."""

    @property
    def master_force(self) -> tuple[float, float, float]:
        """Of the slave on the master [N]."""

def evaluate_face_interface(slave: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], slots: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], x: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], x_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, slave_depth: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], master_depth: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], held: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], pressure: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], shear: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], slip: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], believed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], least_weight: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stiffness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], shear_limit: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mu: float, tangential_part: float, reach: float, touching: float, with_tangent: bool) -> FaceInterfaceResult:
    """
    Mortar contact of slave and master faces at positions x; see face_interface.hpp.
    """

def find_face_pairs(slave: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], x: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], margin: float, self: bool) -> NDArray[numpy.int32]:
    """
    Pairs of faces (n, 2) that may touch within the margin [mm], slave and master.
    """

def find_facing_faces(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], own: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], other: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], reach: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.int32], NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Points of a rule on faces own (n, 3 | 4) that faces other (m, 3 | 4) face within reach (n,): the two faces of each, the shape functions there, gap [mm] and area [mm2].
    """

class SheetOnItself:
    """Contact of a sheet with itself; see sheet_on_itself.hpp."""

    def __init__(self, blocks: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]], undeformed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, thickness: float) -> None:
        """
        blocks: corners of the cells of each, (n, 3) or (n, 4). undeformed (n_points, 3): by which shells near along the sheet are left out; thickness: the largest [mm].
        """

    def search(self, now: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], half_node: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], half_cell: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], margin: float) -> NDArray[numpy.int32]:
        """
        Take the shells within margin of touching each node as those it may touch; returns the pairs of nodes (n, 2) that this couples.
        """

    def look(self, now: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], before: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], half_node: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], half_cell: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], reach: float) -> tuple[NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64], int]:
        """
        What the faces of nodes touch with a gap below reach: cells (2 n_points,), -1 of none, gaps, infinite of none, and normals (2 n_points, 3); and a node that has come through a shell, -1 if none has.
        """

    def touch(self, now: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], before: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], half_node: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], half_cell: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], slots: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, push: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], slope: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], hanging: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], shear_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mu: float) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Forces on the nodes (n_points, 3), pairs (25 n, 2) and blocks (25 n, 3, 3) of d(-force)/dx, friction and way (n, 3) of each slot.
        """

def push_nodes(push: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], slope: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], normal: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rise: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], bend: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Normal forces of a tool on nodes (n, 3) [N] and their tangent (n, 3, 3) [N/mm], as node_on_tool.hpp says. push (n,) and slope (n,) by the gap; derivatives of gap (n, 3) and normal (n, 3, 3) by the place.
    """

def rub_nodes(push: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], slope: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], normal: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rise: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], bend: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, hanging: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], pulled: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], limit: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], by_push: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], tangent: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> NDArray[numpy.float64]:
    """
    Friction on nodes that a tool pushes (n, 3) [N], as node_on_tool.hpp says; its part is added to the tangent.
    """

class ToolSurface:
    """Surface of a rigid tool in its own frame; see tool_surface.hpp."""

    @staticmethod
    def triangles(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], triangles: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, depth: float = float('inf'), smooth: bool = False) -> ToolSurface:
        """
        Surface of triangles (n, 3) over points (n_points, 3) [mm], counter-clockwise as seen from free space. smooth: rounded off, with normals that do not jump; see smooth_triangulation.hpp. Penetrations deeper than depth [mm] are not found. Raises ValueError where a triangle has no area, an edge has more than two triangles, or neighbours are wound against each other.
        """

    @staticmethod
    def swept(half_widths: Sequence[float], corner_radius: float, segments: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, depth: float = float('inf')) -> ToolSurface:
        """
        A profile carried round a rectangle of half widths along x and y (one may be infinite) with rounded corners [mm]. segments (n, 7) as in model.Tool, in (s, z): s the signed distance from the plan curve, positive outside. Penetrations deeper than depth [mm] are not found. Raises ValueError.
        """

    def nearest(self, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], reach: float = float('inf'), hints: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)] | None = None) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.int32]]:
        """
        Nearest places to points (n, 3) that are closer than reach [mm]: gap (n,), positive off the tool and infinite where there is none, normal (n, 3) out of the tool, place (n, 3), and hints (n,) for the next call.
        """

    def distance_bound(self, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], reach: float = float('inf')) -> NDArray[numpy.float64]:
        """
        The gap, or where nothing is closer than reach how far each point is from the surface at least (n,) [mm].
        """

    def is_sharp(self, edge: float) -> bool:
        """
        Whether edges of a sheet of this mean length [mm] touch the tool between their nodes: it turns by more than 29 degrees within half of it.
        """

    def slopes(self, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], reach: float = float('inf')) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Derivatives of the gap (n, 3) and of the normal (n, 3, 3: component, direction) [1/mm] to points (n, 3); zero where nothing is near, and of the normal on triangles that are not smooth.
        """

    @property
    def depth(self) -> float:
        """Penetrations deeper than this [mm] are not found."""

class SheetUnder:
    """Which shell of a sheet lies beneath a place in the plan x, y."""

    def __init__(self, blocks: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]]) -> None:
        """blocks: corners of the cells of each, (n, 3) or (n, 4)."""

    def find(self, places: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.int32], NDArray[numpy.uint8], NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Find what lies beneath places (n, 2) of a sheet with nodes (n_points, 3); cells (n): found last, or -1.
        Returns the cells, whether they lie beneath, and where they do: nodes (n, 4), their weights (n, 4; a
        triangle's fourth is zero) and the sheet's normal (n, 3), of any length.
        """

def find_sheet_waves(centre: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], bending: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], along: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], own: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], step: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], size: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], thickness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, n_places: int, least_height: float) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Find waves of a sheet on lines through cells `own` (n) along its most compressed directions: the bending strain
    (n) that a line has to one side between two places with as much to the other, and that of the cell itself (n).
    centre (n_cells, 3), bending (n_cells, 6; xx, yy, zz, xy, yz, xz), along (n_cells, 3; zero where it is not
    compressed): of all cells; step (n): from place to place of a line, n_places to either side; size (n): distance
    from a place to the nearest centre beyond which no cell lies there; thickness (n) [mm]. least_height: of a wave
    over the thickness, below which it is none.
    """

class ScalarAssembler:
    """Sparsity pattern and scatter of element arrays, one freedom a node."""

    def __init__(self, n_nodes: int, connectivity: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]], symmetric: bool, couplings: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)] | None = None) -> None: ...

    @property
    def indptr(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    @property
    def indices(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    def assemble_matrix(self, stiffness: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """
        Fill data from element stiffnesses; marked nodes take their freedoms in their own frame.
        """

    def add_blocks(self, pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], blocks: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Add blocks (n, D, D) at node pairs (n, 2)."""

    def assemble_vector(self, element_force: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]) -> NDArray[numpy.float64]:
        """Nodal force (n_nodes, D) of packed element forces."""

    def constrain(self, mask: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], value: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], scale: float, data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], rhs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Prescribe the masked freedoms in the matrix and the right-hand side."""

class Assembler:
    """Sparsity pattern and scatter of element arrays, two freedoms a node."""

    def __init__(self, n_nodes: int, connectivity: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]], symmetric: bool, couplings: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)] | None = None) -> None: ...

    @property
    def indptr(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    @property
    def indices(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    def assemble_matrix(self, stiffness: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """
        Fill data from element stiffnesses; marked nodes take their freedoms in their own frame.
        """

    def add_blocks(self, pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], blocks: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Add blocks (n, D, D) at node pairs (n, 2)."""

    def assemble_vector(self, element_force: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]) -> NDArray[numpy.float64]:
        """Nodal force (n_nodes, D) of packed element forces."""

    def constrain(self, mask: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], value: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], scale: float, data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], rhs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Prescribe the masked freedoms in the matrix and the right-hand side."""

class SpaceAssembler:
    """The same with three freedoms a node."""

    def __init__(self, n_nodes: int, connectivity: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]], symmetric: bool, couplings: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)] | None = None) -> None: ...

    @property
    def indptr(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    @property
    def indices(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    def assemble_matrix(self, stiffness: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """
        Fill data from element stiffnesses; marked nodes take their freedoms in their own frame.
        """

    def add_blocks(self, pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], blocks: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Add blocks (n, D, D) at node pairs (n, 2)."""

    def assemble_vector(self, element_force: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]) -> NDArray[numpy.float64]:
        """Nodal force (n_nodes, D) of packed element forces."""

    def constrain(self, mask: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], value: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], scale: float, data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], rhs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Prescribe the masked freedoms in the matrix and the right-hand side."""

class MixedAssembler:
    """The same with four freedoms a node, displacement and pressure."""

    def __init__(self, n_nodes: int, connectivity: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]], symmetric: bool, couplings: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)] | None = None) -> None: ...

    @property
    def indptr(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    @property
    def indices(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    def assemble_matrix(self, stiffness: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """
        Fill data from element stiffnesses; marked nodes take their freedoms in their own frame.
        """

    def add_blocks(self, pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], blocks: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Add blocks (n, D, D) at node pairs (n, 2)."""

    def assemble_vector(self, element_force: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]) -> NDArray[numpy.float64]:
        """Nodal force (n_nodes, D) of packed element forces."""

    def constrain(self, mask: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], value: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], scale: float, data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], rhs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Prescribe the masked freedoms in the matrix and the right-hand side."""

class ShellAssembler:
    """The same with six freedoms a node, rotations in the nodes' frames."""

    def __init__(self, n_nodes: int, connectivity: Sequence[Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]], symmetric: bool, couplings: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)] | None = None) -> None: ...

    @property
    def indptr(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    @property
    def indices(self) -> Annotated[NDArray[numpy.int32], dict(writable=False)]: ...

    def assemble_matrix(self, stiffness: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """
        Fill data from element stiffnesses; marked nodes take their freedoms in their own frame.
        """

    def add_blocks(self, pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], blocks: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], turned: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], frames: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Add blocks (n, D, D) at node pairs (n, 2)."""

    def assemble_vector(self, element_force: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]) -> NDArray[numpy.float64]:
        """Nodal force (n_nodes, D) of packed element forces."""

    def constrain(self, mask: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], value: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], scale: float, data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], rhs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')]) -> None:
        """Prescribe the masked freedoms in the matrix and the right-hand side."""

def solve_iteratively(indptr: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], indices: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], data: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rhs: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, symmetric: bool, tolerance: float, most_iterations: int) -> NDArray[numpy.float64] | None:
    """
    Solution (n,) of a sparse system by conjugate gradients to a residual of tolerance times that of rhs; None if it is far.

    symmetric: only one triangle is stored.
    """

def dissect(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], indptr: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], indices: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.int32]:
    """
    Nodes of a mesh in the plane in an order of elimination (n,) that keeps factors sparse: nested dissection by coordinates.

    points (n, 2); indptr, indices: the pattern of a matrix, as many rows at every node.
    """

class Energies:
    """Energies of an explicit run [N mm]."""

    def __init__(self, kinetic: float, internal: float, hourglass: float, external: float, damping: float, contact: float, friction: float) -> None: ...

    @property
    def kinetic(self) -> float: ...

    @property
    def internal(self) -> float: ...

    @property
    def hourglass(self) -> float: ...

    @property
    def external(self) -> float: ...

    @property
    def damping(self) -> float: ...

    @property
    def contact(self) -> float: ...

    @property
    def friction(self) -> float: ...

def is_tabulated(law: SheetLaw) -> bool:
    """
    Whether explicit shells take their stress from TabulatedMises: von Mises, isotropic hardening alone.
    """

class TabulatedMises:
    """
    The explicit loop's von Mises update in plane stress; hardening from a table.
    """

    def __init__(self, law: SheetLaw) -> None: ...

    @property
    def table_error(self) -> float:
        """Largest error of the table, of the flow stress."""

    @property
    def table_rows(self) -> int:
        """Number of the table's intervals."""

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, single: bool = False) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Advance points by strain increments (n, 3); returns stress (n, 3), equivalent plastic strain (n), thickness strain increment (n).
        """

class ShellTreatment(enum.Enum):
    """
    What a shell of four nodes is made of: one point in the plane, or 2 x 2.
    """

    plain = 0
    """Belytschko, Lin & Tsay 1984"""

    warped = 1
    """with the terms of Belytschko, Wong & Chiang 1992"""

    stabilized = 2
    """with hourglass stresses of the material's own"""

    mitc = 3
    """2 x 2 points, MITC4+"""

class SpaceLoop:
    """Central differences for shells and solids in space; mm, s, t, N, MPa."""

    def __init__(self, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None: ...

    def advance(self, time: float, dt: float, dt_before: float, force_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, damping: float = 0.0) -> tuple[int, LawStatus, int]:
        """
        Advance as many cycles of dt [s] from `time` on as the scales have values, the step before dt_before, or up to that in which an element fails; returns the element, what its law told (done, if it is turned inside out) and the cycle, or -1, done, -1.
        """

    def energies(self, dt: float, dt_before: float, *, damping: float = 0.0, force_scale: float = 1.0, velocity_scale: float = 1.0) -> Energies:
        """Energies at the present time; dt: the next step [s]."""

    @property
    def seconds(self) -> tuple[float, float, float, float]:
        """
        Wall time [s] that advance has taken for nodes, elements, contact, and waiting between threads.
        """

    def bound_frequencies(self) -> NDArray[numpy.float64]:
        """Bound of the squared highest frequency of each element (n) [1/s2]."""

    @property
    def element_mass(self) -> NDArray[numpy.float64]:
        """Mass of each element (n) [t]."""

    @property
    def true_mass(self) -> NDArray[numpy.float64]:
        """Mass of each element without what scaling has added (n) [t]."""

    @property
    def added_mass(self) -> NDArray[numpy.float64]:
        """What scaling has added to the mass of each element (n) [t]."""

    def scale_mass(self, factor: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Multiply the masses of the elements by factors (n)."""

    def set_temperature(self, block: int, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Give the points of a block's elements temperatures (n, points) [degrees C] from now on; of shells (n, points in the plane, layers).
        """

    def add_damage(self, block: int, name: str, law: Damage, *, temperature: float = 20.0, rise: int = -1) -> None:
        """
        Let damage by a criterion grow at the points of a block. temperature: where none is given [degrees C]; rise: row of the rise of temperature behind the first of the stress, -1 if there is none.
        """

    def damage(self, block: int, name: str) -> NDArray[numpy.float64]:
        """Damage by a criterion at the points of a block (n, points)."""

    def set_slower(self, factor: float) -> None:
        """
        Let the laws of shells take their rates by a time that is so many times that of the cycles from now on.
        """

    def prescribe(self, fixed: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Prescribe velocities of the freedoms marked in fixed (n_nodes, freedoms).
        """

    def state(self) -> dict[str, dict[str, NDArray[numpy.float64]]]:
        """All that the next cycle depends on: arrays by owner and name."""

    @property
    def is_finite(self) -> bool:
        """Whether the positions of all nodes are finite numbers."""

    @property
    def position(self) -> NDArray[numpy.float64]:
        """Positions (n_nodes, dimension) [mm]."""

    @position.setter
    def position(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def velocity(self) -> NDArray[numpy.float64]:
        """Velocities (n_nodes, freedoms), half a step back [mm/s, 1/s]."""

    @velocity.setter
    def velocity(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def force(self) -> NDArray[numpy.float64]:
        """Nodal forces and moments from outside (n_nodes, freedoms) [N, N mm]."""

    @force.setter
    def force(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def internal_force(self) -> NDArray[numpy.float64]:
        """
        Internal forces and moments (n_nodes, freedoms) [N, N mm], less those of tools.
        """

    @internal_force.setter
    def internal_force(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def reaction_impulse(self) -> NDArray[numpy.float64]:
        """
        Impulse of what holds prescribed freedoms (n_nodes, freedoms), until set to zero [N s, N mm s].
        """

    @reaction_impulse.setter
    def reaction_impulse(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    def stress(self, block: int) -> NDArray[numpy.float64]:
        """
        Stress xx, yy, xy (n, points in the plane, layers, 3) of a block in the law's frame [MPa]; of squeezed shells with the pressure added to xx and yy.
        """

    def history(self, block: int) -> NDArray[numpy.float64]:
        """
        What the law of a block keeps (n, points in the plane, layers, size); first eqps.
        """

    def set_layers(self, block: int, layers: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Set the layers (n, points in the plane, layers, 3 + size) of a block: sum and difference of the normal stresses, shear, what the law keeps.
        """

    def pressure(self, block: int) -> NDArray[numpy.float64]:
        """
        Pressure through the thickness (n, points in the plane) of a block that tools squeeze [MPa].
        """

    def thickness(self, block: int) -> NDArray[numpy.float64]:
        """Thickness (n) [mm] of a block."""

    def trial_force(self, increment: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
        """
        Internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed.
        """

    def add_tool(self, surface: ToolSurface, *, friction: float, penalty: float, damping: float, edges: bool, thickness: bool) -> int:
        """Add a rigid tool; returns its number."""

    def remove_tool(self, tool: int) -> None:
        """Take a tool away; the others keep their numbers."""

    def place_tool(self, tool: int, displacement: Sequence[float]) -> None:
        """Put a tool somewhere else."""

    def push_tool(self, tool: int, direction: Sequence[float], mass: float, drag: float) -> None:
        """
        Let a force place a tool of this mass [t] along a unit vector; drag [1/s].
        """

    def stop_tool(self, tool: int, other: int, furthest: float) -> None:
        """
        Let a pushed tool stand on another that moves, once its displacement along its direction is so much [mm] beyond the other's.
        """

    def move_tool(self, tool: int) -> None:
        """Let velocities move a tool again that a force has placed."""

    def drive_tool(self, tool: int, drive: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Velocities (n, 3), or forces (n) of a pushed tool, of the next n cycles.
        """

    def tool_state(self, tool: int) -> tuple[list[float], list[float], list[float]]:
        """
        Displacement [mm], velocity half a step back [mm/s], force of the sheet on the tool [N].
        """

    def set_contact_stiffness(self, dt: float) -> None:
        """Take the stiffness of contact from the masses and a step [s]."""

    def start_contact(self) -> None:
        """Find the forces of tools that are new."""

    def force_of_tool(self, tool: int) -> NDArray[numpy.float64]:
        """Forces of one tool on the nodes (n_nodes, 3) [N]."""

    def deepest(self, tool: int) -> tuple[float, int]:
        """
        Depth of the deepest point in a tool [mm], and which it is: a node, or the number of nodes + an edge.
        """

    def edge_nodes(self, edge: int) -> tuple[int, int]:
        """Nodes of an edge."""

    @property
    def lost_point(self) -> int:
        """A point that has gone through a tool; -1: none."""

    @property
    def contact_force(self) -> NDArray[numpy.float64]:
        """Forces of the tools on the nodes (n_nodes, 3) [N]."""

    def add_bead(self, place: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], across: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], length: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, force: float, tool: int = -1) -> int:
        """
        Add a drawbead of points: places and unit normals in the plan (n, 2), lengths (n) [mm], force per length
        [N/mm], the tool that it moves with; returns its number.
        """

    def drive_bead(self, bead: int, share: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Shares (n) of its force in the next n cycles."""

    def bead_restraint(self, bead: int) -> float:
        """Restraining force, summed along the line [N]; of a part its share."""

    def share_beads(self, whole: SpaceLoop, place: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], cell: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Let this part hold what is its own of beads on a whole sheet. place (n_nodes there): numbers in the part, or -1; cell: numbers there of the part's elements.
        """

    def place_beads(self) -> None:
        """
        Look near which shell each point of a bead is, where that is not known yet.
        """

    def add_shell_contact(self, undeformed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, friction: float, penalty: float, damping: float) -> None:
        """
        Let shells touch shells; undeformed (n_nodes, 3): by which those near along the sheet are left out [mm].
        """

    def share_shell_contact(self, whole: SpaceLoop, undeformed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], place: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], cell: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, friction: float, penalty: float, damping: float) -> None:
        """
        Let the shells of this part touch those of a whole sheet. place (n_nodes there): numbers in the part, or -1; cell: numbers there of the part's elements.
        """

    def shell_contact_force(self) -> NDArray[numpy.float64]:
        """Forces of shells that touch shells on the nodes (n_nodes, 3) [N]."""

    def deepest_in_shell(self) -> tuple[float, int, int]:
        """
        Overlap of the node that is deepest in a shell [mm], it, and the shell; 0, -1, -1 where none is.
        """

    def add_pressure(self, cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, side: float, stiffness: float = 0.0, room: float = 0.0) -> int:
        """
        Let a pressure act on shells (n, 4), a triangle with its last node twice; returns its number. side: 1 along their normals, -1 against. stiffness [MPa], room [mm3]: of a fluid in a closed space; 0: there is none.
        """

    def drive_pressure(self, pressure: int, course: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Pressures (n) [MPa] at the end of the next n cycles; of a fluid its volume without pressure [mm3].
        """

    def pressure_state(self, pressure: int) -> list[float]:
        """Pressure [MPa], and volume that the sheet has swept under it [mm3]."""

    def join(self, messages: object, sent: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], ghosts: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, out: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], into: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], shared: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], leads: bool) -> None:
        """
        Let the loop be one of those on the parts of a mesh, before it has tools. sent: own nodes whose motion goes out, ghosts: nodes of others whose motion comes in, those of each neighbour together. messages: has send, propose, receive and agree, called once a cycle each, and find_largest; out (sent, k), into (ghosts, k): what is sent and has come, k = 8 where there is a sheet, 3 of solids in space, 2 in the plane; shared (1 + 3 for each tool of a sheet + 4 for each of solids in space, 2 in the plane): the first becomes the largest, the others the sums of all parts'.
        """

    @property
    def nodal_masses(self) -> NDArray[numpy.float64]:
        """
        Masses of the nodes, in space with rotary inertias (n_nodes, 1 | 2) [t, t mm2].
        """

    def set_ghost_masses(self, masses: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Let ghosts have masses as nodal_masses gives them, of the whole mesh."""

    def set_tool_forces(self, force: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Set this part's share of the sheet's forces on tools (tools, 3) [N]."""

    @property
    def edges(self) -> NDArray[numpy.int32]:
        """Nodes of the edges that tools touch (n, 2)."""

    @property
    def sheet_sizes(self) -> list[float]:
        """
        Least thickness, widest shell and mean edge [mm], by which contact looks for what is near; those of the whole sheet are to be given to its parts, before there are tools.
        """

    @sheet_sizes.setter
    def sheet_sizes(self, arg: Sequence[float], /) -> None: ...

    def add_shells(self, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], thickness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], axis: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], law: SheetLaw | Umat, density: float, height: Sequence[float], weight: Sequence[float], *, tabulate: bool = True, treatment: ShellTreatment = ShellTreatment.plain, viscous: bool = False, hourglass: Sequence[float] = [0.03, 0.03, 0.03], elastic: Sequence[float] = [0.0, 0.0], yield_stress: float = 0.0, number: Sequence[int] = [], relief: Sequence[float] = []) -> None:
        """
        Add a block of shells of 3 or 4 nodes; blocks and their elements are numbered as they come. elastic: Young's modulus and Poisson's ratio of a law from a shared library, which is told of the shells by number (n), from 0. yield_stress: half of it is the pressure [MPa] at which a pushed tool begins to squeeze. relief (n): how much nearer tools are to each other at a shell than they are drawn [mm].
        """

    def set_hanging(self, hanging: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Let nodes follow the ends of sides (n, 7): the node, both ends, two far nodes of the shell that has the whole side and two of those that have half of it.
        """

    def inherit(self, other: SpaceLoop, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], node_parents: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], parent: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], share: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], dt: float) -> None:
        """
        Begin at positions (n_nodes, 3) with the state of another loop some shells of which are split here: share (n) of the parent (n) of each element, parents (n_nodes, 4) of each node; dt [s]: for beads.
        """

    def take_shape(self, other: SpaceLoop) -> None:
        """
        Lie at rest and without stress where a loop of the same shells is, with its masses: what is left is elastic.
        """

    def restore(self, state: Mapping[str, Mapping[str, Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]]) -> None:
        """Take over what state gave."""

    @property
    def inverse_mass(self) -> NDArray[numpy.float64]:
        """
        Inverse of mass [t] and of rotary inertia [t mm2] (n_nodes, 2); 0 where there is none.
        """

    @property
    def ironing(self) -> bool:
        """
        Whether tools squeeze the sheet thinner; to be set before there are any.
        """

    @ironing.setter
    def ironing(self, arg: bool, /) -> None: ...

    def add_wall(self, surface: ToolSurface, touching: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], *, position: Sequence[float], rotation: Sequence[Sequence[float]], centre: Sequence[float], axis: Sequence[float], turns: bool, mu: float, reach: float) -> None:
        """
        Let a rigid tool hold the nodes marked (n_nodes) off its surface; position: of the tool's frame [mm], rotation: from it to space (3, 3); centre [mm] and axis, in space: about which it turns; turns: whether it is turned now or later; reach: how far off it is looked for [mm].
        """

    def limit_wall_friction(self, wall: int, limit: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Largest friction on each node (n_nodes) [N] from now on."""

    def move_wall(self, wall: int, velocity: Sequence[float], spin: float = 0.0) -> None:
        """Let a wall move [mm/s] and turn [1/s] from now on."""

    def place_wall(self, wall: int, offset: Sequence[float]) -> None:
        """Put a wall elsewhere, by a displacement since the start [mm]."""

    def float_wall(self, wall: int, direction: Sequence[float], *, mass: float, drag: float, stiffness: float, rests: bool) -> None:
        """
        Let forces move a wall of a mass [t] along a direction, besides. drag [1/s]; stiffness: of a spring [N/mm]; rests: whether it goes no further back than to where it starts.
        """

    def push_wall(self, wall: int, force: float) -> None:
        """Push a wall that floats along its direction from now on [N]."""

    def hold_wall(self, wall: int) -> None:
        """Let no force move a wall any more."""

    def hold_along(self, node: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], along: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Prescribe velocities (k) [mm/s] of nodes (k), rising, along unit vectors (k, 3) besides those of prescribe, to which they are normal, and to each other.
        """

    def tie(self, pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], angle: float) -> None:
        """
        Let the second node of each pair (n, 2) follow the first, turned about z by an angle [rad].
        """

    def begin_wall_sums(self, wall: int) -> None:
        """Sum up anew what a wall presses and rubs."""

    def set_wall_sums(self, wall: int, pressed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rubbed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Set those sums, as wall_pressed and wall_rubbed give them."""

    def wall_force(self, wall: int) -> NDArray[numpy.float64]:
        """Forces of a wall on the nodes (n_nodes, 3) in the last cycle."""

    def wall_offset(self, wall: int) -> list[float]:
        """Displacement of a wall since the start [mm]."""

    def wall_angle(self, wall: int) -> float:
        """By how much a wall has turned since the start [rad]."""

    def wall_travel(self, wall: int) -> float:
        """How far forces and springs have moved a wall since the start [mm]."""

    def wall_radius(self, wall: int) -> float:
        """
        How far the farthest node is from the centre of a wall that turns [mm]; negative: it does not turn.
        """

    def set_wall_radius(self, wall: int, radius: float) -> None:
        """Say how far nodes of other parts of the mesh are from that centre."""

    def wall_impulse(self, wall: int) -> list[float]:
        """
        Impulse that a wall has given to the nodes since the start [N s], and that of its moment about the wall's axis [N mm s].
        """

    def wall_pressed(self, wall: int) -> NDArray[numpy.float64]:
        """
        Impulse of a wall's pressure on the nodes since begin_wall_sums (n_nodes) [N s].
        """

    def wall_rubbed(self, wall: int) -> NDArray[numpy.float64]:
        """
        Work that friction on a wall has taken at the nodes since then (n_nodes) [N mm].
        """

    def add_contact(self, slave: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], slave_cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master_cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, by_itself: bool, edge: float, thickness: float, mu: float, reach: float, margin: float) -> None:
        """
        Let faces (n, k) of bodies touch; cells (n, nodes): behind each. by_itself: slave and master are the same; edge: mean length [mm]; thickness [mm], 0 of rings; mu: most of friction over pressure; reach and margin: parts of the edge.
        """

    def set_contact_step(self, contact: int, dt: float) -> None:
        """Let the springs of a contact be stable with a step [s]."""

    def limit_contact_friction(self, contact: int, limit: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Largest shear of each slot (n_slots) [MPa] from now on."""

    def contact_passed(self, contact: int) -> bool:
        """Whether the bodies have gone through each other."""

    def contact_pressure(self, contact: int) -> NDArray[numpy.float64]:
        """Pressure of the slots (n_slots) [MPa]."""

    def find_contact_stiffness(self, contact: int) -> NDArray[numpy.float64]:
        """
        Stiffness of the slots' springs as the next cycle has it (n_slots) [MPa/mm].
        """

    def contact_shear(self, contact: int) -> NDArray[numpy.float64]:
        """Shear of the slots, on the slave (n_slots, 3) [MPa]."""

    def contact_push(self, contact: int) -> NDArray[numpy.float64]:
        """
        Forces of the pressure on the nodes of the contact (n, 3) in the last cycle [N].
        """

    def contact_rub(self, contact: int) -> NDArray[numpy.float64]:
        """Forces of friction on them (n, 3) [N]."""

    def contact_area(self, contact: int) -> NDArray[numpy.float64]:
        """Share of them in the surfaces that face each other (n) [mm2]."""

    def contact_work(self, contact: int) -> tuple[float, float]:
        """
        Work that pressure and friction of a contact have taken since the start [N mm].
        """

    def contact_impulse(self, contact: int) -> NDArray[numpy.float64]:
        """
        Impulse that the slave has given to the master since the start (3) [N s].
        """

    def contact_nodes(self, contact: int) -> NDArray[numpy.int32]:
        """Nodes of a contact (n), as the loop has them."""

    def contact_slots(self, contact: int) -> NDArray[numpy.int32]:
        """Nodes of the slots of a contact (n_slots), as the loop has them."""

    def point_measures(self, block: int) -> NDArray[numpy.float64]:
        """
        Stress (6), equivalent plastic strain and, of a law that heats, its rise of temperature at the points of a block of solids (n, points, 7 or 8).
        """

    def add_solids(self, element: str, cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], law: VonMises | SolidLaw | Umat, density: float, hourglass_fraction: float, around: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, kept: Sequence[float], elastic: Sequence[float] = [0.0, 0.0], number: Sequence[int] = []) -> None:
        """
        Add cells (n, nodes) of hex8, hex8_fbar, hex8_1pt or tet4_nodal; they are numbered as they come. hourglass_fraction: of the shear modulus, of hex8_1pt and tet4_nodal. around (n, 4): cells whose volumes nodes of tet4_nodal have, these and others; empty: these. kept: what the law keeps at every point behind the equivalent plastic strain, before the first cycle. elastic: Young's modulus and Poisson's ratio of a law from a shared library, which is told of the cells by number (n), from 0.
        """

class SpaceLoopSingle:
    """
    SpaceLoop in single precision, positions and work excepted; it has shells alone.
    """

    def __init__(self, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None: ...

    def advance(self, time: float, dt: float, dt_before: float, force_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, damping: float = 0.0) -> tuple[int, LawStatus, int]:
        """
        Advance as many cycles of dt [s] from `time` on as the scales have values, the step before dt_before, or up to that in which an element fails; returns the element, what its law told (done, if it is turned inside out) and the cycle, or -1, done, -1.
        """

    def energies(self, dt: float, dt_before: float, *, damping: float = 0.0, force_scale: float = 1.0, velocity_scale: float = 1.0) -> Energies:
        """Energies at the present time; dt: the next step [s]."""

    @property
    def seconds(self) -> tuple[float, float, float, float]:
        """
        Wall time [s] that advance has taken for nodes, elements, contact, and waiting between threads.
        """

    def bound_frequencies(self) -> NDArray[numpy.float64]:
        """Bound of the squared highest frequency of each element (n) [1/s2]."""

    @property
    def element_mass(self) -> NDArray[numpy.float64]:
        """Mass of each element (n) [t]."""

    @property
    def true_mass(self) -> NDArray[numpy.float64]:
        """Mass of each element without what scaling has added (n) [t]."""

    @property
    def added_mass(self) -> NDArray[numpy.float64]:
        """What scaling has added to the mass of each element (n) [t]."""

    def scale_mass(self, factor: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Multiply the masses of the elements by factors (n)."""

    def set_temperature(self, block: int, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Give the points of a block's elements temperatures (n, points) [degrees C] from now on; of shells (n, points in the plane, layers).
        """

    def add_damage(self, block: int, name: str, law: Damage, *, temperature: float = 20.0, rise: int = -1) -> None:
        """
        Let damage by a criterion grow at the points of a block. temperature: where none is given [degrees C]; rise: row of the rise of temperature behind the first of the stress, -1 if there is none.
        """

    def damage(self, block: int, name: str) -> NDArray[numpy.float64]:
        """Damage by a criterion at the points of a block (n, points)."""

    def set_slower(self, factor: float) -> None:
        """
        Let the laws of shells take their rates by a time that is so many times that of the cycles from now on.
        """

    def prescribe(self, fixed: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Prescribe velocities of the freedoms marked in fixed (n_nodes, freedoms).
        """

    def state(self) -> dict[str, dict[str, NDArray[numpy.float64]]]:
        """All that the next cycle depends on: arrays by owner and name."""

    @property
    def is_finite(self) -> bool:
        """Whether the positions of all nodes are finite numbers."""

    @property
    def position(self) -> NDArray[numpy.float64]:
        """Positions (n_nodes, dimension) [mm]."""

    @position.setter
    def position(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def velocity(self) -> NDArray[numpy.float64]:
        """Velocities (n_nodes, freedoms), half a step back [mm/s, 1/s]."""

    @velocity.setter
    def velocity(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def force(self) -> NDArray[numpy.float64]:
        """Nodal forces and moments from outside (n_nodes, freedoms) [N, N mm]."""

    @force.setter
    def force(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def internal_force(self) -> NDArray[numpy.float64]:
        """
        Internal forces and moments (n_nodes, freedoms) [N, N mm], less those of tools.
        """

    @internal_force.setter
    def internal_force(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def reaction_impulse(self) -> NDArray[numpy.float64]:
        """
        Impulse of what holds prescribed freedoms (n_nodes, freedoms), until set to zero [N s, N mm s].
        """

    @reaction_impulse.setter
    def reaction_impulse(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    def stress(self, block: int) -> NDArray[numpy.float64]:
        """
        Stress xx, yy, xy (n, points in the plane, layers, 3) of a block in the law's frame [MPa]; of squeezed shells with the pressure added to xx and yy.
        """

    def history(self, block: int) -> NDArray[numpy.float64]:
        """
        What the law of a block keeps (n, points in the plane, layers, size); first eqps.
        """

    def set_layers(self, block: int, layers: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Set the layers (n, points in the plane, layers, 3 + size) of a block: sum and difference of the normal stresses, shear, what the law keeps.
        """

    def pressure(self, block: int) -> NDArray[numpy.float64]:
        """
        Pressure through the thickness (n, points in the plane) of a block that tools squeeze [MPa].
        """

    def thickness(self, block: int) -> NDArray[numpy.float64]:
        """Thickness (n) [mm] of a block."""

    def trial_force(self, increment: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
        """
        Internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed.
        """

    def add_tool(self, surface: ToolSurface, *, friction: float, penalty: float, damping: float, edges: bool, thickness: bool) -> int:
        """Add a rigid tool; returns its number."""

    def remove_tool(self, tool: int) -> None:
        """Take a tool away; the others keep their numbers."""

    def place_tool(self, tool: int, displacement: Sequence[float]) -> None:
        """Put a tool somewhere else."""

    def push_tool(self, tool: int, direction: Sequence[float], mass: float, drag: float) -> None:
        """
        Let a force place a tool of this mass [t] along a unit vector; drag [1/s].
        """

    def stop_tool(self, tool: int, other: int, furthest: float) -> None:
        """
        Let a pushed tool stand on another that moves, once its displacement along its direction is so much [mm] beyond the other's.
        """

    def move_tool(self, tool: int) -> None:
        """Let velocities move a tool again that a force has placed."""

    def drive_tool(self, tool: int, drive: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Velocities (n, 3), or forces (n) of a pushed tool, of the next n cycles.
        """

    def tool_state(self, tool: int) -> tuple[list[float], list[float], list[float]]:
        """
        Displacement [mm], velocity half a step back [mm/s], force of the sheet on the tool [N].
        """

    def set_contact_stiffness(self, dt: float) -> None:
        """Take the stiffness of contact from the masses and a step [s]."""

    def start_contact(self) -> None:
        """Find the forces of tools that are new."""

    def force_of_tool(self, tool: int) -> NDArray[numpy.float64]:
        """Forces of one tool on the nodes (n_nodes, 3) [N]."""

    def deepest(self, tool: int) -> tuple[float, int]:
        """
        Depth of the deepest point in a tool [mm], and which it is: a node, or the number of nodes + an edge.
        """

    def edge_nodes(self, edge: int) -> tuple[int, int]:
        """Nodes of an edge."""

    @property
    def lost_point(self) -> int:
        """A point that has gone through a tool; -1: none."""

    @property
    def contact_force(self) -> NDArray[numpy.float64]:
        """Forces of the tools on the nodes (n_nodes, 3) [N]."""

    def add_bead(self, place: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], across: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], length: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, force: float, tool: int = -1) -> int:
        """
        Add a drawbead of points: places and unit normals in the plan (n, 2), lengths (n) [mm], force per length
        [N/mm], the tool that it moves with; returns its number.
        """

    def drive_bead(self, bead: int, share: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Shares (n) of its force in the next n cycles."""

    def bead_restraint(self, bead: int) -> float:
        """Restraining force, summed along the line [N]; of a part its share."""

    def share_beads(self, whole: SpaceLoopSingle, place: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], cell: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Let this part hold what is its own of beads on a whole sheet. place (n_nodes there): numbers in the part, or -1; cell: numbers there of the part's elements.
        """

    def place_beads(self) -> None:
        """
        Look near which shell each point of a bead is, where that is not known yet.
        """

    def add_shell_contact(self, undeformed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, friction: float, penalty: float, damping: float) -> None:
        """
        Let shells touch shells; undeformed (n_nodes, 3): by which those near along the sheet are left out [mm].
        """

    def share_shell_contact(self, whole: SpaceLoopSingle, undeformed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], place: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], cell: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, friction: float, penalty: float, damping: float) -> None:
        """
        Let the shells of this part touch those of a whole sheet. place (n_nodes there): numbers in the part, or -1; cell: numbers there of the part's elements.
        """

    def shell_contact_force(self) -> NDArray[numpy.float64]:
        """Forces of shells that touch shells on the nodes (n_nodes, 3) [N]."""

    def deepest_in_shell(self) -> tuple[float, int, int]:
        """
        Overlap of the node that is deepest in a shell [mm], it, and the shell; 0, -1, -1 where none is.
        """

    def add_pressure(self, cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, side: float, stiffness: float = 0.0, room: float = 0.0) -> int:
        """
        Let a pressure act on shells (n, 4), a triangle with its last node twice; returns its number. side: 1 along their normals, -1 against. stiffness [MPa], room [mm3]: of a fluid in a closed space; 0: there is none.
        """

    def drive_pressure(self, pressure: int, course: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Pressures (n) [MPa] at the end of the next n cycles; of a fluid its volume without pressure [mm3].
        """

    def pressure_state(self, pressure: int) -> list[float]:
        """Pressure [MPa], and volume that the sheet has swept under it [mm3]."""

    def join(self, messages: object, sent: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], ghosts: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, out: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], into: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], shared: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], leads: bool) -> None:
        """
        Let the loop be one of those on the parts of a mesh, before it has tools. sent: own nodes whose motion goes out, ghosts: nodes of others whose motion comes in, those of each neighbour together. messages: has send, propose, receive and agree, called once a cycle each, and find_largest; out (sent, k), into (ghosts, k): what is sent and has come, k = 8 where there is a sheet, 3 of solids in space, 2 in the plane; shared (1 + 3 for each tool of a sheet + 4 for each of solids in space, 2 in the plane): the first becomes the largest, the others the sums of all parts'.
        """

    @property
    def nodal_masses(self) -> NDArray[numpy.float64]:
        """
        Masses of the nodes, in space with rotary inertias (n_nodes, 1 | 2) [t, t mm2].
        """

    def set_ghost_masses(self, masses: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Let ghosts have masses as nodal_masses gives them, of the whole mesh."""

    def set_tool_forces(self, force: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Set this part's share of the sheet's forces on tools (tools, 3) [N]."""

    @property
    def edges(self) -> NDArray[numpy.int32]:
        """Nodes of the edges that tools touch (n, 2)."""

    @property
    def sheet_sizes(self) -> list[float]:
        """
        Least thickness, widest shell and mean edge [mm], by which contact looks for what is near; those of the whole sheet are to be given to its parts, before there are tools.
        """

    @sheet_sizes.setter
    def sheet_sizes(self, arg: Sequence[float], /) -> None: ...

    def add_shells(self, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], thickness: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], axis: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], law: SheetLaw | Umat, density: float, height: Sequence[float], weight: Sequence[float], *, tabulate: bool = True, treatment: ShellTreatment = ShellTreatment.plain, viscous: bool = False, hourglass: Sequence[float] = [0.03, 0.03, 0.03], elastic: Sequence[float] = [0.0, 0.0], yield_stress: float = 0.0, number: Sequence[int] = [], relief: Sequence[float] = []) -> None:
        """
        Add a block of shells of 3 or 4 nodes; blocks and their elements are numbered as they come. elastic: Young's modulus and Poisson's ratio of a law from a shared library, which is told of the shells by number (n), from 0. yield_stress: half of it is the pressure [MPa] at which a pushed tool begins to squeeze. relief (n): how much nearer tools are to each other at a shell than they are drawn [mm].
        """

    def set_hanging(self, hanging: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Let nodes follow the ends of sides (n, 7): the node, both ends, two far nodes of the shell that has the whole side and two of those that have half of it.
        """

    def inherit(self, other: SpaceLoopSingle, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], node_parents: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], parent: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], share: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], dt: float) -> None:
        """
        Begin at positions (n_nodes, 3) with the state of another loop some shells of which are split here: share (n) of the parent (n) of each element, parents (n_nodes, 4) of each node; dt [s]: for beads.
        """

    def take_shape(self, other: SpaceLoopSingle) -> None:
        """
        Lie at rest and without stress where a loop of the same shells is, with its masses: what is left is elastic.
        """

    def restore(self, state: Mapping[str, Mapping[str, Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]]) -> None:
        """Take over what state gave."""

    @property
    def inverse_mass(self) -> NDArray[numpy.float64]:
        """
        Inverse of mass [t] and of rotary inertia [t mm2] (n_nodes, 2); 0 where there is none.
        """

    @property
    def ironing(self) -> bool:
        """
        Whether tools squeeze the sheet thinner; to be set before there are any.
        """

    @ironing.setter
    def ironing(self, arg: bool, /) -> None: ...

class DeformationLaw:
    """Deformation theory of a sheet in plane stress."""

    def __init__(self, young: float, strain_metric: Sequence[float], law: HardeningLaw, parameters: Sequence[float]) -> None:
        """strain_metric: rows of Q, e^2 = E' Q E over E = (xx, yy, 2 xy)."""

    def flow_curve(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """Stress [MPa] and its slope at total equivalent strains (n)."""

    def form(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], formed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
        """
        What layers with logarithmic strains (n, 3: xx, yy, 2 xy) have gone through, and had before (n, 4): the strain at which they are free of stress, and equivalent plastic strain.
        """

def evaluate_inverse(triangles: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], share: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], axes: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], edges: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], curvature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], bases: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], blank: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], formed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], thickness: float, law: DeformationLaw, height: Sequence[float], weight: Sequence[float], *, with_stiffness: bool) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], int]:
    """
    Forces (n, 3, 3) [N] of the triangles of a part whose nodes come from `blank`, after what their layers have gone through (`formed`, see DeformationLaw.form), their derivatives (n, 6, 6) along the nodes' bases, and the index of a triangle turned over in the blank, or -1.
    """

class AdiabaticMises:
    """
    Von Mises plasticity with strain rate, softening by temperature and adiabatic heating.
    """

    def __init__(self, mises: VonMises, *, rate: RateLaw = RateLaw.none, rate_parameters: Mapping[str, float] = {}, start: float = 0.0, reference: float = 0.0, melting: float = 0.0, exponent: float = 1.0, heating: float = 0.0) -> None: ...

    def update(self, strain: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], dt: float, stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rise: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Advance points by strain increments (n, 4) in dt; returns stress (n, 4), equivalent plastic strain (n) and rise of temperature (n).
        """

class PlaneLoop:
    """Central differences for solids in the plane; mm, s, t, N, MPa."""

    def __init__(self, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], contact: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], *, axisymmetric: bool, depth: float = 1.0, hourglass_fraction: float = 0.05) -> None: ...

    def add_solids(self, element: str, cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], law: AdiabaticMises | PlaneLaw | Umat, density: float, *, kept: Sequence[float], young: float = 0.0, poisson: float = 0.0) -> None:
        """
        Add cells (n, nodes) of tri3 or quad4_1pt; they are numbered as they come. kept: what the law keeps besides plastic strain and rise of temperature, before the first cycle. young, poisson: of a law from a shared library.
        """

    def restore(self, state: Mapping[str, Mapping[str, Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]]) -> None:
        """Take over what state gave."""

    @property
    def mass(self) -> NDArray[numpy.float64]:
        """Mass of each node (n_nodes) [t]."""

    def advance(self, time: float, dt: float, dt_before: float, force_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, damping: float = 0.0) -> tuple[int, LawStatus, int]:
        """
        Advance as many cycles of dt [s] from `time` on as the scales have values, the step before dt_before, or up to that in which an element fails; returns the element, what its law told (done, if it is turned inside out) and the cycle, or -1, done, -1.
        """

    def energies(self, dt: float, dt_before: float, *, damping: float = 0.0, force_scale: float = 1.0, velocity_scale: float = 1.0) -> Energies:
        """Energies at the present time; dt: the next step [s]."""

    @property
    def seconds(self) -> tuple[float, float, float, float]:
        """
        Wall time [s] that advance has taken for nodes, elements, contact, and waiting between threads.
        """

    def bound_frequencies(self) -> NDArray[numpy.float64]:
        """Bound of the squared highest frequency of each element (n) [1/s2]."""

    @property
    def element_mass(self) -> NDArray[numpy.float64]:
        """Mass of each element (n) [t]."""

    @property
    def true_mass(self) -> NDArray[numpy.float64]:
        """Mass of each element without what scaling has added (n) [t]."""

    @property
    def added_mass(self) -> NDArray[numpy.float64]:
        """What scaling has added to the mass of each element (n) [t]."""

    def scale_mass(self, factor: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Multiply the masses of the elements by factors (n)."""

    def set_temperature(self, block: int, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Give the points of a block's elements temperatures (n, points) [degrees C] from now on; of shells (n, points in the plane, layers).
        """

    def add_damage(self, block: int, name: str, law: Damage, *, temperature: float = 20.0, rise: int = -1) -> None:
        """
        Let damage by a criterion grow at the points of a block. temperature: where none is given [degrees C]; rise: row of the rise of temperature behind the first of the stress, -1 if there is none.
        """

    def damage(self, block: int, name: str) -> NDArray[numpy.float64]:
        """Damage by a criterion at the points of a block (n, points)."""

    def set_slower(self, factor: float) -> None:
        """
        Let the laws of shells take their rates by a time that is so many times that of the cycles from now on.
        """

    def prescribe(self, fixed: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        Prescribe velocities of the freedoms marked in fixed (n_nodes, freedoms).
        """

    def state(self) -> dict[str, dict[str, NDArray[numpy.float64]]]:
        """All that the next cycle depends on: arrays by owner and name."""

    @property
    def is_finite(self) -> bool:
        """Whether the positions of all nodes are finite numbers."""

    @property
    def position(self) -> NDArray[numpy.float64]:
        """Positions (n_nodes, dimension) [mm]."""

    @position.setter
    def position(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def velocity(self) -> NDArray[numpy.float64]:
        """Velocities (n_nodes, freedoms), half a step back [mm/s, 1/s]."""

    @velocity.setter
    def velocity(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def force(self) -> NDArray[numpy.float64]:
        """Nodal forces and moments from outside (n_nodes, freedoms) [N, N mm]."""

    @force.setter
    def force(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def internal_force(self) -> NDArray[numpy.float64]:
        """
        Internal forces and moments (n_nodes, freedoms) [N, N mm], less those of tools.
        """

    @internal_force.setter
    def internal_force(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    @property
    def reaction_impulse(self) -> NDArray[numpy.float64]:
        """
        Impulse of what holds prescribed freedoms (n_nodes, freedoms), until set to zero [N s, N mm s].
        """

    @reaction_impulse.setter
    def reaction_impulse(self, arg: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], /) -> None: ...

    def add_contact(self, slave: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], slave_cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], master_cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, by_itself: bool, edge: float, thickness: float, mu: float, reach: float, margin: float) -> None:
        """
        Let faces (n, k) of bodies touch; cells (n, nodes): behind each. by_itself: slave and master are the same; edge: mean length [mm]; thickness [mm], 0 of rings; mu: most of friction over pressure; reach and margin: parts of the edge.
        """

    def set_contact_step(self, contact: int, dt: float) -> None:
        """Let the springs of a contact be stable with a step [s]."""

    def limit_contact_friction(self, contact: int, limit: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Largest shear of each slot (n_slots) [MPa] from now on."""

    def contact_passed(self, contact: int) -> bool:
        """Whether the bodies have gone through each other."""

    def contact_pressure(self, contact: int) -> NDArray[numpy.float64]:
        """Pressure of the slots (n_slots) [MPa]."""

    def find_contact_stiffness(self, contact: int) -> NDArray[numpy.float64]:
        """
        Stiffness of the slots' springs as the next cycle has it (n_slots) [MPa/mm].
        """

    def contact_shear(self, contact: int) -> NDArray[numpy.float64]:
        """Shear of the slots, on the slave (n_slots, 3) [MPa]."""

    def contact_push(self, contact: int) -> NDArray[numpy.float64]:
        """
        Forces of the pressure on the nodes of the contact (n, 3) in the last cycle [N].
        """

    def contact_rub(self, contact: int) -> NDArray[numpy.float64]:
        """Forces of friction on them (n, 3) [N]."""

    def contact_area(self, contact: int) -> NDArray[numpy.float64]:
        """Share of them in the surfaces that face each other (n) [mm2]."""

    def contact_work(self, contact: int) -> tuple[float, float]:
        """
        Work that pressure and friction of a contact have taken since the start [N mm].
        """

    def contact_impulse(self, contact: int) -> NDArray[numpy.float64]:
        """
        Impulse that the slave has given to the master since the start (3) [N s].
        """

    def contact_nodes(self, contact: int) -> NDArray[numpy.int32]:
        """Nodes of a contact (n), as the loop has them."""

    def contact_slots(self, contact: int) -> NDArray[numpy.int32]:
        """Nodes of the slots of a contact (n_slots), as the loop has them."""

    def begin_wall_sums(self, wall: int) -> None:
        """Sum up anew what a wall presses and rubs."""

    def set_wall_sums(self, wall: int, pressed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], rubbed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Set those sums, as wall_pressed and wall_rubbed give them."""

    def add_wall(self, segments: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, mu: float = 0.0) -> None:
        """Add a rigid profile; they are numbered as they come."""

    def wall_force(self, wall: int) -> NDArray[numpy.float64]:
        """Forces of a wall on the nodes (n_nodes, 2) in the last cycle."""

    def wall_offset(self, wall: int) -> list[float]:
        """Displacement of a wall since the start [mm]."""

    def wall_impulse(self, wall: int) -> list[float]:
        """Impulse of a wall on the nodes since the start [N s]."""

    def wall_pressed(self, wall: int) -> NDArray[numpy.float64]:
        """
        Impulse of a wall's pressure on the nodes since begin_wall_sums (n_nodes) [N s].
        """

    def wall_rubbed(self, wall: int) -> NDArray[numpy.float64]:
        """
        Work that friction on a wall has taken at the nodes since then (n_nodes) [N mm].
        """

    def move_wall(self, wall: int, velocity: Sequence[float]) -> None:
        """Set a wall's velocity [mm/s]."""

    def join(self, messages: object, sent: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], ghosts: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, out: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], into: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], shared: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], leads: bool) -> None:
        """
        Let the loop be one of those on the parts of a mesh, before it has tools. sent: own nodes whose motion goes out, ghosts: nodes of others whose motion comes in, those of each neighbour together. messages: has send, propose, receive and agree, called once a cycle each, and find_largest; out (sent, k), into (ghosts, k): what is sent and has come, k = 8 where there is a sheet, 3 of solids in space, 2 in the plane; shared (1 + 3 for each tool of a sheet + 4 for each of solids in space, 2 in the plane): the first becomes the largest, the others the sums of all parts'.
        """

    @property
    def nodal_masses(self) -> NDArray[numpy.float64]:
        """
        Masses of the nodes, in space with rotary inertias (n_nodes, 1 | 2) [t, t mm2].
        """

    def set_ghost_masses(self, masses: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Let ghosts have masses as nodal_masses gives them, of the whole mesh."""

    @property
    def stress(self) -> NDArray[numpy.float64]:
        """Stress xx, yy, zz, xy (n, 4) [MPa]."""

    @property
    def eqps(self) -> NDArray[numpy.float64]:
        """Equivalent plastic strain (n)."""

    @property
    def rise(self) -> NDArray[numpy.float64]:
        """Rise of temperature since the start (n)."""

def conduct_heat(cell: str, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], conductivity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, axisymmetric: bool, depth: float, flow: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], conduction: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')] | None) -> int:
    """
    Fill flow, the heat that leaves the nodes of each cell [N mm/s], and its derivative by their temperatures.

    conductivity: rows of temperature and value (n, 2). Returns the number of a cell turned inside out, or -1.
    """

def find_heat_content(pieces: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], latent: float, start: float, end: float, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Heat content [mm2/s2] and specific heat [mm2/(s2 K)] at temperatures of any shape [degrees C].

    pieces (n, 4): temperature from where on, specific heat, its slope and heat content there; latent [mm2/s2] from start to end [degrees C].
    """

def lump_volumes(cell: str, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, axisymmetric: bool, depth: float) -> NDArray[numpy.float64]:
    """Volume that each node of each cell stands for (n_cells, nodes) [mm3]."""

class HeatFilm:
    """What heats and cools the surface of bodies, lumped at its nodes."""

    @staticmethod
    def at_nodes(nodes: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], factor: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], other: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> HeatFilm:
        """
        Nodes (n,) that exchange heat with temperatures (n,) [degrees C] by factors (n,) [N mm/(s K)].
        """

    @staticmethod
    def convection(area: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], coefficient: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], ambient: float) -> HeatFilm:
        """
        Newton's law of cooling: areas of the nodes (n_points,) [mm2], rows of temperature and coefficient (n, 2).
        """

    @staticmethod
    def radiation(factor: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], ambient: float) -> HeatFilm:
        """
        To large surroundings: area, emissivity and Stefan and Boltzmann's constant (n_points,) [N mm/(s K4)].
        """

    @staticmethod
    def flux(power: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> HeatFilm:
        """Heat that does not depend on temperature (n_points,) [N mm/s]."""

    @staticmethod
    def between(pairs: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], factor: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> HeatFilm:
        """Pairs of nodes (n, 2) and their conductances (n,) [N mm/(s K)]."""

    @staticmethod
    def martensite(nodes: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], heat: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], free: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], before: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, start: float, rate: float) -> HeatFilm:
        """
        Heat of the martensite that forms at nodes (n,) in a step: heat [N mm/s] of all of each, fractions of what may form and has formed (n,), start [degrees C], rate [1/K].
        """

    def evaluate(self, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Heat given to the nodes [N mm/s] and minus its derivative by their own temperatures [N mm/(s K)].
        """

class HeatStepResult:
    """A time step of the heat equation."""

    @property
    def outcome(self) -> str:
        """converged, unbounded, singular, no balance, or turned cell."""

    @property
    def temperature(self) -> NDArray[numpy.float64]:
        """(n_points,) [degrees C]."""

    @property
    def power(self) -> NDArray[numpy.float64]:
        """
        Heat that flowed in by each film and, last, by prescribed temperatures, into the nodes counted first and into the others (n_films + 1, 2) [N mm/s].
        """

    @property
    def residual(self) -> list[float]:
        """Of every iteration, over the sum of all flows."""

    @property
    def correction(self) -> list[float]:
        """Largest of every iteration [K]."""

    @property
    def assembly_seconds(self) -> float: ...

    @property
    def solve_seconds(self) -> float: ...

    @property
    def block(self) -> int:
        """Of the cell that is turned inside out."""

    @property
    def cell(self) -> int:
        """That is turned inside out."""

class HeatBody:
    """Cells of one kind and material that conduct and store heat."""

    def __init__(self, cell: str, connectivity: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], conductivity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], pieces: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], latent: tuple[float, float, float], mass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """
        conductivity (n, 2); pieces and latent as in find_heat_content; mass at the nodes (n_points,) [t].
        """

class HeatEquation:
    """Time steps of the heat equation by backward Euler."""

    def __init__(self, bodies: Sequence[HeatBody], *, axisymmetric: bool, depth: float) -> None: ...

    def find_content(self, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Heat stored at the nodes (n_points,) [N mm] and its derivative [N mm/K].
        """

    def solve(self, assembler: ScalarAssembler, *, points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], temperature_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], dt: float, films: Sequence[HeatFilm], mask: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)], prescribed: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], source: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None, counted: int, guess: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], iterative: bool, direct: Callable[[bool, Annotated[NDArray[numpy.float64], dict(writable=False)], Annotated[NDArray[numpy.float64], dict(writable=False)]], Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None]) -> HeatStepResult:
        """
        Temperatures at the end of a step from a guess at them.

        direct: called with whether the matrix is new, its values and the right-hand side where iterations do not find a correction; None for a singular matrix.
        """

def find_touch(edges: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], areas: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, holds: Annotated[NDArray[numpy.bool_], dict(order='C', device='cpu', writable=False)], push: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], gap: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], conductance: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], width: float, seen: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu')], corners: int = 2) -> tuple[NDArray[numpy.bool_], NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Where a tool touches edges (n, nodes), in space faces, or is near them; corners: of each, its first nodes.

    holds, push [N], gap [mm]: at nodes (n_points,); conductance: rows of pressure [MPa] and value (n, 2); width [mm]: across which heat passes; seen (n, nodes) loses what touches and what passes. Returns edges that touch (n,), the pressure at their nodes (n_points,), and the nodes that touch or are near with their areas and conductances.
    """

def sum_pairs(own_side: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], other_side: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], own_shape: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], other_shape: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], own: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], other: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], amounts: Sequence[Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]]) -> tuple[NDArray[numpy.int32], list[NDArray[numpy.float64]]]:
    """
    Pairs of nodes (n, 2), each once, and sums over them of amounts at points of sides own that face sides other, as find_facing returns them.
    """

def link_tool(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], pieces: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], *, touching: Annotated[NDArray[numpy.bool_], dict(order='C', device='cpu', writable=False)], pressure: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], profile: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], gap: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], conductance: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], width: float, chords: float, thickness: float) -> tuple[NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    What passes between pieces (m, 2) of a surface and the profile (k, 2) of a tool with a mesh: pairs of nodes (n, 2), conductance times shared area [N mm/(s K)] and shared area [mm2].

    touching: of the edges (n_edges,), whose pieces follow each other edge by edge, once or twice; pressure [MPa], gap [mm]: at nodes; conductance, width as find_touch has them; chords: of a piece, how far the mesh of the tool may lie off; thickness as find_facing has it.
    """

class HeatColumn:
    """A row of finite volumes behind a surface."""

    def __init__(self, capacity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], between: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None: ...

    def step(self, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], dt: float) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Temperatures (n, cells) after dt [s] without a flux, and what a flux of 1 adds (cells,).
        """

class DamageCriterion(enum.Enum):
    """Criterion of ductile fracture."""

    cockcroft_latham = 0

    rice_tracey = 1

    oyane = 2

    freudenthal = 3

    johnson_cook = 4

    modified_mohr_coulomb = 5

    hosford_coulomb = 6

    bai_wierzbicki = 7

class Damage:
    """Damage that grows with plastic strain and does not act back."""

    def __init__(self, criterion: DamageCriterion, parameters: Mapping[str, float]) -> None: ...

    def advance(self, value_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], stress: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps_n: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], eqps: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, dt: float, temperature: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)] | None = None) -> NDArray[numpy.float64]:
        """
        Damage (n,) of points after an increment of dt [s]: stresses (n, 3 | 4 | 6) [MPa] and equivalent plastic strains (n,) at its start and end, temperature (n,) [degrees C].
        """

most_donors: int = 12

donor_rings: int = 4

def locate_in_cells(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], wanted: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.int64], NDArray[numpy.int64], NDArray[numpy.float64]]:
    """
    Cell (n,) in which, or nearest to which, each wanted point (n, 2) lies, corners of a triangle of it (n, 3), and barycentric coordinates there (n, 3).
    """

def restore_delaunay(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], corners: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], beside: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.int32], NDArray[numpy.int32]] | None:
    """
    Delaunay's triangles (n, 3) of points (n_points, 2) that have moved a little, and which lie opposite to each corner (n, 3), from those before; None where a triangle has turned inside out.
    """

def smooth_cells(points: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], n_fixed: int, *, most_rounds: int, most_retreats: int, good: float) -> NDArray[numpy.float64]:
    """
    Points (n, 2) of quadrilaterals (m, 4), all but the first n_fixed moved towards the middle of their neighbours in rounds. Where a cell of a quality below good would become worse its nodes go back.
    """

def find_near_cells(cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], home: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], others: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.bool_]:
    """
    Which other cells (n, k) share a node with the cell home (n,), or with a cell that does.
    """

def measure_thickness(middle: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], normal: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], radius: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, reach: float, opposite: float) -> NDArray[numpy.float64]:
    """
    Distance [mm] along the normals outwards (n, 3) of faces with these middles (n, 3) and radii (n,) of the nearest face that looks the other way, by a cosine below -opposite; infinite beyond reach (n,).
    """

class Donors:
    """Points of an old mesh from which values at new points are fitted."""

    def __init__(self, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], cell_of: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], cells: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> None: ...

    def fit(self, places: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], home: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.int32], NDArray[numpy.float64], NDArray[numpy.float64]]:
        """
        Donors of new points (n, 2), whose cells home (n,) are, the nearest first, and their weights in the quadratic and the linear fit, each (n, most_donors).
        """

    def find_peaks(self, places: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], home: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], candidates: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.bool_]:
        """
        Which candidates (n,) among these points have a value above those of all their other donors (n,).

        places (n_old, 2), home (n_old,), values (n_old,): of all points, as they were given.
        """

def refit_donors(position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], places: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], donor: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
    """
    Weights in the quadratic and the linear fit, each (n, most_donors), of donors (n, most_donors) as Donors.fit has found them, once their positions (n_old, 2) and the new places (n, 2) have changed a little.
    """

def apply_fit(donor: Annotated[NDArray[numpy.int32], dict(order='C', device='cpu', writable=False)], weight: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], linear_weight: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
    """
    Values (n, m) at new points by the fits of Donors from values at old ones (n_old, m).
    """

class Device(enum.Enum):
    """What takes the place of the CPU's loop."""

    host = 0
    """the device code on the CPU, a lane after the other"""

    cuda = 1
    """the first NVIDIA card"""

class DevicePart(enum.Enum):
    """
    Parts of the state that are taken from a device where they are asked for.
    """

    places = 6

    nodes = 7

    sums = 8

    reaction = 9

    elements = 10

    damage = 11

    contact = 12

@overload
def find_device_lack(loop: SpaceLoop) -> str: ...

@overload
def find_device_lack(loop: SpaceLoopSingle) -> str:
    """
    What a loop has that no device computes yet, in words; empty where there is nothing.
    """

class DeviceSession:
    """
    State of a loop, of which nothing lacks, on a device, until the loop is changed.
    """

    def __init__(self, loop: SpaceLoop, target: Device, memory: float = 1000000000000000.0) -> None:
        """
        Take it there; memory: that of the host build [bytes]. Raises RuntimeError where it does not fit.
        """

    def advance(self, dt: float, dt_before: float, force_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, damping: float = 0.0) -> tuple[int, LawStatus, int]:
        """
        Advance by as many cycles of dt [s] as the scales have values; tools, beads and work in the loop follow. Gives the element that has failed, why, and in which cycle; it is -1 where none has. Stops where a place is not finite any more. Raises RuntimeError where the device does not.
        """

    @property
    def is_finite(self) -> bool:
        """Whether all places were finite after the last call."""

    def fetch(self, part: DevicePart) -> None:
        """Take a part of the state into the loop."""

    def fetch_measures(self) -> None:
        """
        Of the elements the thickness of shells, and what point_measures gives of solids, alone.
        """

    def clear_reaction(self) -> None:
        """Sum up reactions anew."""

    def send_walls(self) -> None:
        """Let walls move as those of the loop do now."""

    def send_given(self) -> bool:
        """
        Take temperatures and limits of friction there that are given now; False where it had none before.
        """

    def send_sums(self) -> None:
        """Take there what walls of the loop have pressed and rubbed."""

    def energies(self, dt: float, dt_before: float, *, damping: float = 0.0, force_scale: float = 1.0, velocity_scale: float) -> Energies:
        """Energies at the present time, as the loop's."""

    def bound_frequency(self) -> float:
        """The largest bound of an element's squared frequency [1/s2]."""

    def keep(self) -> None:
        """Keep the present state on the device."""

    def put_back(self) -> None:
        """Go back to the state that was kept."""

    @property
    def needed(self) -> float:
        """Memory that it takes [bytes], what is kept counted."""

    @property
    def traffic(self) -> tuple[int, float, int, float]:
        """Copies to the device, bytes of them, copies from it, bytes of them."""

class DeviceSessionSingle:
    """
    State of a loop, of which nothing lacks, on a device, until the loop is changed.
    """

    def __init__(self, loop: SpaceLoopSingle, target: Device, memory: float = 1000000000000000.0) -> None:
        """
        Take it there; memory: that of the host build [bytes]. Raises RuntimeError where it does not fit.
        """

    def advance(self, dt: float, dt_before: float, force_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity_scale: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], *, damping: float = 0.0) -> tuple[int, LawStatus, int]:
        """
        Advance by as many cycles of dt [s] as the scales have values; tools, beads and work in the loop follow. Gives the element that has failed, why, and in which cycle; it is -1 where none has. Stops where a place is not finite any more. Raises RuntimeError where the device does not.
        """

    @property
    def is_finite(self) -> bool:
        """Whether all places were finite after the last call."""

    def fetch(self, part: DevicePart) -> None:
        """Take a part of the state into the loop."""

    def fetch_measures(self) -> None:
        """
        Of the elements the thickness of shells, and what point_measures gives of solids, alone.
        """

    def clear_reaction(self) -> None:
        """Sum up reactions anew."""

    def send_walls(self) -> None:
        """Let walls move as those of the loop do now."""

    def send_given(self) -> bool:
        """
        Take temperatures and limits of friction there that are given now; False where it had none before.
        """

    def send_sums(self) -> None:
        """Take there what walls of the loop have pressed and rubbed."""

    def energies(self, dt: float, dt_before: float, *, damping: float = 0.0, force_scale: float = 1.0, velocity_scale: float) -> Energies:
        """Energies at the present time, as the loop's."""

    def bound_frequency(self) -> float:
        """The largest bound of an element's squared frequency [1/s2]."""

    def keep(self) -> None:
        """Keep the present state on the device."""

    def put_back(self) -> None:
        """Go back to the state that was kept."""

    @property
    def needed(self) -> float:
        """Memory that it takes [bytes], what is kept counted."""

    @property
    def traffic(self) -> tuple[int, float, int, float]:
        """Copies to the device, bytes of them, copies from it, bytes of them."""

def list_cuda_cards() -> tuple[list[tuple[str, int, float, float]], str]:
    """
    NVIDIA cards: name, ten times the compute capability, memory and free memory [bytes] of each; and why there are none.
    """
