# SPDX-License-Identifier: Apache-2.0
"""Dies of runs: which instants are taken, what they bear, what is written, and what is refused."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import build_model
from presswork.case import CaseError
from presswork.case.plane.die_body import DieBody, read_bodies
from presswork.case.plane.schema import Case
from presswork.cli import app
from presswork.dies.study import study_die
from presswork.recorder import run_model
from presswork.results import Result, ResultError
from tests.problems.die_bodies import BODY, upset

RING = {"outer": 60.0, "interference": 0.02, "young": 210e3, "poisson": 0.3, "yield_stress": 1000.0}
HEAD = "[tools.punch.body]\n"


@pytest.fixture(scope="module")
def pressed(tmp_path_factory) -> Result:
    return upset(tmp_path_factory.mktemp("upset") / "run")


def build(**keys):
    return DieBody.model_validate(BODY | keys).build()


def test_the_column_of_the_largest_force_stands_below_it(pressed) -> None:
    study = study_die(pressed, "punch", build(), at=(1.0,))
    (now,) = study.instants
    assert now.step == len(pressed.times) - 1
    assert now.part == 1.0
    assert now.force[1] == pytest.approx(pressed.history["punch.force_y"][-1], rel=1e-9)
    (core,) = study.judge(now.answer)
    under = study.structure.profile[study.structure.points[study.structure.profile, 0] < 8.0]
    np.testing.assert_allclose(now.answer.stress[under, 1], -500.0, rtol=0.05)
    assert core.von_mises.value > 200.0
    assert core.safety_yield is core.safety_tension is None
    assert 1e-3 < study.find_deflection(now).value < 0.1


def test_instants_are_chosen_by_part_or_all(pressed) -> None:
    assert [now.part for now in study_die(pressed, "punch", build(), at=(0.5, 1.0)).instants] == [0.5, 1.0]
    every = study_die(pressed, "punch", build()).instants
    assert [now.step for now in every] == list(range(len(pressed.times)))
    assert not every[0].answer.stress.any(), "nothing presses at the start"


def test_a_die_in_plane_strain_carries_the_force_on_its_depth(tmp_path) -> None:
    wide = BODY | {"outer": 30.0, "top": 40.0, "clamped": ["top"]}
    result = upset(tmp_path / "run", "plane_strain", wide)
    study = study_die(result, "punch", DieBody.model_validate(wide).build(), at=(1.0,))
    (now,) = study.instants
    assert now.force[1] == pytest.approx(10.5 * 500.0 * 2 / 3**0.5, rel=0.01)
    stress = now.answer.stress[study.structure.profile]
    np.testing.assert_allclose(stress[:, 2], 0.3 * (stress[:, 0] + stress[:, 1]), atol=1e-6)


def test_the_safety_of_a_core_and_a_ring_is_that_of_what_they_bear(pressed) -> None:
    study = study_die(pressed, "punch", build(tensile_strength=100.0, yield_stress=400.0, rings=[RING]))
    core, ring = study.judge(study.joined)
    assert ring.safety_yield == pytest.approx(1000.0 / ring.von_mises.value)
    assert core.safety_tension == pytest.approx(100.0 / core.tension.value)
    assert ring.tension.place[0] == pytest.approx(40.0), "the bore of the ring is drawn most"
    assert not study.warnings


def test_a_ring_that_its_interference_alone_brings_to_yield_is_warned_of(pressed) -> None:
    body = build(rings=[RING | {"interference": 0.5}])
    (warning,) = study_die(pressed, "punch", body).warnings
    allowed = float(warning.split("at most ")[1].split(" mm")[0])
    assert "ring 1: the interference alone gives" in warning
    assert not study_die(pressed, "punch", build(rings=[RING | {"interference": 0.999 * allowed}])).warnings


def test_a_ring_that_is_not_pressed_on_lifts_off_and_is_warned_of(pressed) -> None:
    """Above the pressed face the core is drawn in; with interference it is held."""
    loose = study_die(pressed, "punch", build(rings=[RING | {"interference": 0.0}]))
    assert any("ring 1 lifts off" in text for text in loose.warnings)
    tight = study_die(pressed, "punch", build(rings=[RING | {"interference": 0.05}]))
    assert not tight.warnings
    joined, opened = tight.find_joint(tight.joined, 1)
    a, c, b, young = 0.0, 40.0, 60.0, 210e3
    lame = young * 0.05 / c * (c**2 - a**2) * (b**2 - c**2) / (2.0 * c**2 * (b**2 - a**2))
    assert joined == pytest.approx(lame, rel=1e-3)
    assert opened == 0.0


def test_a_tool_that_touches_nothing_is_refused(tmp_path) -> None:
    far = {"profile": [[20.0, 0.0], [20.0, 30.0]], "contact": "frictionless", "free_side": "left"}
    result = upset(tmp_path / "run", ring=far)
    with pytest.raises(ResultError, match="ring touches nothing at the 5 saved steps"):
        study_die(result, "ring", build(outer=40.0, top=None))


def test_what_does_not_fit_is_refused(pressed) -> None:
    with pytest.raises(ResultError, match="no tool 'die' in the plane; it has: punch"):
        study_die(pressed, "die", build())
    with pytest.raises(ResultError, match=r"tools.punch.body: the outline of the body does not match the profile"):
        study_die(pressed, "punch", build(outer=20.0))
    with pytest.raises(ResultError, match="nothing holds the part that holds the profile"):
        study_die(pressed, "punch", build(held=["right"]))
    with pytest.raises(ResultError, match="nothing holds ring 1"):
        study_die(pressed, "punch", build(rings=[RING | {"held": ["right"]}]))
    with pytest.raises(ResultError, match=r"--at 1\.5: give a part of the run from 0 to 1"):
        study_die(pressed, "punch", build(), at=(1.5,))


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("held = []", "tools.punch.body.held = []: nothing holds the body"),
        ("corners = [[0, 1]]\nouter = 3.0", "corners and outer are both given"),
        ("bottom = 1.0", "tools.punch.body.bottom = 1.0: has no meaning without outer"),
        ("outer = 9.0\nbottom = 2.0\ntop = 1.0", "the lower face is above the upper one"),
        ("rings = [{ outer = 3, young = 1e5, poisson = 0.3, held = [] }]", "nothing holds the ring"),
        ("rings = [{ outer = 3, young = 1e5, poisson = 0.3, interference = -1 }]", "expected a value >= 0"),
        ('held = ["under"]', "unknown choice"),
    ],
)
def test_a_body_that_is_wrong_is_refused_with_its_key(tmp_path, keys: str, message: str) -> None:
    path = tmp_path / "die.toml"
    held = "" if "held" in keys.split("rings")[0] else 'held = ["top"]\n'
    path.write_text(f"{HEAD}size = 1.0\nyoung = 210e3\npoisson = 0.3\n{held}{keys}\n")
    with pytest.raises(CaseError) as caught:
        read_bodies(path)
    assert message in str(caught.value)


def test_rings_in_plane_strain_are_refused_with_the_case(tmp_path) -> None:
    with pytest.raises(CaseError, match=r"tools.punch.body.rings: a ring closes round an axis"):
        upset(tmp_path / "run", "plane_strain", BODY | {"rings": [RING]})


def test_a_file_without_a_body_is_refused(tmp_path) -> None:
    path = tmp_path / "die.toml"
    path.write_text("[tools.punch]\n")
    with pytest.raises(CaseError, match=r"no tool has a body; add \[tools.punch.body\]"):
        read_bodies(path)
    path.write_text(f"{HEAD}size = 1.0\n")
    with pytest.raises(CaseError, match=r"tools.die.body: missing key; add \[tools.die.body\]"):
        read_bodies(path, ["die"])


def test_the_command_writes_a_table_and_a_picture_and_prints_what_holds(pressed) -> None:
    body = pressed.folder.parent / "die.toml"
    text = "size = 2.0\nouter = 40.0\ntop = 45.0\nheld = ['top']\nyoung = 210e3\npoisson = 0.3\nyield_stress = 250.0\n"
    ring = "[[tools.punch.body.rings]]\nouter = 60\ninterference = 0.02\nyoung = 210e3\npoisson = 0.3\n"
    body.write_text(f"{HEAD}{text}{ring}")
    done = CliRunner().invoke(app, ["dies", str(pressed.folder), "--body", str(body)])
    assert done.exit_code == 0, done.output
    assert "punch, joined: ring 1 von Mises" in done.output
    assert "punch, joined: ring 1 presses by" in done.output
    assert "punch: largest force (" in done.output
    assert "kN at 100 %, profile moved by" in done.output
    assert ": FAILS)" in done.output
    with (pressed.folder / "dies_punch.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["step"] for row in rows] == ["-1", "0", "1", "2", "3", "4"]
    largest = float(rows[-1]["core.von_mises_MPa"])
    assert float(rows[-1]["core.safety_yield"]) == pytest.approx(250.0 / largest, rel=1e-6)
    assert rows[0]["core.von_mises_MPa"] == rows[1]["core.von_mises_MPa"], "no load at the start"
    assert (pressed.folder / "plots" / "dies_punch.png").stat().st_size > 10_000


def test_the_command_refuses_a_run_whose_case_has_no_body(tmp_path) -> None:
    result = upset(tmp_path / "run", body=None)
    (result.folder / "case.toml").write_text("[tools.punch]\n")
    done = CliRunner().invoke(app, ["dies", str(result.folder)])
    assert done.exit_code == 2
    assert "no tool has a body" in done.output
    assert not Path(result.folder / "dies_punch.csv").exists()


def test_a_run_of_a_case_with_a_body_prints_whether_it_holds(tmp_path) -> None:
    """A body that does not fit is a warning, since the run itself is whole."""
    example = Path(__file__).parents[3] / "src/presswork/examples/upsetting_q4.toml"
    body = 'outer = {outer}\ntop = 45.0\nheld = ["top"]\nyoung = 210e3\npoisson = 0.3\nyield_stress = 1e4\n'
    for outer, expected in ((40.0, "punch: core von Mises "), (20.0, "warning: tools.punch.body: the outline of the")):
        case = tmp_path / f"upset_{outer:.0f}.toml"
        case.write_text(f"{example.read_text('utf-8')}\n{HEAD}size = 2.0\n{body.format(outer=outer)}")
        settings = ["--set", "stages.0.tools.punch.stroke=0.5", "--no-plot", "--no-report"]
        done = CliRunner().invoke(app, ["run", str(case), *settings])
        assert done.exit_code == 0, done.output
        assert expected in done.output
        assert (case.with_suffix("") / "dies_punch.csv").is_file() == (outer == 40.0)


def test_an_impact_has_the_contact_forces_of_its_explicit_run(tmp_path) -> None:
    example = Path(__file__).parents[3] / "src/presswork/examples/taylor_bar.toml"
    settings = ["workpiece.mesh.cells=[4,20]", "stages.0.duration=4e-6", "output.steps=4"]
    result = run_model(build_model(Case.from_toml(example, settings)), tmp_path / "run").result
    keys = {"outer": 20.0, "top": None, "bottom": -20.0, "held": ["bottom"], "size": 0.5}
    study = study_die(result, "anvil", build(**keys))
    for now in study.instants[1:]:
        np.testing.assert_allclose(now.force, -result.field("contact_force", now.step)[:, :2].sum(axis=0), rtol=1e-12)
    assert study.instants[-1].force[1] < -1e4
    assert now.answer.stress[:, 1].min() < -100.0


def test_a_case_may_have_a_body(tmp_path) -> None:
    example = Path(__file__).parents[3] / "src/presswork/examples/upsetting_4cst.toml"
    body = ["size=2", "outer=40", "top=45", 'held=["top"]', "young=210e3", "poisson=0.3"]
    case = Case.from_toml(example, [f"tools.punch.body.{key}" for key in body])
    assert case.tools["punch"].body is not None
