# SPDX-License-Identifier: Apache-2.0
"""A stamping that ends with springback: what holds the part, what is recorded, checkpoint and resume."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

from presswork import Result
from presswork.case import StampingCase, build_model, read_case
from presswork.case.errors import CaseError
from presswork.cli import app
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.files.dynain import read_dynain
from presswork.model import Model, PrescribedDisplacement
from presswork.process.line.released_model import hold_rigidly, make_springback_model
from presswork.recorder import run_model
from presswork.view.all_plots import plot_all
from presswork.view.style import is_released
from tests.regression.whole_runs import assert_same_bits, run_to_end, stop_after

YOUNG, YIELD, THICKNESS, LENGTH = 206e3, 200.0, 1.0, 20.0
CURVATURE = 12 * YIELD / (YOUNG * THICKNESS)
"""Six times that of first yield [1/mm]."""
TANGENT = 0.1 * YOUNG


def bend(**changes: Any) -> dict[str, Any]:
    """Half a strip turned at its end about y; it hardens linearly, so that its curvature is uniform."""
    modulus = YOUNG * TANGENT / (YOUNG - TANGENT)
    return {
        "title": "strip bent and let go",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [2 * LENGTH, 2], "thickness": THICKNESS, "element_size": 2.0,
                  "material": "steel", "symmetry": ["x"], "points": 21, "rule": "lobatto"},
        "materials": {"steel": {"young": YOUNG, "poisson": 0.4999,
                                "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": modulus}}},
        "stages": [{"name": "bend", "duration": "5 ms", "ramp": "2.5 ms"}],
        "explicit": {"damping": 2e3},
        "springback": {"increments": 4, "tolerance": [-0.1, 0.1],
                       "sections": {"A": {"point": [0, 0], "to": [LENGTH, 0]}}},
        "output": {"rows": 20, "steps": 2, "checkpoint_every": 1},
        **changes,
    }  # fmt: skip


def turn_end(model: Model) -> Model:
    """Turn the end of a strip, which no case file has words for, about y alone.

    Free about z, where shells have no stiffness, the strip rolls over sideways: a roll of 1e-8 grows by 2e6 here.
    """
    turn = (PrescribedDisplacement("right", 4, CURVATURE * LENGTH), PrescribedDisplacement("right", 5, 0.0))
    return replace(model, stages=(replace(model.stages[0], prescribed=turn),))


def bend_model(**changes: Any) -> Model:
    """Its Model."""
    return turn_end(build_model(StampingCase.model_validate(bend(**changes))))


def moment(curvature: float) -> float:
    """Moment per width of a strip of uniaxial layers at first loading."""
    half, core = THICKNESS / 2, YIELD / (YOUNG * curvature)
    outside = YIELD * (1 - TANGENT / YOUNG) * (half**2 - core**2) + 2 / 3 * TANGENT * curvature * (half**3 - core**3)
    return 2 / 3 * YOUNG * curvature * core**3 + outside


@pytest.fixture(scope="module")
def bent(tmp_path_factory) -> Result:
    outcome = run_model(bend_model(), tmp_path_factory.mktemp("bend") / "out")
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def curvature_of(points: np.ndarray) -> float:
    """Curvature of the circle through nodes in the x-z plane, by least squares."""
    x, z = points[:, 0], points[:, 2]
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, z, np.ones_like(x)]), x**2 + z**2, rcond=None)
    return float(1 / np.sqrt(c + 0.25 * (a**2 + b**2)))


def test_a_bent_strip_keeps_the_curvature_of_the_closed_form(bent) -> None:
    """k - M(k)/E I, as in tests/verification/test_transfer.py, from case file to results."""
    assert len(bent.times) == 4
    assert curvature_of(bent.points(2)) == pytest.approx(CURVATURE, rel=1e-3)
    kept = CURVATURE - moment(CURVATURE) / (YOUNG * THICKNESS**3 / 12)
    assert kept < 0.7 * CURVATURE
    assert curvature_of(bent.points(3)) == pytest.approx(kept, rel=2e-3)


def test_a_slice_between_two_planes_springs_back_in_plane_strain(tmp_path: Path) -> None:
    """Both planes stay. Incompressible: the strip's closed form with 4/3 of its moduli and 2/sqrt(3) of its stress."""
    case = bend(boundary={"slice": {"set": "top", "hold": "symmetry_y"}})
    case["blank"] |= {"symmetry": ["x", "y"], "size": [2 * LENGTH, 4]}
    case["blank"]["element_size"] = 2.0
    result = run_to_end(turn_end(build_model(StampingCase.model_validate(case))), tmp_path / "out")
    young, limit, tangent = 4 / 3 * YOUNG, 2 / np.sqrt(3) * YIELD, 4 / 3 * TANGENT
    half, core = THICKNESS / 2, limit / (young * CURVATURE)
    outside = limit * (1 - tangent / young) * (half**2 - core**2) + 2 / 3 * tangent * CURVATURE * (half**3 - core**3)
    kept = CURVATURE - (2 / 3 * young * CURVATURE * core**3 + outside) / (young * THICKNESS**3 / 12)
    assert curvature_of(result.points(3)) == pytest.approx(kept, rel=3e-3)


