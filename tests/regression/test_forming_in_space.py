# SPDX-License-Identifier: Apache-2.0
"""A solid in space between rigid tools, from its case file to the pictures: forces, resume, threads, bad input."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import CaseError, build_model, read_case, run_model
from presswork.case import whole_model
from presswork.case.description import describe
from presswork.case.space.schema import SpaceCase
from presswork.interaction.supports import NotHeldError
from presswork.view.all_plots import plot_all
from tests.problems.upset_block import describe_block

TEXT = describe_block(
    "mesh = {size = [10, 10, 7.5], cells = [3, 3, 3]}",
    7.5,
    0.3,
    "tools.die = {stroke = 3, direction = [0, 0, -1]}",
    anvil='contact = "frictionless"',
    tail="[output]\nsteps = 2\ncheckpoint_every = 3\n",
)


@pytest.fixture(scope="module")
def case(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("case") / "block.toml"
    path.write_text(TEXT)
    return path


@pytest.fixture(scope="module")
def whole(case, tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "whole"
    outcome = run_model(build_model(read_case(case)), folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome


def test_a_run_leaves_forces_of_the_whole_tool_and_pictures(whole, tmp_path) -> None:
    result = whole.result
    force = result.history["die.force"]
    assert result.history["die.stroke"][-1] == pytest.approx(3.0)
    np.testing.assert_allclose(result.history["anvil.force"], force, rtol=1e-6)
    area = 4 * 100 / 0.6  # by volume, if it stayed a block; friction with m = 0.3 adds to the flow stress
    flow = 565 * (0.007 + np.log(1 / 0.6)) ** 0.26
    assert 1.0 < force[-1] / (area * flow) < 1.3
    assert abs(result.summary["energy"]["error_percent"]) < 0.5
    assert result.summary["contact"]["largest_node_penetration_mm"] < 0.004  # a thousandth of a cell
    assert abs(result.summary["volume"]["change_percent"]) < 0.2
    points = result.points()
    assert points[:, 2].max() == pytest.approx(4.5, abs=0.003)
    assert set(result.surfaces) == {"die", "anvil"}
    force = result.field("contact_force")
    assert np.abs(force.sum(axis=0)[:2]).max() < 0.3 * 120e3, "friction points to the middle"
    shear, limit = result.field("contact_shear"), result.field("friction_limit")
    assert (shear <= limit * (1 + 1e-9)).all()
    on_anvil = points[:, 2] < 1e-2
    pressure = result.field("contact_pressure")[on_anvil]
    area = 4 * result.field("contact_force")[on_anvil, 2].sum() / result.history["anvil.force"][-1]
    assert area == pytest.approx(1.0, rel=1e-9)
    assert pressure.min() > 300.0
    assert pressure.max() < 1300.0
    pictures = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"solid_equivalent_plastic_strain_002.png", "force_stroke.png"} <= pictures
    assert "draw_in.png" not in pictures


def test_a_resumed_run_gives_the_same_bits_on_any_number_of_threads(case, whole, tmp_path) -> None:
    model = build_model(read_case(case))

    def interrupt(progress) -> None:
        if progress.fraction > 0.5:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "cut", threads=1, on_increment=interrupt).status == "interrupted"
    assert run_model(model, tmp_path / "cut", threads=2, resume=True).status == "completed"
    assert (tmp_path / "cut/history.csv").read_bytes() == (whole.folder / "history.csv").read_bytes()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (["tools.die.position=[0,0,7]"], "the tool starts inside the workpiece"),
        (["tools.die.normal=[0,0,0]"], "expected a direction that is not zero"),
        (["stages.0.tools.die.direction="], "missing key"),
        (["stages.0.tools.die.move=[0,0,-1]"], "move and stroke are both given"),
        (["tools.die.m="], "missing key"),
        (["tools.die.mu=0.1"], "has no meaning with contact"),
        (["tools.die.path=die.stl", 'tools.die.shape="file"', "tools.die.normal="], "die.stl"),
        (['boundary.x.fix=["x","y"]', "boundary.x.symmetry=true"], "not a symmetry plane"),
        (["stages.0.tools.dye.move=[0,0,-1]"], "no such tool"),
    ],
)
def test_bad_input_is_told(case, change, said) -> None:
    with pytest.raises(CaseError, match=said):
        build_model(read_case(case, change))


def test_a_round_tool_beside_a_symmetry_plane_is_refused(case) -> None:
    ball = {"shape": "round", "profile": [[0, 0], [3, 3]], "position": [2, 0, 7.5], "contact": "frictionless"}
    data = read_case(case).model_dump(exclude_unset=True)
    data["tools"]["die"] = ball
    with pytest.raises(
        CaseError, match=r"tools\.die\.position .* the symmetry plane x = 0 cuts this round tool beside"
    ):
        build_model(SpaceCase.model_validate(data))
    data["tools"]["die"] = ball | {"position": [0, 0, 7.5]}
    assert build_model(SpaceCase.model_validate(data)).tools[0].mirrored_across == (True, True, False)


def test_the_model_is_told_in_words(case) -> None:
    words = describe(build_model(read_case(case)))
    assert "tool die: plane with the normal (0, 0, -1), at (0, 0, 7.5) mm, shear, m = 0.3, whole tool mirrored" in words
    assert "tool die moves by (0, 0, -3) mm" in words


def test_a_block_that_nothing_holds_is_refused(case, tmp_path) -> None:
    smooth = ["boundary.x=", "tools.die.contact=frictionless", "tools.die.m="]
    with pytest.raises(NotHeldError, match="nothing holds the workpiece"):
        run_model(build_model(read_case(case, smooth)), tmp_path / "out")


@pytest.mark.parametrize(("element", "contact"), [("hex8_fbar", "coulomb"), ("tet4_mini", "shear")])
def test_multigrid_finds_what_factors_find_and_run_log_tells_its_iterations(tmp_path, element, contact) -> None:
    text = TEXT.replace('material = "steel"', f'material = "steel"\nelement = "{element}"')
    if contact == "coulomb":
        text = text.replace('contact = "shear"\nm = 0.3', 'contact = "coulomb"\nmu = 0.1')
    forces = {}
    for name in ("direct", "multigrid"):
        path = tmp_path / f"{name}.toml"
        path.write_text(f'{text}\n[solver]\nlinear_solver = "{name}"\ninitial_increment = 0.02\n')
        outcome = run_model(build_model(read_case(path)), tmp_path / name)
        assert outcome.status == "completed"
        assert outcome.result is not None
        forces[name] = outcome.result.history["die.force"]
    np.testing.assert_allclose(forces["multigrid"], forces["direct"], rtol=2e-4)
    log = (tmp_path / "multigrid" / "run.log").read_text()
    assert "smoothed aggregation" in log
    assert "linear iterations" in log
    assert "factors (" not in log
    assert "linear iterations" not in (tmp_path / "direct" / "run.log").read_text()


def test_a_closed_cavity_stops_a_run_and_says_how_much_of_the_surface_is_held(tmp_path, monkeypatch) -> None:
    """A quarter of a block 20 wide in a container 21 wide: full where the block is 10 (20 / 21)^2 = 9.07 mm high."""
    walls = "".join(
        f'[tools.{name}]\nshape = "plane"\nnormal = [{x}, {y}, 0]\nposition = [{-10.5 * x}, {-10.5 * y}, 0]\n'
        'contact = "frictionless"\n'
        for name, x, y in (("wall_x", -1, 0), ("wall_y", 0, -1))
    )
    mesh = 'element = "hex8_fbar"\nmesh = {size = [10, 10, 10], cells = [2, 2, 2]}'
    text = describe_block(mesh, 10, 0.0, "tools.die = {stroke = 2, direction = [0, 0, -1]}", tail=walls)
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(CaseError, match="the tools close on the workpiece"):
        build_model(read_case(path))
    monkeypatch.setattr(whole_model, "check_cavity", lambda _: [])
    outcome = run_model(build_model(read_case(path)), tmp_path / "out", threads=1)
    assert outcome.status == "gave_up"
    assert 10 - 10 * (20 / 21) ** 2 < outcome.result.history["die.stroke"][-1] < 1.4
    assert "the mean pressure in the workpiece is" in outcome.reason
    assert "tools and supports hold 100 % of the surface" in outcome.reason
    assert "The metal has no way out" in outcome.reason
