# SPDX-License-Identifier: Apache-2.0
"""Bodies in space in contact, and one that folds onto itself, from case files: results, threads, resume."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.model import CellBlock, Mesh
from presswork.process.mesh_change.laps import find_laps
from presswork.process.mesh_change.seams import Seams
from presswork.remesh.space.closing import find_closing_faces
from presswork.remesh.space.tetrahedra import find_skin
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, stop_at_fold
from tests.unit.remesh.space.bodies import mesh_box

LAWS = """
[materials.soft]
young = 70e3
poisson = 0.33
hardening = {law = "linear", yield_stress = 60, modulus = 100}
[materials.hard]
young = 210e3
poisson = 0.3
hardening = {law = "linear", yield_stress = 600, modulus = 500}
[solver]
initial_increment = 0.05
max_increment = 0.05
[output]
steps = 2
checkpoint_every = 3
"""
PUNCH = """
title = "a punch of hard metal is pressed into a soft block"
analysis = "solid"
[workpiece]
material = "soft"
mesh = {size = [6, 6, 4], cells = [6, 6, 3]}
[bodies.punch]
material = "hard"
mesh = {origin = [0, 0, 4], size = [2.9, 2.9, 2], cells = [2, 2, 2]}
[contacts.joint]
between = ["workpiece", "punch"]
contact = "coulomb"
mu = 0.1
[boundary]
x = {set = "left", fix = ["x"]}
y = {set = "bottom", fix = ["y"]}
z = {set = "back", fix = ["z"]}
punch_x = {set = "punch.left", fix = ["x"]}
punch_y = {set = "punch.bottom", fix = ["y"]}
[[stages]]
name = "press"
displacement = [{set = "punch.front", component = "z", value = -0.4}]
"""
CLAMP = """
title = "a clamp is pressed shut"
analysis = "solid"
[workpiece]
material = "soft"
[workpiece.mesh]
kind = "extruded"
outline = [[0, 0], [16, 0], [16, 4.25], [5, 4.25], [5, 5.75], [16, 5.75], [16, 10], [0, 10]]
element_size = 1.5
height = 1.5
cells = 1
[boundary]
floor = {set = "bottom", fix = ["x", "y", "z"]}
[[stages]]
name = "shut"
displacement = [{set = "top", component = "x", value = 0}, {set = "top", component = "y", value = -2.2}]
"""


def model_of(text, folder, more=""):
    path = folder / "case.toml"
    path.write_text(text + LAWS + more)
    return build_model(read_case(path))


def test_a_punch_pushes_as_hard_as_it_is_pushed(tmp_path) -> None:
    result = run_model(model_of(PUNCH, tmp_path), tmp_path / "out", threads=1).result
    history = result.history
    assert history["joint.force_z"][-1] == pytest.approx(history["z.force_z"][-1], rel=1e-5)
    assert history["joint.force_z"][-1] == pytest.approx(-history["punch.front.force_z"][-1], rel=1e-5)
    # three cells under half of the punch: at its edge gaps vanish in the mean alone
    assert abs(result.summary["energy"]["error_percent"]) < 2.0
    pressure, body = result.field("contact_pressure"), result.field("body")
    points = result.points(0)
    touched = (points[:, 2] == 4.0) & (points[:, :2].max(axis=1) < 1.5)
    assert touched.sum() == 2 * 2 + 2 * 2
    assert (pressure[touched] > 60.0).all()
    assert set(body) == {0, 1}
    # what both sides feel is the same force
    force = result.field("contact_force")
    assert force.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-6 * np.abs(force).sum())


def test_bodies_in_space_have_the_same_bits_after_a_resume_and_on_threads(tmp_path) -> None:
    model = model_of(PUNCH, tmp_path)
    assert run_model(model, tmp_path / "whole", threads=1).status == "completed"
    assert run_model(model, tmp_path / "threads", threads=3).status == "completed"
    seen = []

    def stop(progress):
        seen.append(progress)
        if len(seen) == 5:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "halves", threads=1, on_increment=stop).status == "interrupted"
    assert run_model(model, tmp_path / "halves", threads=1, resume=True).status == "completed"
    histories = [(tmp_path / name / "history.csv").read_bytes() for name in ("whole", "threads", "halves")]
    assert histories[0] == histories[1] == histories[2]


def heat_up(text):
    """Return the case of the punch with a cold punch on a hot block."""
    for old, more in (
        ('material = "hard"\n', "initial_temperature = 20\n"),
        ('name = "press"\n', "duration = 0.1\n"),
    ):
        text = text.replace(old, old + more)
    return text


HOT = """
[heat]
initial_temperature = 300
[contacts.joint.heat]
conductance = "10 kW/(m^2*K)"
gap = 0.1
[materials.soft.thermal]
conductivity = 200
specific_heat = "900 J/(kg*K)"
[materials.hard.thermal]
conductivity = 30
specific_heat = "500 J/(kg*K)"
"""


@pytest.mark.validation
def test_heat_between_bodies_in_space_has_the_same_bits_after_a_resume(tmp_path) -> None:
    path = tmp_path / "case.toml"
    laws = LAWS.replace("poisson = 0.33\n", 'poisson = 0.33\ndensity = "2700 kg/m^3"\n')
    laws = laws.replace("poisson = 0.3\n", 'poisson = 0.3\ndensity = "7800 kg/m^3"\n')
    path.write_text(heat_up(PUNCH) + laws + HOT)
    model = build_model(read_case(path))
    whole = run_model(model, tmp_path / "whole", threads=1)
    assert whole.status == "completed"
    temperature, body = whole.result.field("nodal_temperature"), whole.result.points(0)[:, 2] > 4.0
    assert temperature[body].max() > 35.0
    assert temperature.min() >= 20.0 - 1e-9
    seen = []

    def stop(progress):
        seen.append(progress)
        if len(seen) == 5:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "halves", threads=1, on_increment=stop).status == "interrupted"
    assert run_model(model, tmp_path / "halves", threads=1, resume=True).status == "completed"
    histories = [(tmp_path / name / "history.csv").read_bytes() for name in ("whole", "halves")]
    assert histories[0] == histories[1]


@pytest.mark.validation
def test_a_clamp_gets_contact_with_itself_and_goes_on_after_a_resume_with_the_same_bits(tmp_path) -> None:
    model = model_of(CLAMP, tmp_path)
    whole = run_model(model, tmp_path / "whole", threads=1)
    assert whole.status == "completed"
    log = (tmp_path / "whole" / "run.log").read_text()
    assert log.count("workpiece is about to fold onto itself near (") == 1
    # its jaws meet, and do not pass through each other
    points = whole.result.points(0)
    moved = whole.result.points()
    lower, upper = (moved[(np.abs(points[:, 1] - y) < 1e-9) & (points[:, 2] == 0.0)] for y in (4.25, 5.75))
    lower = lower[np.argsort(lower[:, 0])]
    gap = upper[:, 1] - np.interp(upper[:, 0], lower[:, 0], lower[:, 1])
    jaws = (upper[:, 0] > 8.0) & (upper[:, 0] < lower[-1, 0])
    assert np.abs(gap[jaws]).max() < 0.05

    parts = run_in_two_parts(model, tmp_path / "halves", stop_at_fold(tmp_path / "halves"))
    assert_same_bits(parts.folder, tmp_path / "whole")


@pytest.mark.validation
def test_a_clamp_of_tetrahedra_gets_new_meshes_after_it_has_folded(tmp_path) -> None:
    tetrahedra = CLAMP.replace('material = "soft"', 'material = "soft"\nelement = "tet4_mini"', 1)
    remesh = "\n[remesh]\nevery = 0.3\nsize = 1.5\nsmallest_size = 1.4\n"
    whole = run_model(model_of(tetrahedra.replace("-2.2", "-1.3"), tmp_path, remesh), tmp_path / "whole", threads=1)
    assert whole.status == "completed"
    log = (tmp_path / "whole" / "run.log").read_text()
    _, after = log.split("workpiece is about to fold onto itself near (")
    assert " remesh " in after  # the one that is due at 90 %
    assert whole.result.summary["volume"]["change_percent"] == pytest.approx(0.0, abs=0.1)


def test_a_lap_in_space_is_told_with_its_area() -> None:
    points, cells = mesh_box((2, 2, 2), (4.0, 3.0, 2.0))
    faces, _ = find_skin(cells)
    block = CellBlock("tet4_mini", cells.astype(np.int32), 0)
    mesh = Mesh(points, (block,), {}, {}, np.zeros((0, 2), np.int32), boundary_faces=faces.astype(np.int32))
    (lap,) = find_laps(mesh, points, (points[:, 2] == 2.0).astype(float), Seams())
    assert lap.extent == pytest.approx(12.0)
    assert lap.place == pytest.approx([2.0, 1.5, 2.0])


PLATES = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0.4], [1, 0, 0.4], [1, 1, 0.4], [0, 1, 0.4]], float
)
FACES = np.array([[0, 1, 2, 3], [7, 6, 5, 4]], dtype=np.int32)
"""The lower one looks up, the upper one down."""


@pytest.mark.parametrize(("speed", "closes"), [(-0.1, True), (-0.05, False), (0.1, False)])
def test_faces_close_that_approach_each_other_fast_enough(speed, closes) -> None:
    moves = np.zeros((8, 3))
    moves[4:, 2] = speed
    place = find_closing_faces(PLATES, moves, FACES)
    assert (place is not None) == closes
    if place is not None:
        assert place[:2] == pytest.approx([0.5, 0.5])


def test_the_two_sides_of_a_thin_plate_do_not_close() -> None:
    moves = np.zeros((8, 3))
    moves[4:, 2] = -0.1
    assert find_closing_faces(PLATES, moves, np.ascontiguousarray(FACES[:, ::-1])) is None