def test_what_is_recorded_of_springback(bent) -> None:
    """The last step holds the released part, with the way since the step before; the middle of the blank stays."""
    sprung = bent.field("springback", 3)
    np.testing.assert_allclose(sprung, bent.field("displacement", 3) - bent.field("displacement", 2), atol=1e-12)
    assert not bent.field("springback", 2).any()
    assert bent.summary["springback"]["largest_mm"] == pytest.approx(np.linalg.norm(sprung, axis=1).max())
    at = int(np.argmax(np.linalg.norm(sprung, axis=1)))
    assert bent.summary["springback"]["at_mm"] == pytest.approx(bent.points()[at]), "on the part that has sprung back"
    assert bent.summary["springback"]["at_blank_mm"] == pytest.approx(bent.mesh.points[at])
    assert bent.summary["springback"]["increments"] == 4
    middle = np.argmin(np.abs(bent.mesh.points[:, :2] - [0, 0]).sum(axis=1))
    np.testing.assert_allclose(sprung[middle, [0, 2]], 0.0, atol=1e-12)
    history = bent.history
    assert list(history["stage"][-5:]) == ["bend", *4 * ["springback"]]
    assert (np.diff(history["increment"]) == 1).all()
    assert (np.diff(history["internal_energy"])[-4:] < 0).all()
    assert history["kinetic_energy"][-1] == 0.0
    np.testing.assert_allclose(bent.field("eqps", 3), bent.field("eqps", 2), rtol=1e-6)
    assert bent.field("effective_stress", 3).max() < 0.7 * bent.field("effective_stress", 2).max()
    reaction = bent.field("reaction_force", 3)
    assert np.abs(reaction).max() < 1e-3


def test_a_section_turns_as_its_strip_straightens(bent) -> None:
    """Of z = (k - k0) s^2/2 the line of least squares over the length L has the slope (k - k0) L/2."""
    told = bent.summary["springback"]
    lost = moment(CURVATURE) / (YOUNG * THICKNESS**3 / 12)
    assert np.radians(told["sections"]["A"]["turn_degrees"]) == pytest.approx(0.5 * lost * LENGTH, rel=0.02)
    assert told["twist"]["degrees"] == pytest.approx(0.0, abs=1e-3)
    off = np.abs(bent.field("deviation", 3)) <= 0.1
    assert told["tolerance"]["share_within"] == pytest.approx(off.mean(), abs=0.1)


