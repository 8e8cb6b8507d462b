# SPDX-License-Identifier: Apache-2.0
"""Materials of the zones of a blank: each zone is judged by the forming limit of its own material and thickness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.material.forming_limit.build import build_formability, build_sheets
from presswork.case.material.laws import KeelerLimit, PointsLimit
from presswork.case.material.library import find_material_problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.shell.material import HeavyShellMaterial
from presswork.case.stamping.checks import THINNEST
from presswork.case.stamping.schema import StampingCase
from presswork.case.zones.schema import ZonedPart

Tables = Mapping[str, HeavyShellMaterial | UmatMaterial]
"""Materials of a case by name."""


@dataclass(frozen=True)
class Sheets:
    """Which of the Model's materials the zones of a blank are of."""

    of_zone: dict[int, int]
    """Index by the zone's number, 0 for the blank beside all of them."""
    judged: list[tuple[int, str, float]]
    """Materials that are judged beside the blank's: index, name in the case, thickness [mm], in the order of the index;
    those beyond the case's own are copies."""


def plan_sheets(materials: Tables, blank: ZonedPart) -> Sheets:
    """Return which material each zone is of: where the forming limit depends on thickness, each thickness has one."""
    names = list(materials)
    of_zone = {0: names.index(blank.material)}
    known = {_find_key(materials[blank.material], blank.material, blank.mean_thickness): of_zone[0]}
    used, judged, n = {blank.material}, [], len(names)
    for number, zone in enumerate(blank.zones, 1):
        name, thickness = zone.material or blank.material, zone.thickness or blank.mean_thickness
        key = _find_key(materials[name], name, thickness)
        if key not in known:
            index = n if name in used else names.index(name)
            n += name in used
            known[key] = index
            judged.append((index, name, thickness))
            used.add(name)
        of_zone[number] = known[key]
    return Sheets(of_zone, judged)


def _find_key(table: HeavyShellMaterial | UmatMaterial, name: str, thickness: float) -> tuple[str, float]:
    """Return what distinguishes one material of the Model from another."""
    limit = None if isinstance(table, UmatMaterial) else table.forming_limit
    depends = isinstance(limit, KeelerLimit) and limit.thickness is None
    depends |= isinstance(limit, PointsLimit) and limit.scaling != "none"
    return name, thickness if depends else 0.0


def build_zone_sheets(
    materials: Tables,
    blank: ZonedPart,
    sheets: Sheets,
    source: Path | None,
    run_user_code: bool,
    thickness_key: str = "blank.thickness",
) -> tuple[model.Material, ...]:
    """Return the Model's materials; thickness_key: as of build_sheets. Raises CaseError."""
    thickness = blank.mean_thickness
    made = list(build_sheets(materials, blank.material, thickness, source, run_user_code, thickness_key))
    names = list(materials)
    for index, name, thickness in sheets.judged:
        table, own = materials[name], made[names.index(name)]
        if not isinstance(table, UmatMaterial):
            try:
                own = replace(own, formability=build_formability(table, f"materials.{name}", thickness, thickness_key))
            except CaseError as error:
                raise CaseError(error.problems, source) from None
        if index < len(names):
            made[index] = own
        else:
            made.append(replace(own, name=f"{name} ({thickness:g} mm)"))
    return tuple(made)


def check_zones(case: StampingCase) -> list[Problem]:
    """Return the problems of zones that show without geometry."""
    return check_tables(case.blank, case.materials, "blank") or _check_together(case)


def check_tables(blank: ZonedPart, materials: Tables, part: str) -> list[Problem]:
    """Return the problems of the tables of zones; part: the blank's table in the case."""
    problems, names = [], [zone.name for zone in blank.zones]
    for index, zone in enumerate(blank.zones):
        key = f"{part}.zones.{index}"
        if zone.material is not None and (unknown := find_material_problem(key, zone.material, materials)):
            problems.append(unknown)
        if zone.name in names[:index]:
            problems.append(Problem(f"{key}.name", "two zones have this name", "give each its own", zone.name))
        if zone.thickness is not None and zone.thickness < THINNEST:
            fault, remedy = "thinner than any rolled metal", 'plain numbers are mm: 0.8, or "0.8 mm"'
            problems.append(Problem(f"{key}.thickness", fault, remedy, zone.thickness))
    return problems


def _check_together(case: StampingCase) -> list[Problem]:
    """Return the problems of what a blank of several thicknesses or materials cannot have beside it."""
    blank = case.blank
    if blank.is_uniform:
        return []
    key = "blank.zones" if blank.zones else "blank.thickness"
    word = "a welded blank" if blank.zones else "a rolled blank"
    problems = []
    if case.heat is not None:
        text, remedy = f"heat is not conducted in {word}", "leave [heat] out, or form one sheet of one thickness"
        problems.append(Problem(key, text, remedy))
    if case.gradients is not None:
        text = f"derivatives are not followed in {word}"
        problems.append(Problem("gradients", text, "leave them out, and vary the case by a study (sweep, optimise)"))
    if case.procedure == "explicit" and case.explicit.device != "cpu":
        text = f"a card does not compute {word}"
        problems.append(Problem("explicit.device", text, 'take "cpu"', case.explicit.device))
    return [*problems, *_check_laws(case)]


def _check_laws(case: StampingCase) -> list[Problem]:
    """Return the problems of materials that do not go together in one sheet."""
    first, problems = case.materials[case.blank.material], []
    for index, zone in enumerate(case.blank.zones):
        own = case.materials[zone.material or case.blank.material]
        key = f"blank.zones.{index}.material"
        if isinstance(own, UmatMaterial) or isinstance(first, UmatMaterial):
            text = "a material law from a library of its own forms no zones"
            problems.append(Problem(key, text, "give laws of [materials], or one sheet", zone.material or first))
            break
        if case.procedure == "implicit":
            continue
        for name in ("kinematic", "damage", "heating"):
            kinds = [_name_kind(getattr(table, name)) for table in (first, own)]
            if kinds[0] != kinds[1]:
                text = f"its {name} is another kind than that of the blank, {case.blank.material}"
                remedy = f'give both the same kind of {name}, or none, or take procedure = "implicit"'
                problems.append(Problem(key, text, remedy, zone.material))
    return problems


def _name_kind(table: object) -> object:
    """Return what two tables of materials must share: whether they are there, and their law."""
    return None if table is None else getattr(table, "law", getattr(table, "criterion", True))
