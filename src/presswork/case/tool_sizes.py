# SPDX-License-Identifier: Apache-2.0
"""Whether tools, workpiece and thickness are of sizes that go together, and if not, which unit of length would fit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from presswork.case.errors import Problem
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.pose import find_space_pose, start_profile
from presswork.geometry.segments import sample_points
from presswork.geometry.tool_surface import list_extreme_points
from presswork.model import FloatArray, Model, Plane, Profile, Tool

if TYPE_CHECKING:
    from presswork.case.case_file import CaseFile

UNITS = {"mm": 1.0, "cm": 10.0, "inch": 25.4, "m": 1e3, "um": 1e-3}
"""Millimetres in units of length that files are written in."""
LARGE, SMALL, TINY = 12.0, 0.25, 0.03
"""Sizes of the workpiece beyond which a tool from a file is probably in another unit; small ones count if all are."""
LARGE_DRAWN, SMALL_DRAWN = 30.0, 0.01
"""The same of tools that the case draws, which may be needles, rolls and long flats."""
LARGE_PUNCH = 8.0
"""The same of a punch of a stamping, which is about as large as the blank."""
USUAL, LIKELY = 1.6, (0.4, 8.0)
"""A tool's usual size over the workpiece's, and the sizes that a guess of its unit must lead to."""
FOIL, BLOCK = 2e4, 15.0
"""Diagonal of a sheet over its thickness, beyond which it is thinner than foil, or no sheet."""
LEAST, MOST = 0.1, 5e4
"""Diagonals of a workpiece that are believed [mm]."""


def warn_of_sheet(case: CaseFile, model: Model) -> Iterator[str]:
    """Yield what looks like another unit of length in a stamping: its thickness, and tools of its operations."""
    size = float(np.linalg.norm(np.ptp(model.mesh.points, axis=0)))
    yield from warn_of_thickness(model.thickest, size)
    operations = getattr(case, "operations", None) or [case]
    for number, operation in enumerate(operations):
        key = f"operations.{number}.tools" if len(operations) > 1 else "tools"
        yield from warn_of_tools(getattr(operation, "tools", {}), model.of_operation(number).tools, size, key)


def warn_of_tools(drawn: Mapping[str, Any], tools: Sequence[Tool], size: float, key: str = "tools") -> Iterator[str]:
    """Yield the tools whose size looks like another unit of length.

    drawn: tools as the case has them, by name. size: diagonal of the workpiece [mm].
    """
    if not LEAST <= size <= MOST:
        yield f"the workpiece is {size:.3g} mm across: plain numbers are mm, and a file's unit is its key `unit`"
    sizes = {tool.name: found for tool in tools if (found := measure_tool(tool))}
    files = {name for name in sizes if _is_file(drawn.get(name))}
    all_small = all(sizes[name] < SMALL * size for name in files)
    for tool in (tool for tool in tools if tool.name in sizes):
        own = sizes[tool.name]
        if _is_off(tool, own / size, is_file=tool.name in files, all_small=all_small):
            yield _explain(f"{key}.{tool.name}", drawn.get(tool.name), own, size)


def check_thickness(thickness: float, size: float) -> Problem | None:
    """Return a problem of a sheet thinner than foil, or as thick as wide: another unit. size: its diagonal [mm]."""
    if size / thickness < 2.0:
        return Problem(
            "blank.thickness", f"no sheet: it is {size:.4g} mm across", "plain numbers are mm: 0.8", thickness
        )
    if size / thickness <= FOIL:
        return None
    fits = next(
        (f', or "{thickness:g} {unit}"' for unit in ("inch", "cm", "m") if size / thickness < 500.0 * UNITS[unit]), ""
    )
    fault = f"thinner than foil for a sheet {size:.4g} mm across"
    return Problem("blank.thickness", fault, f"plain numbers are mm: 0.8{fits}", thickness)


def warn_of_thickness(thickness: float, size: float) -> Iterator[str]:
    """Yield what is odd about a thick sheet; size: its diagonal [mm]."""
    if size / thickness < BLOCK:
        yield (
            f"blank.thickness = {thickness:g}: thick for a sheet {size:.3g} mm across: shells are thin. Is the sheet "
            "or its file in another unit? Plain numbers are mm"
        )


def measure_tool(tool: Tool) -> float | None:
    """Return the diagonal of a tool [mm]; None where it has no end."""
    if isinstance(tool.shape, Plane):
        return None
    if isinstance(tool.shape, Profile):
        places = sample_points(start_profile(tool))
    else:
        places = find_space_pose(tool, np.zeros(3)).carry(list_extreme_points(tool.shape))
    extent = np.ptp(places[:, np.isfinite(places).all(axis=0)], axis=0)
    return float(np.linalg.norm(extent)) or None


def _is_file(drawn: Any) -> bool:
    return any(getattr(drawn, key, None) is not None for key in ("path", "profile_file"))


def _is_off(tool: Tool, share: float, *, is_file: bool, all_small: bool) -> bool:
    """Return whether a tool's size over the workpiece's is one that no tool has."""
    if is_file:
        return share > LARGE or share < TINY or (share < SMALL and all_small)
    if tool.kind == "punch":
        return share > LARGE_PUNCH or share < SMALL_DRAWN
    is_flat = isinstance(tool.shape, Profile) and len(tool.shape.segments) == 1
    return (share > LARGE_DRAWN and not is_flat) or share < SMALL_DRAWN


def doubt_file(key: str, drawn: Any, points: FloatArray, size: float) -> str | None:
    """Return what is odd about the size of a tool's file before it is moved and cut; None where nothing is.

    points: of its surface, in the unit that it was read in (n, 3) [mm]. size: of the workpiece [mm].
    """
    own = float(np.linalg.norm(np.ptp(points, axis=0)))
    return None if SMALL * size <= own <= LARGE * size else _explain(key, drawn, own, size)


def _explain(key: str, drawn: Any, own: float, size: float) -> str:
    """Describe how large a tool is, and which unit would make it about as large as the workpiece."""
    share = own / size
    text = f"{key}: the tool is {own:.4g} mm across, {share:.3g} times the workpiece of {size:.4g} mm"
    unit = getattr(drawn, "unit", None)
    try:
        scale = unit_factor(unit, LENGTH) if unit else 1.0
    except ValueError:
        scale = 1.0
    fitting = {name: share * factor / scale for name, factor in UNITS.items() if factor != scale}
    fitting = {name: each for name, each in fitting.items() if LIKELY[0] <= each <= LIKELY[1]}
    if not fitting:
        return f"{text}: check the units of both; plain numbers are mm"
    name = min(fitting, key=lambda each: abs(math.log(fitting[each] / USUAL)))
    if _is_file(drawn):
        return f'{text}: is its file in {name}? With unit = "{name}" it would be {fitting[name]:.3g} times as large'
    return f"{text}: are its numbers in {name}? Plain numbers are mm; in {name} it would be {fitting[name]:.3g} times"
