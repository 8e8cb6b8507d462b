# SPDX-License-Identifier: Apache-2.0
"""The material files that ship, a user's own, and what is wrong with one."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from presswork.case.errors import CaseError
from presswork.case.material.forming_limit.build import build_curve
from presswork.case.material.library import FOLDER
from presswork.case.material.sheet import check_sheet_material
from presswork.material import find_sheet, list_sheets, read_sheet

GUIDE = Path(__file__).parents[3] / "docs" / "guide.md"
GOOD = (FOLDER / "numisheet93_mild_steel.toml").read_text("utf-8")


EVERYDAY = ("dc01", "dc03", "dc04", "dc05", "dx54", "hc340la", "dp600", "dp780", "dp980", "trip780", "stainless_304",
            "aa5182_o", "aa5754_o", "aa6014_t4", "aa6016_t4")  # fmt: skip


def test_library_has_the_everyday_grades_each_with_sources() -> None:
    sheets = list_sheets()
    assert set(EVERYDAY) <= {sheet.key for sheet in sheets}
    for sheet in sheets:
        assert sheet.sources or sheet.assumed
        assert sheet.material.build_law().flow_stress(np.array([0.1]))[0][0] > 50


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
        ("[sources]\nall", "[sources]\nyoung", ["material.poisson", "nothing says where it comes from"]),
        ('name = "', 'nam = "', ["nam", "did you mean `name`?", "name: expected a text"]),
        ("r00 = 1.79", "r00 = 0", ["material.yield_function.r00 = 0", "> 0"]),
        ("thickness = 0.78", "thickness = -1", ["thickness = -1", "> 0"]),
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
    with pytest.raises(CaseError, match=rf"forming_limit\.law: {limit} knows isotropic hardening alone"):
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
