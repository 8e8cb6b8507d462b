# SPDX-License-Identifier: Apache-2.0
"""Quantities: plain numbers in mm, s, t, N, MPa, or strings with a unit such as "200 kN/mm^2"."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

if TYPE_CHECKING:
    from pint import UnitRegistry

_NUMBER_AND_UNIT = re.compile(r"^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*$", re.ASCII)
_DECIMAL_COMMA = re.compile(r"^\s*([+-]?\d+),(\d+)((?:\s*[^\W\d]\S*)?)\s*$", re.ASCII)
_NAME = r"[^\W\d_]+(?:_[^\W\d_]+)*|[%°]"
_FACTOR = rf"(?:1|{_NAME})(?:\s*(?:\*\*|\^)\s*-?\d|[²³])?"
_OPEN, _CLOSE = r"(?:\s*\()?\s*", r"\s*(?:\)\s*)?"
_UNIT = re.compile(rf"{_OPEN}{_FACTOR}{_CLOSE}(?:(?:[*/·]|\s){_OPEN}{_FACTOR}{_CLOSE})*")
"""Names of units with powers of one digit, multiplied and divided: all that a unit can be, and short to evaluate."""
LARGEST_FLOAT = 1.7e308
LEAST_FLOAT = 1e-100
"""Whole numbers of hundreds of digits have no float."""
_LONGEST = 60
"""Letters of the longest text that is taken for a quantity or a unit."""


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity and the unit that a plain number of it has."""

    name: str
    unit: str
    example: str
    largest: float = 1e15
    """Magnitude above which a value is a slip; products of such values stay far from overflow."""


LENGTH = Dimension("a length", "mm", "1 mm", 1e6)
STRESS = Dimension("a stress", "MPa", "200 kN/mm^2")
FORCE = Dimension("a force", "N", "5 kN")
VOLUME = Dimension("a volume", "mm^3", "25 cm^3")
TIME = Dimension("a time", "s", "20 ms", 1e9)
ANGLE = Dimension("an angle", "degree", "1.5 rad", 1e6)
STIFFNESS = Dimension("a stiffness", "N/mm", "2 kN/mm")
MOMENT = Dimension("a moment", "N*mm", "2 N*m")
LINE_FORCE = Dimension("a force per length", "N/mm", "3 kN/m")
BODY_FORCE = Dimension("a force per volume", "N/mm^3", "77 kN/m^3")
VELOCITY = Dimension("a velocity", "mm/s", "2 m/s", 1e9)
ACCELERATION = Dimension("an acceleration", "mm/s^2", "9.81 m/s^2", 1e9)
DENSITY = Dimension("a density", "t/mm^3", "7850 kg/m^3")
RATE = Dimension("a rate", "1/s", "100 1/s")
HEAT_CAPACITY = Dimension("a specific heat capacity", "mm^2/(s^2*K)", "460 J/(kg*K)")
CONDUCTIVITY = Dimension("a thermal conductivity", "N/(s*K)", "30 W/(m*K)", 1e5)
HEAT_TRANSFER = Dimension("a coefficient of heat transfer", "N/(mm*s*K)", "2000 W/(m^2*K)", 1e4)
HEAT_FLUX = Dimension("a heat flux", "N/(mm*s)", "50 kW/m^2")
ACTIVATION_ENERGY = Dimension("an energy per mole", "J/mol", "312 kJ/mol")
HEAT_OF_MASS = Dimension("a heat per mass", "mm^2/s^2", "250 kJ/kg")
ENERGY = Dimension("an energy", "kJ", "25 kJ", 1e9)
POWER = Dimension("a power", "kW", "90 kW", 1e9)
MASS = Dimension("a mass", "kg", "2 t", 1e9)
PURE_NUMBER = Dimension("a number without a unit", "", "0.3", 1e30)
THIN = 1e-9
"""Least extent of a body over its largest."""
ANY_LIST = "write for instance "
"""Beginning of a remedy that ends with a list of values."""
ANY_NUMBER = f"write for instance {PURE_NUMBER.example}"
"""Remedy of a key that takes a number without a unit."""

