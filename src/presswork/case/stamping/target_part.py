# SPDX-License-Identifier: Apache-2.0
"""The part that a stamping should make, from a file."""

from __future__ import annotations

import logging
import math
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.case.units import LENGTH, unit_factor
from presswork.mesh import MeshError
from presswork.mesh.files.cad import is_cad
from presswork.mesh.files.tool_file import read_tool
from presswork.model import Triangulation

logger = logging.getLogger(__name__)

_LEAST, _MOST = 0.2, 1.2
"""Diagonal of a part over that of its blank."""
_UNITS = ("mm", "cm", "m", "inch")


def read_target_part(path: Path, unit: str, blank: float) -> Triangulation:
    """Return a face, or the middle, of a part in an STL, STEP or IGES file [mm].

    unit: of the file's lengths; STEP and IGES state their own. blank: diagonal of the whole blank [mm]. Raises
    CaseError for a file that cannot be read, holds a closed body, or is no part of this blank by its size.
    """
    try:
        scale = unit_factor(unit, LENGTH)
    except ValueError as error:
        raise CaseError([Problem("--unit", "unknown unit of length", f"one of {', '.join(_UNITS)}", unit)]) from error
    if not path.is_file():
        raise CaseError([Problem("--target", "there is no such file", "give an STL, STEP or IGES file", str(path))])
    try:
        surface, notes = read_tool(path, scale=1.0 if is_cad(path) else scale, usual_size=blank)
    except MeshError as error:
        raise CaseError(
            [Problem("--target", error.fault.replace("the tool", "the target"), error.remedy, str(path))]
        ) from error
    for note in notes:
        logger.info("--target %s: %s", path, note)
    if surface.is_closed:
        fault = "the target is a closed body, which does not show on which of its faces the sheet lies"
        raise CaseError([Problem("--target", fault, "save one face of the part, or its middle", str(path))])
    size = float(np.linalg.norm(np.ptp(surface.points, axis=0)))
    if not _LEAST * blank <= size <= _MOST * blank:
        raise CaseError([Problem("--target", _explain(size, blank), _suggest(size / scale, blank), str(path))])
    return surface


def _explain(size: float, blank: float) -> str:
    return f"the target is {size:.4g} mm across, and the blank {blank:.4g} mm: it is not this part, or in another unit"


def _suggest(own: float, blank: float) -> str:
    """Name the unit in which a file's size fits the blank's."""
    sizes = {unit: own * unit_factor(unit, LENGTH) for unit in _UNITS}
    fitting = [unit for unit, size in sizes.items() if _LEAST * blank <= size <= _MOST * blank]
    if not fitting:
        return "give the part that the tools make"
    best = min(fitting, key=lambda unit: abs(math.log(sizes[unit] / blank)))
    return f"give --unit {best} ({sizes[best]:.4g} mm)"
