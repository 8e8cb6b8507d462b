# SPDX-License-Identifier: Apache-2.0
"""Drawbeads given by their geometry: forces found by a strip, kept beside the case, used by the stamping."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from presswork import CaseError, bead_forces
from presswork.api import build
from presswork.bead_forces import find_bead_forces
from presswork.case import build_model, read_case
from presswork.case.stamping.bead_strip import list_geometries, make_strip
from presswork.case.stamping.schema import StampingCase
from presswork.cli import app
from presswork.examples import copy_example
from presswork.model import Model
from presswork.outcome import StartError
from presswork.recorder import Outcome

BEAD = """
[[beads]]
points = [[-34, -34], [34, -34], [34, 34], [-34, 34]]
radius = 18
closed = true
geometry = {bead_radius = 5, groove_radius = 4, depth = 7}
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    path = copy_example("square_cup", tmp_path)
    path.write_text(path.read_text().replace("15 kN", "60 kN") + BEAD)
    return path


@pytest.fixture
def pulled(monkeypatch: pytest.MonkeyPatch) -> list[Model]:
    """The strips that are pulled, without being computed: 80 N/mm hold back, 70 N/mm close."""
    models: list[Model] = []

    def pull(model: Model, folder: str, **_: object) -> Outcome:
        models.append(model)
        return Outcome("completed", Path(folder))

    monkeypatch.setattr(bead_forces, "run_model", pull)
    monkeypatch.setattr(bead_forces, "measure_strip", lambda _: (80.0, 70.0))
    return models


def test_forces_are_found_once_and_kept_beside_the_case(case_file: Path, pulled: list[Model]) -> None:
    for _ in range(2):
        model = build(read_case(case_file))
        assert isinstance(model, Model)
        (bead,) = model.beads
        assert (bead.force, bead.closing_force, bead.is_sought) == (80.0, 70.0, False)
    assert len(pulled) == 1
    (row,) = json.loads(case_file.with_name("square_cup.beads.json").read_text()).values()
    assert (row["force"], row["bead_radius"], row["thickness"]) == (80.0, 5.0, 0.8)
    build(read_case(case_file, ["stages.0.tools.punch.stroke=10"]))
    assert len(pulled) == 1, "what the strip does not depend on"
    build(read_case(case_file, ["blank.thickness=0.9"]))
    build(read_case(case_file, ["beads.0.geometry.depth=6"]))
    build(read_case(case_file, ["materials.steel.hardening.K=600"]))
    assert len(pulled) == 4, "what it does depend on"
    case_file.with_name("square_cup.beads.json").write_text("{")
    build(read_case(case_file))
    assert len(pulled) == 5, "a damaged file keeps nothing"


def test_check_says_what_will_be_computed_and_computes_nothing(case_file: Path, pulled: list[Model]) -> None:
    told = CliRunner().invoke(app, ["check", str(case_file)])
    assert told.exit_code == 0, told.output
    assert "a force that a run first finds from its geometry, by pulling a strip through it" in told.output
    assert not pulled
    with pytest.raises(CaseError, match=r"beads.0.geometry: its forces have not been found yet; compute the case by"):
        build_model(read_case(case_file))
    build(read_case(case_file))
    told = CliRunner().invoke(app, ["check", str(case_file)])
    assert "80 N/mm, 70 N/mm to close it" in told.output


def test_bead_that_closes_too_hard_for_the_holder_is_refused(case_file: Path, pulled: list[Model]) -> None:
    with pytest.raises(
        CaseError, match=r"a force of 15000 N does not close the beads, which take 1\.\d+e\+04 N; .*shallower"
    ):
        build(read_case(case_file, ["stages.0.tools.holder.force=15 kN"]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("beads.0.force=50", "beads.0.force = 50: the geometry gives the forces; leave it out"),
        ("beads.0.geometry=", "beads.0.force: a bead needs a force"),
        ("beads.0.geometry.groove_width=9", "the bead does not go into its groove; more than 10 mm"),
        ("beads.0.geometry.depth=-1", "beads.0.geometry.depth = -1.0: expected a value > 0"),
        (
            "beads.0.geometry.radius=3",
            "radius = 3: unknown key; it is a key of beads.N and of tools.NAME (keys here: bead_radius",
        ),
    ],
)
def test_bad_geometries_are_refused(case_file: Path, change: str, words: str) -> None:
    with pytest.raises(CaseError) as refused:
        read_case(case_file, [change])
    assert words in str(refused.value)


def test_strip_that_cannot_start_is_told_by_the_key_of_the_bead(
    case_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> Outcome:
        raise StartError("nothing moves")

    monkeypatch.setattr(bead_forces, "run_model", refuse)
    with pytest.raises(CaseError, match=r"beads.0.geometry: nothing moves; change the geometry"):
        find_bead_forces(read_case(case_file))


def test_strip_is_that_of_the_example(case_file: Path, tmp_path: Path) -> None:
    case = read_case(case_file)
    example = read_case(copy_example("drawbead", tmp_path))
    assert isinstance(case, StampingCase)
    assert isinstance(example, StampingCase)
    strip = make_strip(case, list_geometries(case)[0][1])
    for name in ("punch", "die", "holder"):
        one, other = strip.tools[name], example.tools[name]
        assert (one.kind, one.edge_radius) == (other.kind, other.edge_radius)  # type: ignore[union-attr]
        assert one.width == pytest.approx(other.width, abs=0.1)  # type: ignore[union-attr]
    assert strip.stages[0].tools["punch"].stroke == 7.0
