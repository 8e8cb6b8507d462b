# SPDX-License-Identifier: Apache-2.0
"""The table knows every saved field by its name, and a row is all that an addition takes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import Case, ShellCase, StampingCase, build_model, run_model
from presswork.cli import app
from presswork.fields.field import LAMINA, TENSOR, VECTOR, Field
from presswork.fields.instant import Instant
from presswork.fields.table import (
    FIELDS,
    compute_field,
    compute_fields,
    describe_field,
    find_row,
    find_unit,
    list_fields,
    split_components,
    to_scalar,
)
from presswork.model import FloatArray
from presswork.study.measures import measure_run, parse_column
from tests.unit.case.round_cup import CUP, changed

STEEL = {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 500}}
BILLET: dict[str, Any] = {
    "title": "billet",
    "analysis": "axisymmetric",
    "workpiece": {"material": "steel", "element": "quad4_fbar", "mesh": {"size": [5, 6], "cells": [3, 3]}},
    "materials": {"steel": STEEL},
    "tools": {"punch": {"profile": [[9, 6], [0, 6]], "contact": "sticking"}},
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "stages": [{"name": "press", "tools": {"punch": {"stroke": 0.6, "direction": [0, -1]}}}],
    "output": {"steps": 2},
}


def _triaxiality(now: Instant) -> FloatArray | None:
    """Return the hydrostatic over the effective stress of solids, where there is any."""
    mean, effective = (compute_field(name, now) for name in ("hydrostatic_stress", "effective_stress"))
    if mean is None or effective is None:
        return None
    return np.divide(mean, effective, out=np.zeros_like(mean), where=effective > 0)


TRIAXIALITY = Field("stress_triaxiality", "1", "cell", _triaxiality, label="triaxiality of stress", alias="eta")


@pytest.fixture
def _added(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(FIELDS, TRIAXIALITY.name, TRIAXIALITY)


@pytest.mark.usefixtures("_added")
def test_added_field_is_saved_drawn_and_measured(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    result = run_model(build_model(Case.model_validate(BILLET)), folder, threads=1).result
    values = result.field("eta")
    np.testing.assert_array_equal(values, result.field("hydrostatic_stress") / result.field("effective_stress"))
    assert result.unit("stress_triaxiality") == "1"
    assert result.summary["fields"]["stress_triaxiality"]["smallest"]["value"] == pytest.approx(values.min())
    drawn = CliRunner().invoke(app, ["plot", str(folder), "--field", "eta", "--out", str(tmp_path)])
    assert drawn.exit_code == 0, drawn.output
    assert (tmp_path / "contours_eta_002.png").is_file()
    numbers, faults = measure_run(folder, result.summary, [parse_column("min:stress_triaxiality")])
    assert not faults
    assert numbers["min:stress_triaxiality"] == values.min()
    assert describe_field("eta") == "triaxiality of stress"
    assert any("stress_triaxiality" in line for line in list_fields())


def test_help_of_plot_lists_every_field(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "3000")
    text = CliRunner().invoke(app, ["plot", "--help"]).output
    for row in FIELDS.values():
        assert f"{row.name.format(row.each.upper())} ({row.unit})" in text or not row.unit


SHEET: dict[str, Any] = {
    "title": "sheet",
    "analysis": "shell",
    "workpiece": {"material": "steel", "element": "shell4_mitc", "section": {"thickness": 1},
                  "mesh": {"size": [4, 4], "cells": [2, 2]}},
    "materials": {"steel": STEEL},
    "boundary": {"clamp": {"set": "left", "fix": ["x", "y", "z", "rx", "ry", "rz"]}},
    "stages": [{"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 0.1}]}],
}  # fmt: skip
CUP_SHORT = changed(CUP, ("blank.element_size", 12), ("stages.0.tools.punch.stroke", 0.5))


@pytest.mark.parametrize(
    "case", [(Case, BILLET), (ShellCase, SHEET), (StampingCase, CUP_SHORT)], ids=lambda case: case[1]["title"]
)
def test_every_saved_field_has_a_row_unit_and_components(case: tuple[Any, dict[str, Any]], tmp_path: Path) -> None:
    kind, data = case
    result = run_model(build_model(kind.model_validate(data)), tmp_path / "out", threads=1).result
    for name, place in result.field_names.items():
        row = find_row(name)
        assert row is not None, name
        assert row.kind == place
        assert result.unit(name) == row.unit == find_unit(name)
        values = result.field(name)
        assert values.ndim == 1 or values.shape[1] == len(row.components)
        for title, column in split_components(name, values).items():
            np.testing.assert_array_equal(result.field(title), column)


def test_names_stand_for_layers_tools_and_numbers() -> None:
    assert find_row("stress_top") is FIELDS["stress_{}"]
    assert find_row("contact_traction_die") is FIELDS["contact_traction_{}"]
    assert find_row("SDV12") is FIELDS["SDV{}"]
    for unknown in ("stress_side", "SDVx", "stress_{}", "nothing"):
        assert find_row(unknown) is None
    assert describe_field("major_strain_top") == "major strain top"


def test_a_vector_is_one_number_and_a_tensor_is_none() -> None:
    values = np.array([[3.0, 4.0, 0.0]])
    assert to_scalar("displacement", values) == pytest.approx([5.0])
    assert to_scalar("lamina_stress_top", values) is None
    assert [*split_components("lamina_stress_top", values)] == [f"lamina_stress_top_{c}" for c in LAMINA]
    assert {row.components for row in FIELDS.values()} == {(), VECTOR, TENSOR, LAMINA}


def test_a_procedure_has_the_fields_of_what_it_shows() -> None:
    points, cells = compute_fields(Instant(None, np.ones((3, 2))))
    assert [*points] == ["displacement"]
    np.testing.assert_array_equal(points["displacement"], [[1, 1, 0]] * 3)
    assert not cells
    with pytest.raises(KeyError):
        compute_field("nothing", Instant(None, np.ones((3, 2))))
