# SPDX-License-Identifier: Apache-2.0
"""Material files: one sheet a TOML file, with the source of every number. Those that ship lie in material/data.

name = "..."            summary = "..."            thickness = 1.0 (optional, of the sheet that was tested [mm])
[material]              as in a case: young, poisson, yield_function, hardening
[sources]               key = "where the numbers under it come from"; "all" stands for every other key
[assumed]               key = "what was assumed and why" (optional)
"""

from __future__ import annotations

import difflib
import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationInfo

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.material.sheet import NamedLaws, check_sheet_material
from presswork.case.reader import read_toml
from presswork.case.units import fault

FOLDER = Path(__file__).parents[2] / "material" / "data"
ENDING = ".toml"
"""Ending of a material file; a name that ends so is a path."""
THICKEST = 100.0
"""Largest thickness of a sheet that was tested [mm]; more is a slip of units."""


@dataclass(frozen=True)
class NamedSheet:
    """A sheet material with its name and the sources of its numbers."""

    key: str
    """Name of the file without its ending."""
    name: str
    summary: str
    thickness: float | None
    """Thickness of the sheet that was tested [mm]."""
    material: NamedLaws
    sources: Mapping[str, str]
    """Where the numbers come from, by key."""
    assumed: Mapping[str, str]
    """What was assumed, by key."""


@functools.cache
def list_sheets() -> tuple[NamedSheet, ...]:
    """Read every material file that ships, by name of the file; once, since none changes while a program runs."""
    return tuple(read_sheet(path) for path in sorted(FOLDER.glob("*.toml")))


def list_keys() -> list[str]:
    """Return the names of the materials that ship."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def find_sheet(name: str, folder: Path | None = None) -> NamedSheet:
    """Read a material that ships by its key, or a user's file by its path, from `folder` on. Raises CaseError."""
    if name.endswith(ENDING):
        path = (folder or Path()) / name
        if not path.exists():
            fault = f"there is no material file {path}"
            raise CaseError([Problem("", fault, "its path is relative to the case file")], "materials")
        return read_sheet(path)
    if name not in list_keys():
        remedy = f"{suggest(name, list_keys(), 'materials')}; or the path of a file of your own, which ends with .toml"
        problem = Problem("", f"the library has no material `{name}`", remedy)
        raise CaseError([problem], "materials")
    return read_sheet(FOLDER / f"{name}.toml")


def take_named(data: object, info: ValidationInfo) -> NamedSheet | None:
    """Read the material that a table's key `library` names, from the folder of its case file on; None without one.

    Raises PydanticCustomError at the key.
    """
    if not (isinstance(data, dict) and isinstance(data.get("library"), str)):
        return None
    source = info.context.get("source") if isinstance(info.context, dict) else None
    try:
        return find_sheet(data["library"], Path(source).parent if source else None)
    except CaseError as error:
        wording = "; ".join(f"{problem}" for problem in error.problems)
        raise fault(wording, "`presswork materials` lists the library", key="library") from None


def add_library_materials(data: Mapping[str, Any], part: str = "workpiece") -> dict[str, Any]:
    """Return a case's data in which materials that a part names of the library, or by a file, are among the materials.

    part: the table that names a material, as other bodies do. A file's material gets the name of the file.
    """
    materials, bodies = data.get("materials", {}), data.get("bodies", {})
    if not isinstance(materials, Mapping):
        return dict(data)
    added: dict[str, Any] = {}
    changed = dict(data)
    if part in data:
        changed[part] = _name_materials(data[part], materials, added)
    if isinstance(bodies, Mapping) and bodies:
        changed["bodies"] = {name: _name_material(body, materials, added) for name, body in bodies.items()}
    return {**changed, "materials": {**materials, **added}} if added else changed


def _name_materials(piece: Any, materials: Mapping[str, Any], added: dict[str, Any]) -> Any:
    """Add the materials that a part and its zones take of the library or of files, as _name_material."""
    named = _name_material(piece, materials, added)
    zones = named.get("zones") if isinstance(named, Mapping) else getattr(named, "zones", None)
    if not isinstance(zones, list | tuple) or not zones:
        return named
    zones = [_name_material(zone, materials, added) for zone in zones]
    return {**named, "zones": zones} if isinstance(named, Mapping) else named.model_copy(update={"zones": tuple(zones)})


