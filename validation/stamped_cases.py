# SPDX-License-Identifier: Apache-2.0
"""Files of the parts of `validation.stamped_parts`: tools and part as STL, a blank, and the cases that use them.

Run: python -m validation.stamped_cases FOLDER [--first 0] [--count 8]
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from presswork.model import FloatArray
from validation.closed_dies_in_space import write_stl
from validation.stamped_parts import Facets, StampedPart, draw_face, draw_lines, draw_part, draw_section

_BEYOND = 12.0
"""By how much tools reach beyond the ends of a rail and the edge of a blank [mm]."""
_ADDENDUM = 6.0
"""Of a blank beyond the part's edge [mm]."""
_FIRM, _MILD = 3.0, 2.0
"""Pressure of the holder on strong and on soft sheets [MPa]."""
_CLOSED = 0.9
"""Of the clearance: so much of it the punch takes at the end, over a flat bottom."""
_CELLS = 1500
"""About so many shells at most, in the part of a blank that is computed."""
_STRIP, _FINER = 2, 2.0
"""Shells along a hat, which is computed as a slice, and how much finer they are: springback needs six on a radius."""


def draw_tools(part: StampedPart, reach: float) -> dict[str, Facets]:
    """Return the faces of the tools where they have closed; reach: width of die and holder beyond the die's radius."""
    section = draw_section(part)
    half, clear = 0.5 * part.thickness, part.clearance
    tools = {"die": draw_face(part, -half, reach=reach, beyond=_BEYOND)}
    if not part.is_drawn:
        return tools | {"punch": draw_face(part, half + clear, reach=reach, beyond=_BEYOND)}
    inner, flat = slice(0, section.wall_end + 1), slice(section.flange_start, None)
    tools["punch"] = draw_face(part, half + clear, beyond=_BEYOND, columns=inner, riser=2.0 * part.depth)
    tools["holder"] = draw_face(part, half, reach=reach, beyond=_BEYOND, columns=flat, has_bottom=False)
    return tools


def draw_blank(part: StampedPart) -> FloatArray:
    """Return corners (n, 2) of the flat blank: areas of the part kept, sector by sector."""
    section = draw_section(part)
    length = float(section.length[-1]) + _ADDENDUM
    lines = draw_lines(part)
    if not part.is_closed:
        (left, out_left), (right, out_right) = lines
        return np.concatenate([(left + length * out_left)[::-1], right + length * out_right])
    line, out = lines[0]
    middle, step = 0.5 * (section.s[1:] + section.s[:-1]), np.diff(section.length)
    area = part.corner * length + float((middle * step).sum()) + 0.5 * (_ADDENDUM + 2.0 * section.s[-1]) * _ADDENDUM
    round_corner = float(np.sqrt(part.corner**2 + 2.0 * area)) - part.corner
    turn = np.linalg.norm(np.roll(out, -1, axis=0) - np.roll(out, 1, axis=0), axis=1)
    if turn.min() > 1e-9:
        return line + round_corner * out
    width = np.where(turn > 1e-9, round_corner, length)
    for _ in range(3):
        width = 0.25 * np.roll(width, 1) + 0.5 * width + 0.25 * np.roll(width, -1)
    return line + width[:, None] * out


def find_planes(part: StampedPart) -> list[str]:
    """Return the symmetry planes of a part."""
    return {"rail": [], "arc": ["y"], "bracket": ["x"]}.get(part.kind, ["x", "y"])


def find_element_size(part: StampedPart, outline: FloatArray) -> float:
    """Return the edge of shells: three along the smaller radius, or so many as are to be computed at most [mm]."""
    x, y = outline.T
    area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2 ** len(find_planes(part))
    along = 0.5 * np.pi * (min(part.punch_radius, part.die_radius) + 0.5 * part.thickness) / 3.0
    return float(f"{max(along, np.sqrt(area / _CELLS)):.2g}")


