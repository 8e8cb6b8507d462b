# SPDX-License-Identifier: Apache-2.0
"""Every example, and every analysis by every procedure with every element, passes `check`, editor and notebook."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from typer.testing import CliRunner

from presswork.case import build_model, read_case
from presswork.cli import app
from presswork.examples import copy_example, list_examples
from presswork.model import ELEMENTS
from presswork.notebook import show_case
from presswork.server.drawing import check
from tests.mutants.kinds import KINDS
from tests.unit.case.round_cup import CUP, changed

STEEL: dict[str, Any] = {"young": "200 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
                         "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}  # fmt: skip
WARM = {"conductivity": "30 W/(m*K)", "specific_heat": "650 J/(kg*K)"}
PLANE: dict[str, Any] = {
    "title": "billet",
    "workpiece": {"material": "steel", "mesh": {"size": [10, 15], "cells": [2, 3]}},
    "materials": {"steel": STEEL},
    "tools": {"punch": {"profile": [[-5, 15], [30, 15]], "contact": "coulomb", "mu": 0.1}},
    "boundary": {"floor": {"set": "bottom", "fix": ["y"]}, "axis": {"set": "left", "fix": ["x"]}},
    "stages": [{"name": "press", "duration": "1 ms", "tools": {"punch": {"move": [0, -2]}}}],
}
SPACE: dict[str, Any] = {
    **PLANE,
    "analysis": "solid",
    "workpiece": {"material": "steel", "mesh": {"kind": "box", "size": [10, 10, 8], "cells": [2, 2, 2]}},
    "tools": {"punch": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 8], "contact": "coulomb",
                        "mu": 0.1}},
    "boundary": {"floor": {"set": "back", "fix": ["x", "y", "z"]}},
    "stages": [{"name": "press", "duration": "1 ms", "tools": {"punch": {"move": [0, 0, -2]}}}],
}  # fmt: skip
SHELL: dict[str, Any] = {
    "title": "strip",
    "analysis": "shell",
    "workpiece": {"material": "steel", "section": {"thickness": 1},
                  "mesh": {"size": [10, 10], "cells": [2, 2]}},
    "materials": {"steel": STEEL},
    "boundary": {"grip": {"set": "left", "hold": "clamped"}},
    "stages": [{"name": "pull", "force": [{"set": "right", "value": [1, 0, 0]}]}],
}  # fmt: skip
HEAT: dict[str, Any] = {
    "title": "billet in air",
    "analysis": "heat",
    "initial_temperature": 1200,
    "materials": {"steel": {"density": "7850 kg/m^3", **WARM}},
    "stages": [{"name": "air", "duration": 10, "convection": [{"set": "boundary", "coefficient": 0.1, "ambient": 20}]}],
}


def _solids() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield cases of a block with every element in every procedure that has it, cold and hot."""
    for name, row in ELEMENTS.items():
        if name.startswith("shell"):
            continue
        is_space = row.freedoms > 2
        for procedure in ("implicit", "explicit"):
            if not getattr(row, f"in_{procedure}"):
                continue
            for analysis in ("solid",) if is_space else ("plane_strain", "axisymmetric"):
                case = copy.deepcopy({**(SPACE if is_space else PLANE), "analysis": analysis, "procedure": procedure})
                case["workpiece"]["element"] = name
                yield f"{analysis} {procedure} {name}", case
                if procedure == "explicit":
                    flying = copy.deepcopy(case)
                    flying["workpiece"]["velocity"] = [0, 0, -1000][-3 if is_space else -2 :]
                    yield f"{analysis} {procedure} {name} flying", flying
                if name == "tet10":
                    continue  # conducts no heat
                hot = copy.deepcopy(case)
                hot["materials"]["steel"]["thermal"] = WARM
                hot["heat"] = {"initial_temperature": 900}
                yield f"{analysis} {procedure} {name} hot", hot


def _sheets() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield shells with every element, and cups by both procedures."""
    for name, row in ELEMENTS.items():
        if name.startswith("shell") and row.in_implicit:
            yield f"shell {name}", changed(SHELL, ("workpiece.element", name))
    cup = changed(CUP, ("materials.steel", STEEL))
    for name, row in ELEMENTS.items():
        if name.startswith("shell4") and row.in_explicit:
            yield f"stamping explicit {name}", {**cup, "explicit": {"element": name}}
    yield "stamping implicit", {**cup, "procedure": "implicit"}
    yield "stamping explicit springback", {**cup, "springback": {}}


def _heat() -> Iterator[tuple[str, dict[str, Any]]]:
    for geometry, mesh in (("plane", PLANE), ("axisymmetric", PLANE), ("solid", SPACE)):
        yield f"heat {geometry}", {**HEAT, "geometry": geometry, "workpiece": mesh["workpiece"]}


CASES = dict([*_solids(), *_sheets(), *_heat()])


@pytest.fixture(autouse=True)
def _build_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let editor and notebook share a Model: both build it alike, of equal cases."""
    built: dict[str, Any] = {}

    def build_once(case: Any, **options: Any) -> Any:
        key = f"{case.source} {options}"
        if key not in built:
            built[key] = build_model(case, **options)
        return built[key]

    for module in ("presswork.notebook", "presswork.server.drawing"):
        monkeypatch.setattr(f"{module}.build_model", build_once)


def show_everywhere(path: Path) -> str:
    """Check a case by command, in the editor's checker and in a notebook; return its description."""
    told = CliRunner().invoke(app, ["check", str(path)])
    assert told.exit_code == 0, told.output + str(told.exception)
    drawn = path.with_name("drawn")
    drawn.mkdir()
    found = check(path, drawn)
    assert not found["problems"]
    assert found["is_drawn"] or "onestep" in path.read_text(encoding="utf-8")
    shown = show_case(read_case(path))
    assert "<iframe" in shown or not found["is_drawn"]
    return str(found["description"])


@pytest.mark.parametrize("name", list_examples())
def test_every_example_is_described_everywhere(tmp_path: Path, name: str) -> None:
    words = show_everywhere(copy_example(name, tmp_path))
    assert words.startswith(list_examples()[name])


@pytest.mark.parametrize("name", CASES)
def test_every_kind_of_case_is_described_everywhere(tmp_path: Path, name: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(tomli_w.dumps(CASES[name]), encoding="utf-8")
    words = show_everywhere(path)
    assert ("explicit procedure" in words) == ("explicit" in name)
    if "hot" in name:
        assert "°C" in words


def test_a_part_for_one_step_is_described_everywhere(tmp_path: Path) -> None:
    KINDS["onestep case"].make(tmp_path)
    assert "pan" in show_everywhere(tmp_path / "case.toml")


def test_explicit_block_in_space_says_how_it_starts(tmp_path: Path) -> None:
    """Waves of 5856 m/s take 0.68 microseconds through the shortest edge, of 4 mm: the first step is nine tenths."""
    path = tmp_path / "case.toml"
    case = changed(SPACE, ("workpiece.element", "hex8_fbar"), ("workpiece.velocity", [0, 0, "-2 m/s"]))
    path.write_text(tomli_w.dumps({**case, "procedure": "explicit"}), encoding="utf-8")
    words = show_everywhere(path)
    assert "the workpiece starts at (0, 0, -2000) mm/s, density 7.85e-09 t/mm3" in words
    assert "time steps: about 6.1e-07 s at first" in words