_USUAL = {
    LENGTH: {"mm": 1.0, "cm": 10.0, "m": 1e3, "um": 1e-3, "in": 25.4, "inch": 25.4},
    STRESS: {"MPa": 1.0, "N/mm^2": 1.0, "GPa": 1e3, "kN/mm^2": 1e3, "Pa": 1e-6, "HV": 9.80665},
    FORCE: {"N": 1.0, "kN": 1e3},
    VOLUME: {"mm^3": 1.0},
    TIME: {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    ANGLE: {"degree": 1.0, "deg": 1.0},
    STIFFNESS: {"N/mm": 1.0, "kN/mm": 1e3},
    VELOCITY: {"mm/s": 1.0, "m/s": 1e3},
    ACCELERATION: {"mm/s^2": 1.0, "m/s^2": 1e3},
    DENSITY: {"t/mm^3": 1.0, "kg/m^3": 1.0000000000000002e-12},
    HEAT_CAPACITY: {"J/(kg*K)": 1e6},
    CONDUCTIVITY: {"W/(m*K)": 1.0},
    HEAT_TRANSFER: {"W/(m^2*K)": 1e-3, "kW/(m^2*K)": 1.0},
    HEAT_FLUX: {"W/m^2": 1e-3, "kW/m^2": 1.0},
    ACTIVATION_ENERGY: {"J/mol": 1.0, "kJ/mol": 1e3},
    HEAT_OF_MASS: {"kJ/kg": 1e9, "J/kg": 1e6},
    ENERGY: {"kJ": 1.0},
    POWER: {"kW": 1.0},
    MASS: {"kg": 1.0},
}
"""Factors that pint gives, to the last bit, of the units in most cases: pint takes as long to load as such a run."""


def fault(expected: str, remedy: str = "", key: str = "") -> PydanticCustomError:
    """Make the error that a validator of the schema raises; `key` names the sub-key at fault."""
    # the text goes through a template, which takes braces in it for names
    return PydanticCustomError("case", "{expected}; {remedy}", {"expected": expected, "remedy": remedy, "key": key})


@functools.cache
def _unit_registry() -> UnitRegistry[Any]:
    import pint  # slow to import, and most cases are written in plain numbers

    return pint.UnitRegistry()


@functools.cache
def unit_factor(unit: str, dimension: Dimension) -> float:
    """Return what a number in `unit` is multiplied by to be in the dimension's own unit.

    Raises ValueError, with the reason, for a unit that is unknown or of another dimension.
    """
    if unit in (usual := _USUAL.get(dimension, {})):
        return usual[unit]
    if len(unit) > _LONGEST or not (unit == "" or _UNIT.fullmatch(unit)):
        shown = unit if len(unit) <= _LONGEST else f"{unit[:_LONGEST]} ..."
        raise ValueError(f"unknown unit `{shown}`")
    return _ask_pint(unit, dimension)


def _ask_pint(unit: str, dimension: Dimension) -> float:
    """Return what pint reports about a unit that has the form of one. Raises ValueError, as unit_factor."""
    import pint

    registry = _unit_registry()
    try:
        parsed = registry.parse_units(unit.replace("·", "*"))
    except Exception as error:  # pint raises its own, tokenizer's and Python's errors
        raise ValueError(f"unknown unit `{unit}`") from error
    try:
        return float((1.0 * parsed).to(dimension.unit or "dimensionless").magnitude)
    except (pint.DimensionalityError, pint.OffsetUnitCalculusError, ArithmeticError) as error:
        kind = str(parsed.dimensionality).replace("[", "").replace("]", "")
        raise ValueError(f"`{unit}` has the dimension {kind}") from error


def to_number(value: object, dimension: Dimension) -> float:
    """Convert a plain number or a string with a unit to a number in mm, s, t, N, MPa."""
    own = f"in {dimension.unit}" if dimension.unit else "plain"
    expected = f"expected {dimension.name} ({own}, or with a unit)" if dimension.unit else f"expected {dimension.name}"
    if dimension.unit:
        remedy = f'write a plain number in {dimension.unit}, or for instance "{dimension.example}"'
    else:
        remedy = ANY_NUMBER
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise fault(expected, remedy)
    if isinstance(value, str):
        match = _NUMBER_AND_UNIT.match(value) if len(value) <= 2 * _LONGEST else None
        if match is None:
            raise fault(expected, remedy)
        if comma := _DECIMAL_COMMA.match(value):
            whole, part, rest = comma.groups()
            raise fault(f"{expected}, but it has a decimal comma", f"write {whole}.{part}{rest}")
        try:
            number = float(match.group(1)) * unit_factor(match.group(2), dimension)
        except ValueError as error:
            reason = f"{error}" if match.group(2) else "it has no unit"
            raise fault(f"{expected}, but {reason}", remedy) from None
    else:
        number = float(value) if abs(value) < LARGEST_FLOAT else math.inf
    if not math.isfinite(number):
        raise fault(f"{expected} that is finite", remedy)
    if 0.0 < abs(number) < LEAST_FLOAT:
        raise fault(f"{expected}, and {number:g} is none that a computer can square", "check its exponent")
    if abs(number) > dimension.largest:
        raise fault(f"expected {dimension.name} up to {dimension.largest:g} {dimension.unit}".rstrip(), remedy)
    return number


def split_quantity(value: object) -> tuple[float, str] | None:
    """Return number and unit of a plain number, or of a text such as "2 kN"; None if it is neither."""
    if isinstance(value, str):
        match = _NUMBER_AND_UNIT.match(value) if len(value) <= 2 * _LONGEST else None
        return (float(match.group(1)), match.group(2)) if match else None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < LARGEST_FLOAT:
        return None
    return float(value), ""


def to_entries(values: Sequence[object], *converts: Callable[[object], float]) -> tuple[float, ...]:
    """Convert the entries of a list, each with its own converter; a fault is reported for the entry, by its index."""
    found = []
    for index, (value, convert) in enumerate(zip(values, converts, strict=True)):
        try:
            found.append(convert(value))
        except PydanticCustomError as error:
            context = error.context or {}
            raise fault(context["expected"], context["remedy"], key=str(index)) from None
    return tuple(found)


def refuse_no_body(size: Sequence[float], key: str = "size") -> None:
    """Raise a fault of a key where a body has no thickness beside its other extents [mm]."""
    if min(size) < THIN * max(size):
        text = f"a body {min(size):g} mm thin beside its {max(size):g} mm is none"
        raise fault(text, "check the values and their units", key=key)


def to_pair(value: object, dimension: Dimension) -> tuple[float, float]:
    """Convert [x, y], each a number or a string with a unit."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        example = "[0, -1]" if dimension is PURE_NUMBER else "[10, 15]"
        raise fault(f"expected [x, y], two values, each {dimension.name}", f"{ANY_LIST}{example}")
    x, y = to_entries(value, *[functools.partial(to_number, dimension=dimension)] * 2)
    return x, y


def to_place(value: object) -> object:
    """Convert [x, y], each a number or a string with a unit; the word "touch" stays."""
    return value if value == "touch" else to_pair(value, LENGTH)


def to_place3(value: object) -> object:
    """Convert [x, y, z], each a number or a string with a unit; the word "touch" stays."""
    return value if value == "touch" else to_triple(value, LENGTH)


def to_sides(value: object) -> tuple[float, float]:
    """Convert one length for both directions, or [x, y], each a number or a string with a unit."""
    if isinstance(value, list | tuple):
        return to_pair(value, LENGTH)
    both = to_number(value, LENGTH)
    return both, both


def to_triple(value: object, dimension: Dimension) -> tuple[float, float, float]:
    """Convert [x, y, z], each a number or a string with a unit."""
    if not isinstance(value, list | tuple) or len(value) != 3:
        example = "[0, 0, -1]" if dimension is PURE_NUMBER else "[10, 15, 20]"
        raise fault(f"expected [x, y, z], three values, each {dimension.name}", f"{ANY_LIST}{example}")
    x, y, z = to_entries(value, *[functools.partial(to_number, dimension=dimension)] * 3)
    return x, y, z


def _json_schema(dimension: Dimension) -> dict[str, Any]:
    if not dimension.unit:
        return {"type": "number"}
    return {"anyOf": [{"type": "number"}, {"type": "string", "examples": [dimension.example]}]}


def _scalar(dimension: Dimension) -> tuple[BeforeValidator, WithJsonSchema]:
    return (
        BeforeValidator(functools.partial(to_number, dimension=dimension)),
        WithJsonSchema(_json_schema(dimension)),
    )


def _pair(dimension: Dimension) -> tuple[BeforeValidator, WithJsonSchema]:
    return (
        BeforeValidator(functools.partial(to_pair, dimension=dimension)),
        WithJsonSchema({"type": "array", "items": _json_schema(dimension), "minItems": 2, "maxItems": 2}),
    )


def _triple(dimension: Dimension) -> tuple[BeforeValidator, WithJsonSchema]:
    return (
        BeforeValidator(functools.partial(to_triple, dimension=dimension)),
        WithJsonSchema({"type": "array", "items": _json_schema(dimension), "minItems": 3, "maxItems": 3}),
    )


Length = Annotated[float, *_scalar(LENGTH)]
Stress = Annotated[float, *_scalar(STRESS)]
Time = Annotated[float, *_scalar(TIME)]
Force = Annotated[float, *_scalar(FORCE)]
Volume = Annotated[float, *_scalar(VOLUME)]
Angle = Annotated[float, *_scalar(ANGLE)]
Stiffness = Annotated[float, *_scalar(STIFFNESS)]
Velocity = Annotated[float, *_scalar(VELOCITY)]
Density = Annotated[float, *_scalar(DENSITY)]
Rate = Annotated[float, *_scalar(RATE)]
Conductivity = Annotated[float, *_scalar(CONDUCTIVITY)]
HeatTransfer = Annotated[float, *_scalar(HEAT_TRANSFER)]
HeatFlux = Annotated[float, *_scalar(HEAT_FLUX)]
ActivationEnergy = Annotated[float, *_scalar(ACTIVATION_ENERGY)]
HeatOfMass = Annotated[float, *_scalar(HEAT_OF_MASS)]
HeatCapacity = Annotated[float, *_scalar(HEAT_CAPACITY)]
Energy = Annotated[float, *_scalar(ENERGY)]
Power = Annotated[float, *_scalar(POWER)]
Mass = Annotated[float, *_scalar(MASS)]
Number = Annotated[float, *_scalar(PURE_NUMBER)]
Point = Annotated[tuple[float, float], *_pair(LENGTH)]
Place = Annotated[
    Literal["touch"] | tuple[float, float],
    BeforeValidator(to_place),
    WithJsonSchema({"anyOf": [{"const": "touch"}, {"type": "array", "items": _json_schema(LENGTH)}]}),
]
Sides = Annotated[
    tuple[float, float],
    BeforeValidator(to_sides),
    WithJsonSchema({"anyOf": [_json_schema(LENGTH), {"type": "array", "items": _json_schema(LENGTH)}]}),
]
ForceVector = Annotated[tuple[float, float], *_pair(FORCE)]
StressVector = Annotated[tuple[float, float], *_pair(STRESS)]
AccelerationVector = Annotated[tuple[float, float], *_pair(ACCELERATION)]
AccelerationVector3 = Annotated[tuple[float, float, float], *_triple(ACCELERATION)]
VelocityVector = Annotated[tuple[float, float], *_pair(VELOCITY)]
Direction = Annotated[tuple[float, float], *_pair(PURE_NUMBER)]
Point3 = Annotated[tuple[float, float, float], *_triple(LENGTH)]
Place3 = Annotated[
    Literal["touch"] | tuple[float, float, float],
    BeforeValidator(to_place3),
    WithJsonSchema({"anyOf": [{"const": "touch"}, {"type": "array", "items": _json_schema(LENGTH)}]}),
]
Direction3 = Annotated[tuple[float, float, float], *_triple(PURE_NUMBER)]
VelocityVector3 = Annotated[tuple[float, float, float], *_triple(VELOCITY)]
StressVector3 = Annotated[tuple[float, float, float], *_triple(STRESS)]
Force3 = Annotated[tuple[float, float, float], *_triple(FORCE)]
Moment3 = Annotated[tuple[float, float, float], *_triple(MOMENT)]
LineForce = Annotated[float, *_scalar(LINE_FORCE)]
EdgeForceVector = Annotated[tuple[float, float, float], *_triple(LINE_FORCE)]
BodyForceVector = Annotated[tuple[float, float, float], *_triple(BODY_FORCE)]
