# SPDX-License-Identifier: Apache-2.0
"""The part that one step has laid flat as an incremental case: a stamping by tools that are its surface."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from presswork.mesh.files.stl_file import pack_stl
from presswork.model import Limits, OneStepModel
from presswork.onestep.offset_tools import CLEARANCE, OffsetTools, offset_tools
from presswork.onestep.outline import BlankOutline
from presswork.results import OutputError
from presswork.results.whole_file import write_whole

CELLS = 8_000
"""Shells of the whole blank at most, whatever the part's radii ask for."""
_CELLS_ACROSS = 30
"""Least number of cells across the blank, along its longer side."""
_CELLS_A_RADIUS = 2.0
"""Cells along the smallest radius of the part: three round a corner of 90 degrees."""
_SINKS = 0.7
"""Part of limits.penetration to which a chord as long as a shell may sink into a radius that it is bent round."""
_BEYOND = 4.0
"""Most shells for that, over the budget."""
_GAP = 1.1
"""Gap of a holder that no force pushes, over the thickness."""
_CLOSED = 1.05
"""Gap to which a curved holder closes before a force pushes it, over the thickness."""
_HEAD = """\
# A stamping of the part that one step has laid flat: its blank, and tools that are the part's own surface, offset by
# half the thickness to either side. The die stands {clearance:.3g} mm farther off, but for the flange.
"""


def check_case_path(path: Path, *, overwrite: bool = False) -> None:
    """Raise OutputError if no case and tools can be written there, before anything is computed."""
    if path.suffix.lower() != ".toml":
        raise OutputError(f"{path}: a case is written as .toml")
    if not path.absolute().parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.absolute().parent}")
    for file in (path, *(_tool_path(path, kind) for kind in ("punch", "die", "holder"))):
        if file.exists() and not overwrite:
            raise OutputError(f"{file} is there already; choose another name, or use --overwrite")


def _tool_path(path: Path, kind: str) -> Path:
    return path.with_name(f"{path.stem}_{kind}.stl")


def write_stamping_case(
    path: Path, model: OneStepModel, outline: BlankOutline, points: Path, thinning: float, *, cells: int = CELLS
) -> tuple[str, ...]:
    """Write a case of a stamping that draws the part from its blank, and STL files of its tools beside it.

    outline: of the whole blank; points: its CSV file, which the case names. thinning: the largest by one step [%].
    cells: shells of the whole blank at most.
    Return what is doubtful of the tools and the shells. Raises OutputError.
    """
    data = tomllib.loads(model.case_text)
    middle = 0.5 * (model.points.min(axis=0) + model.points.max(axis=0))[:2]
    middle[list(model.symmetry)] = 0.0
    made = offset_tools(model, float(np.linalg.norm(outline.loops[0] - middle, axis=1).max()))
    case: dict[str, Any] = {
        "title": f"{model.title}: drawn from the blank that one step has found",
        "analysis": "stamping",
        "one_step_thinning": float(f"{max(thinning, 0.0):.4g}"),
    }
    size, note = _choose_size(outline, made.smallest_radius, cells, model.thickness)
    case |= {"blank": _describe_blank(path, model, points, data["blank"]["material"], size)}
    if data.get("materials"):
        case["materials"] = data["materials"]
    case["tools"] = {}
    for kind, face in made.faces.items():
        write_whole(_tool_path(path, kind), pack_stl(kind, face))
        case["tools"][kind] = {"kind": kind, "shape": "file", "path": _tool_path(path, kind).name, "mu": model.mu}
    if beads := data.get("process", {}).get("beads"):
        case["beads"] = beads
    case["stages"] = _describe_stages(case["tools"], made, model)
    notes = [*made.notes, *note]
    if len(outline.loops) > 1:
        notes.append(f"{len(outline.loops) - 1} holes of the blank are left out, and filled in the tools: trim them")
    text = _HEAD.format(clearance=CLEARANCE * model.thickness)
    content = (text + "".join(f"# {note}\n" for note in notes) + "\n" + tomli_w.dumps(case)).encode()
    write_whole(path, content)
    return tuple(notes)


def _describe_stages(tools: dict[str, Any], made: OffsetTools, model: OneStepModel) -> list[dict[str, Any]]:
    """Return the tables of the stages: a curved binder wraps the blank before the punch draws it."""
    draw: dict[str, Any] = {"name": "draw", "tools": {"punch": {"stroke": float(f"{made.stroke:.6g}")}}}
    if "holder" not in tools:
        return [draw]
    if model.holder_force > 0.0:
        draw["tools"]["holder"] = {"force": model.holder_force}
    if made.is_binder_curved:
        gap = (_CLOSED if model.holder_force > 0.0 else _GAP) * model.thickness
        return [{"name": "wrap", "tools": {"holder": {"close": float(f"{gap:.6g}")}}}, draw]
    if model.holder_force <= 0.0:
        tools["holder"]["gap"] = float(f"{_GAP * model.thickness:.6g}")
    return [draw]


def _choose_size(
    outline: BlankOutline, smallest_radius: float, cells: int, thickness: float
) -> tuple[float, tuple[str, ...]]:
    """Return the edge of the blank's shells [mm], and a note where the budget makes them longer than radii ask for.

    A chord h sinks h^2/(8 R) into a radius R. Where that would stop the run the budget is exceeded.
    """
    wanted = min(max(outline.extent) / _CELLS_ACROSS, smallest_radius / _CELLS_A_RADIUS)
    least = float(np.sqrt(outline.area / cells))
    if least <= wanted:
        return wanted, ()
    longest = float(np.sqrt(8.0 * smallest_radius * _SINKS * Limits().penetration * thickness))
    size = min(least, max(longest, wanted, least / np.sqrt(_BEYOND)))
    why = (
        f"as long as {cells} of them make them" if size == least else f"more than {cells}, since tools sink into longer"
    )
    return size, (
        f"shells of {size:.2g} mm, {why}: radii of {smallest_radius:.3g} mm ask for "
        f"{wanted:.2g} mm, or {outline.area / wanted**2:.2g} shells",
    )


def _describe_blank(path: Path, model: OneStepModel, points: Path, material: str, size: float) -> dict[str, Any]:
    """Return the table of the blank."""
    return {
        "shape": "outline",
        "path": os.path.relpath(points.resolve(), path.resolve().parent),
        "thickness": model.thickness,
        "element_size": _round_up(size),
        "material": material,
        "rolling_direction": float(f"{np.degrees(model.rolling_direction):.6g}"),
        "symmetry": [axis for axis, is_cut in zip("xy", model.symmetry, strict=True) if is_cut],
    }


def _round_up(size: float) -> float:
    """Return a length with two digits, not smaller."""
    digit = 10.0 ** (np.floor(np.log10(size)) - 1)
    return float(f"{np.ceil(size / digit - 1e-9) * digit:.2g}")