def write_case(part: StampedPart, folder: Path, **changes: Any) -> Path:
    """Write a stamping of the part with its springback, the part cut to its edge; return the case's path."""
    folder.mkdir(parents=True, exist_ok=True)
    outline = draw_blank(part)
    reach = part.flange + _BEYOND + 2.0 * part.depth
    tools = draw_tools(part, reach)
    for name, face in tools.items():
        turned = face.triangles if name == "die" else face.triangles[:, ::-1]
        write_stl(folder / f"{name}.stl", face.points, turned)
    np.savetxt(folder / "blank.txt", outline, fmt="%.5f")
    size = find_element_size(part, outline)
    stroke = 0.5 * part.thickness - float(tools["punch"].points[:, 2].min()) + _CLOSED * part.clearance
    actions: dict[str, Any] = {"punch": {"stroke": round(stroke, 4)}}
    blank: dict[str, Any] = {"thickness": part.thickness, "material": part.material, "points": 7,
                             "symmetry": find_planes(part), "element_size": size}  # fmt: skip
    if part.kind == "hat":
        size = float(f"{size / _FINER:.2g}")
        width = _STRIP * 2.0 * size
        across = float(outline[:, 0].max())
        blank |= {"shape": "rectangle", "size": [2.0 * across, width], "element_size": [size, 2.0 * size]}
        held = 2.0 * width * part.flange
    else:
        blank |= {"shape": "outline", "path": "blank.txt"}
        held = _measure(outline) - _measure(_edge(part, part.flange))
    if part.is_drawn:
        pressure = _MILD if part.is_closed else _FIRM
        actions["holder"] = {"force": float(f"{pressure * held:.3g}")}
    case: dict[str, Any] = {
        "title": f"{part.kind} of seed {part.seed}, {part.material}", "analysis": "stamping", "blank": blank,
        "tools": {name: {"kind": name, "shape": "file", "path": f"{name}.stl", "mu": 0.1} for name in tools},
        "stages": [*_wrap(part), {"name": "form", "velocity": "5 m/s", "tools": actions}],
        "springback": {}, "output": {"rows": 20, "steps": 4},
    }  # fmt: skip
    if part.kind == "hat":
        case["boundary"] = {"slice": {"set": "top", "hold": "symmetry_y"}}
    path = folder / "case.toml"
    path.write_text(tomli_w.dumps(case | changes))
    return path


def _wrap(part: StampedPart) -> list[dict[str, Any]]:
    """Return the stage in which a curved binder closes on the flat blank."""
    if not part.binder_radius:
        return []
    return [{"name": "wrap", "velocity": "2 m/s", "tools": {"holder": {"close": round(1.05 * part.thickness, 4)}}}]


def _edge(part: StampedPart, less: float = 0.0) -> FloatArray:
    """Return the part's edge in the plan, or a line so much inside of it (n, 2)."""
    s = float(draw_section(part).s[-1]) - less
    rims = [line + s * out for line, out in draw_lines(part)]
    return rims[0] if part.is_closed else np.concatenate([rims[0][::-1], rims[1]])


def _measure(outline: FloatArray) -> float:
    """Return the area inside a line [mm2]."""
    x, y = outline.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def write_onestep(part: StampedPart, folder: Path) -> Path:
    """Write a case of the one-step solver and the part, cut by its symmetry planes; return the case's path."""
    folder.mkdir(parents=True, exist_ok=True)
    face, planes = draw_face(part, 0.0), find_planes(part)
    middle = face.points[face.triangles].mean(axis=1)
    own = (middle[:, ["xy".index(plane) for plane in planes]] > 0.0).all(axis=1)
    write_stl(folder / "part.stl", face.points, face.triangles[own])
    edge = _edge(part)
    held = _measure(edge) - _measure(_edge(part, part.flange))
    pressure = _MILD if part.is_closed else _FIRM
    case: dict[str, Any] = {
        "title": f"{part.kind} of seed {part.seed}", "analysis": "onestep",
        "part": {"path": "part.stl", "element_size": 40.0, "symmetry": planes},  # the facets as they are
        "blank": {"material": part.material, "thickness": part.thickness},
        "process": {"holder_force": float(f"{pressure * held:.3g}"), "mu": 0.1},
    }  # fmt: skip
    path = folder / "onestep.toml"
    path.write_text(tomli_w.dumps(case))
    return path


def main() -> None:
    """Write the files of parts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=8)
    arguments = parser.parse_args()
    for seed in range(arguments.first, arguments.first + arguments.count):
        part = draw_part(seed)
        folder = arguments.folder / f"{part.kind}_{seed}"
        write_case(part, folder)
        write_onestep(part, folder)
        print(folder)


if __name__ == "__main__":
    main()