def test_a_sprung_part_is_exported_and_mapped_to_its_own_mesh(bent, tmp_path: Path) -> None:
    """The results have three of its layers, and the command says so."""
    files = [str(tmp_path / name) for name in ("part.k", "part.bdf", "part.stl")]
    done = CliRunner().invoke(app, ["export", str(bent.folder), *files])
    assert done.exit_code == 0, done.output
    assert "stresses in three of 21 layers" in " ".join(done.output.split())
    sheet = read_dynain(tmp_path / "part.k")
    np.testing.assert_allclose(sheet.points, bent.points(3), atol=1e-6)
    np.testing.assert_allclose(sheet.thickness, bent.field("thickness", 3), rtol=1e-8)
    np.testing.assert_allclose(sheet.stress[:, 2], bent.field("stress_top", 3), atol=1e-3)
    np.testing.assert_allclose(sheet.heights, [-1.0, 0.0, 1.0])
    own = CliRunner().invoke(app, ["export", str(bent.folder), str(tmp_path / "own.inp"), "--onto", files[1]])
    assert own.exit_code == 0, own.output
    assert "mapped to 10 of 10 shells" in own.output
    energy = re.search(r"([-+0-9.]+)% of the part's", own.output)
    assert energy is not None
    assert abs(float(energy[1])) < 1.0
    far = CliRunner().invoke(
        app, ["export", str(bent.folder), str(tmp_path / "own.inp"), "--onto", files[1], "--scale", "1000"]
    )
    assert far.exit_code == 2
    assert "no shell lies at the part" in far.output


def test_a_run_from_a_case_file_is_exported_with_all_its_layers(tmp_path: Path) -> None:
    """As the dynain of the same run has them."""
    pull = [{"name": "pull", "duration": "1 ms", "displacement": [{"set": "right", "component": "x", "value": 0.2}]}]
    (tmp_path / "pull.toml").write_text(tomli_w.dumps(bend(stages=pull)))
    found = run_to_end(build_model(read_case(tmp_path / "pull.toml", ["output.dynain=true"])), tmp_path / "out")
    (found.folder / "part.dynain").rename(tmp_path / "whole.dynain")
    done = CliRunner().invoke(app, ["export", str(found.folder), str(tmp_path / "part.k")])
    assert done.exit_code == 0, done.output
    assert "21 layers" in done.output
    one, other = read_dynain(tmp_path / "part.k"), read_dynain(tmp_path / "whole.dynain")
    np.testing.assert_array_equal(one.heights, other.heights)
    np.testing.assert_allclose(one.stress, other.stress, atol=1e-6)


def test_springback_is_drawn(bent, tmp_path) -> None:
    assert "shell_springback_003.png" in [p.name for p in plot_all(bent, tmp_path)]
    assert [is_released(bent, step) for step in range(4)] == [False, False, False, True]


@pytest.mark.parametrize("reports", [20, 22])
def test_a_run_stopped_before_or_within_springback_resumes_to_the_same_bits(bent, tmp_path: Path, reports) -> None:
    model = bend_model()
    stopped = run_model(model, tmp_path / "out", threads=1, on_increment=stop_after(reports))
    assert stopped.status == "interrupted"
    assert len(stopped.result.history["time"]) == reports
    assert run_model(model, tmp_path / "out", threads=1, resume=True).status == "completed"
    assert_same_bits(tmp_path / "out", bent.folder)


@pytest.mark.parametrize("symmetry", [[], ["x"], ["y"], ["x", "y"]])
@pytest.mark.parametrize("size", [[40, 30], [40, 2]])
def test_a_part_is_held_by_as_little_as_keeps_it_still(symmetry, size) -> None:
    """With the planes there are as many supports as rigid motions: not one more, which would bend the part."""
    pull = [{"name": "pull", "duration": "1 ms", "displacement": [{"set": "right", "component": "x", "value": 1}]}]
    case = bend(blank={**bend()["blank"], "symmetry": symmetry, "size": size}, stages=pull)
    model = build_model(StampingCase.model_validate(case))
    ImplicitProcedure(make_springback_model(model, model.mesh), threads=1)  # raises NotHeldError of a part free to move
    held = hold_rigidly(model.mesh.points, model.symmetry)
    assert sum(sum(fixed) for fixed in held.values()) == {0: 6, 1: 3, 2: 1}[len(symmetry)]


def test_springback_in_no_increments_is_refused() -> None:
    with pytest.raises(CaseError, match=r"springback\.increments"):
        StampingCase.model_validate(bend(springback={"increments": 0}))