def _name_material(piece: Any, materials: Mapping[str, Any], added: dict[str, Any]) -> Any:
    """Add the material that a part takes of the library or of a file; return the part with the material's name."""
    name = piece.get("material") if isinstance(piece, Mapping) else getattr(piece, "material", None)
    if not isinstance(name, str) or name in materials:
        return piece
    if name in list_keys():
        added[name] = {"library": name}
    if not name.endswith(ENDING):
        return piece
    short = Path(name).stem
    while {**materials, **added}.get(short, {"library": name}) != {"library": name}:
        short += "_file"
    added[short] = {"library": name}
    return {**piece, "material": short} if isinstance(piece, Mapping) else piece.model_copy(update={"material": short})


def find_material_problem(key: str, name: str, materials: Iterable[str]) -> Problem | None:
    """Return the problem of a part at a key whose material is neither one of the case's nor of the library's."""
    own = sorted(materials)
    if name in own:
        return None
    near: list[str] = []
    for choices in (own, list_keys()):
        lowered = {choice.lower(): choice for choice in choices}
        found = difflib.get_close_matches(name.lower(), lowered, n=3, cutoff=0.5)
        near = near or [f"`{lowered[choice]}`" for choice in found]
    meant = f"did you mean {' or '.join(near)}? " if near else ""
    of_case = f"[materials] has {', '.join(own)}; " if own else ""
    remedy = (
        f"{meant}({of_case}`presswork materials` lists the library's, which need no table; a file of your own is named "
        "by its path, for instance my_steel.toml)"
    )
    return Problem(f"{key}.material", "no such material", remedy, name)


def read_sheet(path: Path) -> NamedSheet:
    """Read a material file. Raises CaseError with every problem found."""
    data, _ = read_toml(path)
    problems: list[Problem] = []
    known = {"name", "summary", "thickness", "material", "sources", "assumed"}
    for key in data:
        if key not in known:
            problems.append(Problem(key, "unknown key", suggest(key, known, "keys here")))
    name = _text(data, "name", "name of the sheet", problems)
    summary = _text(data, "summary", "one line that describes it", problems)
    thickness = data.get("thickness")
    if thickness is not None and not (type(thickness) in (int, float) and 0 < thickness <= THICKEST):
        problems.append(Problem("thickness", f"expected a thickness from 0 to {THICKEST:g}", "in mm", thickness))
    sources = _texts(data, "sources", problems)
    assumed = _texts(data, "assumed", problems)
    table: Any = data.get("material")
    material = None
    if isinstance(table, dict):
        try:
            material = check_sheet_material(table)
        except CaseError as error:
            problems.extend(
                Problem(f"material.{p.key}" if p.key else "material", p.expected, p.remedy, p.value)
                for p in error.problems
            )
        for key in table:
            if "all" not in sources and key not in sources and key not in assumed:
                remedy = (
                    'write it under [sources], or under [assumed] why it was assumed; all = "..." stands for every key'
                )
                problems.append(Problem(f"material.{key}", "its source is missing", remedy))
    else:
        problems.append(Problem("material", "missing table", "young, poisson, yield_function, hardening"))
    if problems or material is None:
        raise CaseError(problems, path)
    return NamedSheet(path.stem, name, summary, thickness, material, sources, assumed)


def _text(data: Mapping[str, Any], key: str, meaning: str, problems: list[Problem]) -> str:
    value = data.get(key)
    if isinstance(value, str) and value.strip():
        return value
    problems.append(Problem(key, "expected a text in quotes", f"{meaning}"))
    return ""


def _texts(data: Mapping[str, Any], key: str, problems: list[Problem]) -> dict[str, str]:
    value = data.get(key, {})
    if isinstance(value, dict) and all(isinstance(text, str) for text in value.values()):
        return value
    problems.append(Problem(key, "expected a table of texts", f"[{key}] with lines such as young = '...'"))
    return {}
