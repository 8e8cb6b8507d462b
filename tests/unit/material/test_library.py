# SPDX-License-Identifier: Apache-2.0
"""The material files that ship, a user's own, and what is wrong with one."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from presswork.case import build_model
from presswork.case.any_case import read_case
from presswork.case.case_file import write_as_run
from presswork.case.errors import CaseError
from presswork.case.material.forming_limit.build import build_curve
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.library import FOLDER
from presswork.case.material.sheet import check_sheet_material
from presswork.case.plane.schema import Case
from presswork.material import find_sheet, list_sheets, read_sheet
from presswork.material.hot_plot import draw_hot_law

EXAMPLES = FOLDER.parents[1] / "examples"
GUIDE = Path(__file__).parents[3] / "docs" / "howto" / "sheet_materials.md"
GOOD = (FOLDER / "numisheet93_mild_steel.toml").read_text("utf-8")


EVERYDAY = ("dc01", "dc03", "dc04", "dc05", "dx54", "hc340la", "dp600", "dp780", "dp980", "trip780", "stainless_304",
            "aa5182_o", "aa5754_o", "aa6014_t4", "aa6016_t4")  # fmt: skip


def test_library_has_the_everyday_grades_each_with_sources() -> None:
    sheets = list_sheets()
    assert set(EVERYDAY) <= {sheet.key for sheet in sheets}
    for sheet in sheets:
        assert sheet.sources or sheet.assumed
        least = 5 if isinstance(sheet.material.hardening, HotLaw) else 50
        assert sheet.material._usual_flow_stress(np.array([0.1]))[0] > least


HOT = (
    "42crmo4", "aa2024_t351_hot", "aa6082_hot", "aa7075_hot", "brass_cartridge", "c20_hot", "c45", "c45_hot",
       "copper_ofhc", "inconel_718", "medium_carbon_steel_hot", "steel_1006_hot", "steel_4340_hot", "ti6al4v",
)  # fmt: skip


@pytest.mark.parametrize("key", HOT)
def test_hot_grades_have_a_window_and_every_number_a_source(key: str, tmp_path: Path) -> None:
    named = find_sheet(key)
    assert isinstance(named.material.hardening, HotLaw)
    assert set(named.material.model_dump(exclude_none=True)) - {"yield_function", "magnitudes"} <= {
        *named.sources,
        *named.assumed,
    }
    assert "hardening" in named.sources
    assert "(19" in named.sources["hardening"] or "(20" in named.sources["hardening"]
    thermal = named.material.thermal
    assert thermal is None or named.material.density is not None
    assert draw_hot_law(named, tmp_path / "a.png").stat().st_size > 10_000


def test_published_flow_stresses_of_hot_grades() -> None:
    """By hand from the formulas in the papers named in the files."""

    def stress(key: str, strain: float, rate: float, degrees: float) -> float:
        law = find_sheet(key).material.build_law()
        return float(law.flow_stress(*(np.array([v]) for v in (strain, rate, degrees)))[0][0])

    copper = (90 + 292 * 0.3**0.31) * (1 + 0.025 * np.log(100)) * (1 - (280 / 1063) ** 1.09)
    assert stress("copper_ofhc", 0.3, 100.0, 300.0) == pytest.approx(copper, rel=1e-9)
    z = np.exp(153e3 / (8.314462618 * 723.15) - 19.29)
    assert stress("aa6082_hot", 0.3, 1.0, 450.0) == pytest.approx(np.arcsinh(z ** (1 / 2.976)) / 0.045, rel=1e-6)
    c45 = 2731.39 * np.exp(-2.68) * 0.5**0.31076 * np.exp(-0.00056 / 0.5) * 1.5**0.46 * np.exp(-0.98375 * 0.5)
    assert stress("c45_hot", 0.5, 1.0, 1000.0) == pytest.approx(c45, rel=1e-9)
    assert c45 == pytest.approx(111.1, abs=0.1)
    hensel = 5954 * np.exp(-3.3576e-3 * 1050) * 0.4**0.2641 * np.exp(2.2688e-4 / 0.4) * 1.4 ** (-4.2163e-4 * 1050)
    assert stress("medium_carbon_steel_hot", 0.4, 1.0, 1050.0) == pytest.approx(
        hensel * np.exp(-0.0561 * 0.4), rel=1e-9
    )


def test_a_solid_takes_a_material_of_the_library_with_its_heat() -> None:
    data = {
        "title": "a billet",
        "analysis": "axisymmetric",
        "workpiece": {"material": "aa6082_hot", "mesh": {"size": [20, 30], "cells": [2, 3]}},
        "heat": {"initial_temperature": 450},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "tools": {"die": {"profile": [[0, 30], [60, 30]], "contact": "frictionless"}},
        "stages": [{"name": "forge", "velocity": 10, "tools": {"die": {"stroke": 5, "direction": [0, -1]}}}],
    }
    (material,) = build_model(Case.model_validate(data)).materials
    assert material.name == "aa6082_hot"
    assert material.density == pytest.approx(2.7e-9)
    assert material.thermal is not None
    assert material.hardening.law == "sinh_arrhenius"
    hotter = {**data, "materials": {"aa6082_hot": {"library": "aa6082_hot", "young": "40 GPa"}}}
    assert build_model(Case.model_validate(hotter)).materials[0].young == 40e3
    cold = {k: v for k, v in data.items() if k != "heat"}
    cold["materials"] = {"aa6082_hot": {"library": "aa6082_hot", "heating": {"start": 450}}}
    assert build_model(Case.model_validate(cold)).materials[0].heating is not None
    wrong = {**data, "materials": {"aa6082_hot": {"library": "aa6083_hot"}}}
    with pytest.raises(CaseError, match="did you mean `aa6082_hot`"):
        Case.model_validate(wrong)


@pytest.mark.validation
def test_every_forming_limit_of_the_library_can_be_found() -> None:
    limits = [sheet for sheet in list_sheets() if sheet.material.forming_limit]
    assert len(limits) >= 3
    for sheet in limits:
        assert 0.05 < build_curve(sheet.material, sheet.thickness or 1.0).lowest()[1] < 0.6


def test_the_guides_material_file_can_be_read(tmp_path: Path) -> None:
    blocks = re.findall(r"```toml\n(.*?)```", GUIDE.read_text("utf-8"), re.DOTALL)
    path = tmp_path / "guide.toml"
    path.write_text(next(block for block in blocks if "[sources]" in block), encoding="utf-8")
    assert build_curve(read_sheet(path).material).method == "Keeler, t = 0.8 mm, n = 0.2589"


def test_a_users_file_is_found_by_its_path(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(GOOD.replace("1.79", "1.5"), encoding="utf-8")
    sheet = find_sheet(str(path))
    assert sheet.key == "mine"
    assert sheet.thickness == 0.78


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[sources]\nall", "[sources]\nyoung", ["material.poisson", "its source is missing"]),
        ('name = "', 'nam = "', ["nam", "did you mean `name`?", "name: expected a text"]),
        ("r00 = 1.79", "r00 = 0", ["material.yield_function.r00 = 0", "> 0"]),
        ("thickness = 0.78", "thickness = -1", ["thickness = -1", "from 0 to 100", "in mm"]),
        ("thickness = 0.78", f"thickness = 1{400 * '0'}", ["thickness", "1329 bits"]),
        ("[material]", "[materials]", ["materials: unknown key; did you mean `material`"]),
        ("[sources]\nall =", "[sources]\nall = 3 #", ["sources: expected a table of texts"]),
    ],
)
def test_faults_of_a_material_file_are_named(tmp_path: Path, old: str, new: str, words: list[str]) -> None:
    assert old in GOOD
    path = tmp_path / "mine.toml"
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        read_sheet(path)
    for word in words:
        assert word in str(caught.value), str(caught.value)


def test_a_file_without_a_material_says_what_belongs_there(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('name = "a"\nsummary = "b"\n', encoding="utf-8")
    with pytest.raises(CaseError, match="material: missing table; young, poisson"):
        read_sheet(path)


def test_an_unknown_material_is_suggested_the_nearest() -> None:
    with pytest.raises(CaseError, match="did you mean `aa6016_t4`"):
        find_sheet("aa6016t4")


@pytest.mark.parametrize("limit", ["swift_hill", "marciniak_kuczynski"])
def test_computed_limits_refuse_back_stresses(limit: str) -> None:
    material = find_sheet("numisheet93_mild_steel").material.model_dump()
    material |= {"kinematic": {"law": "chaboche", "C": [2000], "gamma": [20]}, "forming_limit": {"law": limit}}
    with pytest.raises(CaseError, match=rf"forming_limit\.law: {limit} is for isotropic hardening alone"):
        build_curve(check_sheet_material(material))


def test_imperfection_and_swift_hill_change_the_curve() -> None:
    material = find_sheet("numisheet93_mild_steel").material.model_dump()
    lowest = [
        build_curve(check_sheet_material(material | {"forming_limit": limit})).lowest()[1]
        for limit in (
            {"law": "marciniak_kuczynski", "imperfection": 0.999},
            {"law": "marciniak_kuczynski", "imperfection": 0.98},
            {"law": "swift_hill"},
            {"law": "points", "points": [[-0.1, 0.5], [0.0, 0.4]]},
        )
    ]
    assert lowest[1] < lowest[0] < lowest[2] < lowest[3] == 0.4


def test_a_material_without_a_forming_limit_says_how_to_add_one() -> None:
    with pytest.raises(CaseError, match=r"forming_limit: missing table; add \[material.forming_limit\]"):
        build_curve(find_sheet("aa1100_o").material)


@pytest.mark.parametrize(
    ("example", "part"),
    [("square_cup", "blank"), ("scordelis_lo_roof", "workpiece"), ("upsetting_q4", "workpiece"),
     ("gear_blank", "workpiece"), ("two_bodies", "bodies")],
)  # fmt: skip
def test_a_material_file_is_named_where_a_part_names_its_material(example: str, part: str, tmp_path: Path) -> None:
    """Directly, without a table, beside the case; and a copy of the case that runs elsewhere names the whole path."""
    (tmp_path / "mine.toml").write_text(GOOD.replace("206 GPa", "191 GPa"), encoding="utf-8")
    data = tomllib.loads((EXAMPLES / f"{example}.toml").read_text("utf-8"))
    body = data[part] if part != "bodies" else next(iter(data["bodies"].values()))
    body["material"] = "mine.toml"
    (tmp_path / "case.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    case = read_case(tmp_path / "case.toml")
    assert str(case.materials["mine"].young) == "191000.0"
    piece = getattr(case, part)
    assert (piece if part != "bodies" else next(iter(piece.values()))).material == "mine"
    assert str(tmp_path / "mine.toml") in write_as_run(data, tmp_path)
    (tmp_path / "mine.toml").unlink()
    with pytest.raises(CaseError, match=r"there is no material file .*mine\.toml"):
        read_case(tmp_path / "case.toml")
