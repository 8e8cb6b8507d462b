# SPDX-License-Identifier: Apache-2.0
"""Every kind of case sweeps, and the table holds what its kind is judged by."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
import tomli_w
import typer
from typer.testing import CliRunner

import presswork
from presswork import Case, CaseError, OneStepCase, OutputError, StampingCase
from presswork.cli import app
from presswork.cli.study.sweep import _report_members
from presswork.examples import copy_example
from presswork.post import measure_draw_in
from presswork.study import run_sweep
from presswork.study.sweep import SweepResult
from tests.problems.one_step import cup_profile, fan, revolve

STRIP = {
    "title": "strip in tension",
    "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 4, "material": "steel",
              "symmetry": ["x", "y"]},
    "materials": {"steel": {"young": 206e3, "poisson": 0.3,
                            "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
    "boundary": {"flat": {"set": "all", "fix": ["z"]}},
    "stages": [{"name": "pull", "velocity": 500.0,
                "displacement": [{"set": "right", "component": "x", "value": 1}]}],
    "output": {"rows": 10, "steps": 1},
}  # fmt: skip
"""Half of it is 10 mm long."""


def write(case: dict, path: Path) -> Path:
    path.write_text(tomli_w.dumps(case), encoding="utf-8")
    return path


@pytest.mark.validation
def test_a_stamping_sweeps_by_both_procedures_to_the_closed_form(tmp_path) -> None:
    """Uniaxial tension: the thickness strain is half the plastic strain along, and 0.3 of the elastic one."""
    case = write(STRIP, tmp_path / "strip.toml")
    vary = {"procedure": ["explicit", "implicit"], "stages.0.displacement.0.value": [0.5, 1.0]}
    swept = run_sweep(case, vary, tmp_path / "out", columns=["min:thickness_strain", "max:displacement"])
    assert swept.counts["completed"] == 4
    for row in swept.rows:
        pulled = row["stages.0.displacement.0.value"]
        strain = np.log(1 + pulled / 10)
        elastic = row["max_effective_stress"] / 206e3
        wanted = -(strain - elastic) / 2 - 0.3 * elastic
        assert row["min:thickness_strain"] == pytest.approx(wanted, rel=1e-2)
        assert row["max_thinning_percent"] == pytest.approx(100 * (1 - np.exp(wanted)), rel=1e-2)
        assert row["max:displacement"] >= pulled * 0.999


@pytest.mark.validation
def test_a_drawn_strip_has_force_draw_in_margin_and_springback_in_its_row(tmp_path) -> None:
    case = copy_example("draw_bending", tmp_path)
    settings = ["blank.element_size=[4,17.5]", "stages.0.tools.punch.stroke=8", "output.rows=20", "output.steps=2"]
    columns = ["max:springback", "max:punch.force", "last:punch.force", "min:forming_limit_margin"]
    swept = run_sweep(case, {"tools.punch.mu": [0.05, 0.3]}, tmp_path / "out", settings=settings, columns=columns)
    for member, row in zip(swept.members, swept.rows, strict=True):
        result = member.result
        force = result.history["punch.force"]
        assert row["punch.max_force"] == row["max:punch.force"] == force.max() > 0
        assert row["last:punch.force"] == row["punch.force"] == force[-1] == 0.0, "the tools are away"
        assert (
            row["max_springback"] == pytest.approx(row["max:springback"]) == result.summary["springback"]["largest_mm"]
        )
        assert [row["min_deviation"], row["max_deviation"]] == result.summary["springback"]["deviation_mm"]
        formed = result.field("forming_limit_margin", 2)
        assert row["min_forming_limit_margin"] == pytest.approx(formed.min()), "as formed, before it springs back"
        assert row["min:forming_limit_margin"] == pytest.approx(result.field("forming_limit_margin").min())
        drawn_in = measure_draw_in(result, 0.0, 2)
        assert row["max_draw_in"] == pytest.approx(drawn_in), "before springback, which moves the edge outwards"
        assert abs(drawn_in - measure_draw_in(result, 0.0, -1)) > 1e-3
    assert (tmp_path / "out/force_stroke.png").is_file()


@pytest.mark.validation
def test_heat_alone_sweeps(tmp_path) -> None:
    billet = copy_example("billet_cooling", tmp_path)
    settings = ["workpiece.mesh.cells=[3,6]", "solver.tolerance=50", "output.steps=1"]
    swept = run_sweep(billet, {"stages.2.duration": [5, 40]}, tmp_path / "out", settings=settings)
    hot, cold = swept.rows
    assert hot["min_temperature"] > cold["min_temperature"] > 20
    assert hot["max_temperature"] > cold["max_temperature"] > cold["min_temperature"]
    assert "max_equivalent_plastic_strain" not in hot


@pytest.mark.validation
def test_shells_and_impacts_sweep(tmp_path) -> None:
    roof = copy_example("scordelis_lo_roof", tmp_path)
    swept = run_sweep(
        roof, {"workpiece.section.thickness": [0.25, 0.5]}, tmp_path / "roof",
        settings=["workpiece.mesh.cells=[4,4]"], columns=["max:displacement"],
    )  # fmt: skip
    thin, thick = (row["max:displacement"] for row in swept.rows)
    assert thin > 2 * thick > 0
    bar = copy_example("taylor_bar", tmp_path)
    settings = ["workpiece.mesh.cells=[2,12]", 'stages.0.duration="10 us"', "output.rows=4", "output.steps=1"]
    speeds = {"workpiece.velocity": [[0, "-100 m/s"], [0, "-287 m/s"]]}
    swept = run_sweep(bar, speeds, tmp_path / "bar", settings=settings, columns=["max:temperature"])
    slow, fast = swept.rows
    assert fast["max:temperature"] > slow["max:temperature"] > 20
    assert fast["max_equivalent_plastic_strain"] > slow["max_equivalent_plastic_strain"] > 0


@pytest.fixture(scope="module")
def part(tmp_path_factory) -> Path:
    """A one-step case of a round cup."""
    folder = tmp_path_factory.mktemp("part")
    points, quads = revolve(cup_profile(25.0, 5.0, 12.0, 36.0, 4.0), 24)
    meshio.Mesh(points, [("triangle", fan(24)), ("quad", quads)]).write(folder / "cup.vtk")
    case = {
        "title": "cup",
        "analysis": "onestep",
        "part": {"path": "cup.vtk"},
        "blank": {"material": "numisheet93_mild_steel", "thickness": 0.8},
    }
    return write(case, folder / "part.toml")


def test_one_step_sweeps_and_its_completed_members_are_kept(part, tmp_path) -> None:
    vary = {"process.mu": [0.05, 0.2]}
    settings = ['process.holder_force="20 kN"']
    swept = run_sweep(part, vary, tmp_path / "out", settings=settings)
    easy, hard = swept.rows
    assert hard["punch.force"] > easy["punch.force"] > 10e3
    assert hard["max_thinning_percent"] > easy["max_thinning_percent"] > 0
    assert easy["blank_area"] == pytest.approx(swept.members[0].result.summary["blank"]["area_mm2"])
    kept = tmp_path / "out/member_000/summary.json"
    before = kept.stat().st_mtime_ns
    again = run_sweep(part, vary, tmp_path / "out", settings=settings, resume=True, columns=["max:thinning"])
    assert kept.stat().st_mtime_ns == before
    assert again.rows[0]["max:thinning"] == pytest.approx(easy["max_thinning_percent"]), "columns can be added later"
    with pytest.raises(OutputError, match="another case"):
        run_sweep(part, vary, tmp_path / "out", settings=["blank.thickness=1"], resume=True)


def test_one_step_runs_from_python(part, tmp_path) -> None:
    case = presswork.read_case(part)
    assert isinstance(case, OneStepCase)
    assert presswork.run(case, tmp_path / "out").result.summary["punch_force_kN"] > 10
    with pytest.raises(OutputError, match="nothing to resume"):
        presswork.run(case, tmp_path / "out", resume=True)


def test_a_case_of_another_kind_is_named_in_one_line(tmp_path) -> None:
    path = copy_example("square_cup", tmp_path)
    with pytest.raises(CaseError) as error:
        Case.from_toml(path)
    assert len(error.value.problems) == 1
    assert "presswork.read_case" in str(error.value)
    assert "StampingCase.from_toml" in str(error.value)
    assert isinstance(presswork.read_case(path), StampingCase)
    with pytest.raises(CaseError, match="did you mean `axisymmetric`"):
        Case.from_toml(copy_example("upsetting_q4", tmp_path), ["analysis=axisymetric"])


def test_a_sweep_of_a_stamping_says_what_is_wrong_with_it(tmp_path) -> None:
    path = copy_example("square_cup", tmp_path)
    done = CliRunner().invoke(app, ["sweep", str(path), "--vary", "tools.punch.diameter=50,51"])
    assert done.exit_code == 2
    assert "tools.punch.diameter" in done.output
    assert "plane_strain" not in done.output


@pytest.mark.parametrize(
    ("column", "told"),
    [
        ("max:thining", "did you mean `thinning`?"),
        ("max:stress_top", "stress_top has 6 components; name one, for instance stress_top_xx"),
        ("last:thinning", "last:thinning: the runs of this case have no thinning; "),
        ("last:incremnt", "did you mean `increment`?"),
        ("last:stage", "stage is not a number"),
    ],
)
def test_columns_that_no_member_will_have_are_told_before_anything_is_run(tmp_path, column, told) -> None:
    case = write(STRIP, tmp_path / "strip.toml")
    arguments = ["--vary", "procedure=implicit", "--output", str(tmp_path / "out"), "--column", column, "--quiet"]
    done = CliRunner().invoke(app, ["sweep", str(case), *arguments])
    assert done.exit_code == 2
    assert told in " ".join(done.output.split())
    assert not (tmp_path / "out").exists()


@pytest.mark.validation
def test_a_column_that_some_members_have_is_taken(tmp_path) -> None:
    """Only an explicit run tells its kinetic energy; the implicit one, which comes first, leaves the place empty."""
    case = write(STRIP, tmp_path / "strip.toml")
    vary = {"procedure": ["implicit", "explicit"]}
    implicit, explicit = run_sweep(case, vary, tmp_path / "out", columns=["last:kinetic_energy"]).rows
    assert implicit.get("last:kinetic_energy") is None
    assert explicit["last:kinetic_energy"] > 0


def test_a_column_that_no_member_has_is_told_once(capsys) -> None:
    faults = tuple(f"last:p: out/member_00{i} has no history column p; there are: time" for i in range(3))
    with pytest.raises(typer.Exit):
        _report_members(SweepResult(Path("out"), (), (), faults), quiet=True)
    told = " ".join(capsys.readouterr().err.split())
    assert told == "no column last:p: out/member_000 has no history column p; there are: time (so in 3 members)"


def test_a_column_in_no_form_is_refused_before_anything_is_run(tmp_path) -> None:
    case = write(STRIP, tmp_path / "strip.toml")
    arguments = ["--vary", "procedure=implicit", "--output", str(tmp_path / "out"), "--column", "largest thinning"]
    done = CliRunner().invoke(app, ["sweep", str(case), *arguments])
    assert done.exit_code == 2
    assert "write max:FIELD" in done.output
    assert not (tmp_path / "out").exists()
