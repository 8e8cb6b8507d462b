# SPDX-License-Identifier: Apache-2.0
"""Tables of sweeps for their page: names and units of columns, values of varied keys that are written with units."""

from __future__ import annotations

from pathlib import Path

import pytest

from presswork.examples import copy_example
from presswork.server.opened_folder import OpenedFolder, RefusedError
from presswork.server.sweeps import read_curves, read_sweep


def write_sweep(folder: Path, head: str, *rows: str, example: str = "square_cup") -> OpenedFolder:
    """Write a sweep's table, and the case of its first member."""
    member = folder / "sweep" / "member_000"
    member.mkdir(parents=True)
    copy_example(example, folder).rename(member / "case.toml")
    (folder / "sweep" / "table.csv").write_text("\n".join([head, *rows]) + "\n")
    return OpenedFolder(folder)


def test_columns_have_names_and_units_of_the_workshop(tmp_path: Path) -> None:
    head = "member,tools.punch.mu,blank.thickness,status,punch.stroke,punch.max_force,wall_seconds,max_thinning_percent"
    opened = write_sweep(tmp_path, head, "member_000,0.1,0.8,completed,20.0,40000.0,3.5,12.0")
    found = read_sweep(opened, "sweep")
    assert [(one["label"], one["unit"]) for one in found["heads"]] == [
        ("member", ""), ("punch mu", ""), ("blank thickness", "mm"), ("status", ""), ("punch stroke", "mm"),
        ("punch max force", "kN"), ("wall time", "s"), ("max thinning", "%"),
    ]  # fmt: skip
    assert found["varied"] == 2
    assert found["rows"] == [["member_000", 0.1, 0.8, "completed", 20.0, 40.0, 3.5, 12.0]]
    assert found["members"] == [None], "the member has no results"


def test_values_written_with_one_unit_are_numbers_of_it(tmp_path: Path) -> None:
    rows = [f"member_00{i},{force},completed" for i, force in enumerate(("10 kN", "15 kN", "2e1 kN"))]
    found = read_sweep(write_sweep(tmp_path, "member,stages.0.tools.holder.force,status", *rows), "sweep")
    assert (found["heads"][1]["label"], found["heads"][1]["unit"]) == ("holder force", "kN")
    assert [row[1] for row in found["rows"]] == [10.0, 15.0, 20.0]


def test_plain_numbers_of_any_form_are_numbers(tmp_path: Path) -> None:
    rows = [f"member_00{i},{force},completed" for i, force in enumerate(("2.0", "2e5", "-.5"))]
    found = read_sweep(write_sweep(tmp_path, "member,stages.0.tools.holder.force,status", *rows), "sweep")
    assert [row[1] for row in found["rows"]] == [2.0, 2e5, -0.5]
    assert found["heads"][1]["unit"] == "N", "that of the key in the schema"


def test_a_column_of_results_that_is_called_as_a_varied_key_is_told_from_it(tmp_path: Path) -> None:
    head = "member,stages.0.tools.punch.stroke,status,punch.stroke"
    found = read_sweep(write_sweep(tmp_path, head, "member_000,20,completed,19.5"), "sweep")
    assert [one["label"] for one in found["heads"]][1::2] == ["punch stroke", "punch stroke reached"]
    assert found["heads"][1]["unit"] == "mm", "that of the key in the schema"


def test_members_without_results_have_no_curve_and_other_folders_are_no_sweep(tmp_path: Path) -> None:
    opened = write_sweep(tmp_path, "member,status", "member_000,failed")
    assert read_curves(opened, "sweep") == {"charts": []}
    with pytest.raises(RefusedError, match="is not a sweep"):
        read_sweep(opened, "sweep/member_000")
