# SPDX-License-Identifier: Apache-2.0
"""What the documents show works: the guide's case file, loads without tools, a workpiece that nothing holds."""

import re
from pathlib import Path

import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.interaction.supports import NotHeldError

ROOT = Path(__file__).parents[2]
MADE = re.compile(r"docs/(gallery|contributing|reference/(keys_\w+|fields|commands|python))\.md")
"""Pages that are made when the site is built; `tests/unit/test_site.py` finds dead links to them."""


def test_the_guides_case_file_runs(tmp_path) -> None:
    blocks = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "howto" / "case_file.md").read_text("utf-8"), re.DOTALL)
    path = tmp_path / "guide.toml"
    path.write_text(blocks[0], encoding="utf-8")
    outcome = run(Case.from_toml(path, overrides=["workpiece.mesh.cells=[4,4]"]), tmp_path / "out")
    assert outcome.status == "completed"
    again = Case.from_toml(tmp_path / "out" / "case.toml")
    assert again.workpiece.mesh.cells == (4, 4), "case.toml is the case as run"
    assert run(again, tmp_path / "out", resume=True).status == "completed"


def test_the_example_with_a_die_from_a_file_runs(tmp_path) -> None:
    outcome = run(Case.from_toml(copy_example("curved_die", tmp_path)), tmp_path / "out")
    assert outcome.status == "completed"
    result = outcome.result
    assert result.history["punch.stroke"][-1] == pytest.approx(6.0)
    assert result.history["die.force_y"][-1] == pytest.approx(-result.history["punch.force_y"][-1], rel=1e-3)


def test_links_in_the_documents_lead_somewhere() -> None:
    for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text("utf-8")):
            goal = (page.parent / target).resolve()
            made = MADE.fullmatch(str(goal.relative_to(ROOT)))
            assert goal.exists() or made, f"{page.name}: {target}"


def test_programs_that_the_documents_run_are_there() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    pages += [path for folder in ("validation", "benchmarks", "examples") for path in (ROOT / folder).glob("*.py")]
    for page in pages:
        text = page.read_text("utf-8")
        named = [
            f"{name.replace('.', '/')}.py" for name in re.findall(r"python -m ((?:validation|benchmarks)\.\w+)", text)
        ]
        named += re.findall(r"(?:python|pytest) ((?:validation|benchmarks|examples|tests)/[\w/]+\.py)", text)
        for name in named:
            assert (ROOT / name).exists(), f"{page.name}: {name}"
        assert not re.search(r"python (validation|benchmarks)/", text), f"{page.name}: run it with python -m"


def case_without_tools(**stage) -> Case:
    return Case(
        title="no tools",
        analysis="plane_strain",
        workpiece={"material": "steel", "element": "quad4_fbar", "mesh": {"size": [10, 10], "cells": [4, 4]}},
        materials={"steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 700}}},
        boundary={"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "load", **stage}],
    )


@pytest.mark.parametrize(
    "stage",
    [
        {"pressure": [{"set": "top", "value": 300}]},
        {"force": [{"set": "top", "value": [0, 1000]}]},
        {"displacement": [{"set": "top", "component": "y", "value": -0.5}]},
    ],
)
def test_a_case_without_tools_runs(stage, tmp_path) -> None:
    assert run(case_without_tools(**stage), tmp_path / "out").status == "completed"


def test_a_workpiece_that_nothing_holds_is_refused_before_anything_is_computed(tmp_path) -> None:
    case = case_without_tools(pressure=[{"set": "top", "value": 300}]).model_copy(update={"boundary": {}})
    with pytest.raises(NotHeldError, match="nothing holds the workpiece in x and y"):
        run(case, tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "tool"), [("extrusion_cone", "ram"), ("extrusion_curved", "ram"), ("forging_flash", "die")]
)
def test_bulk_examples_begin_well(name, tool, tmp_path) -> None:
    """Their first increments, where contact with the whole die begins, without a node inside a tool."""
    case = Case.from_toml(copy_example(name, tmp_path))
    motion = case.stages[0].tools[tool]
    overrides = [f"stages.0.tools.{tool}.stroke={0.02 * motion.stroke}", "solver.max_increment=0.25", "output.steps=1"]
    overrides += ["solver.initial_increment=0.05"]
    outcome = run(Case.from_toml(tmp_path / f"{name}.toml", overrides), tmp_path / "out")
    assert outcome.status == "completed", outcome.reason
    assert outcome.result.history[f"{tool}.force"][-1] > 50e3
    assert outcome.result.summary["cutbacks"] <= 3
