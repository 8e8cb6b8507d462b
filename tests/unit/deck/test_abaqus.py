# SPDX-License-Identifier: Apache-2.0
"""Decks of Abaqus: instances, sets, amplitudes over steps, Hill's ratios, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import CaseError
from presswork.case.material.yield_function import Hill1948
from presswork.deck.abaqus.materials import hill_of_ratios
from presswork.deck.abaqus.read import AbaqusDeck
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS
from presswork.mesh.files.abaqus_places import make_pose
from tests.problems import dyna_deck
from tests.problems.abaqus_deck import write_deck


def import_it(folder: Path, text: str, *accepted: str):
    path = folder / "deck.inp"
    path.write_text(text)
    notes = Notes(path, frozenset(accepted))
    deck = AbaqusDeck(path, notes).read()
    notes.check()
    return make_stamping(deck, SYSTEMS["mm-t-s"], notes)


def test_the_same_job_in_two_programs_decks_is_one_case(tmp_path) -> None:
    found = import_it(tmp_path, write_deck())
    path = tmp_path / "cup.k"
    path.write_text(dyna_deck.write_deck())
    notes = Notes(path)
    other = make_stamping(DynaDeck(path, notes).read(), SYSTEMS["mm-t-s"], notes)
    for key in ("blank", "tools"):
        assert found.case[key] == other.case[key]
    (stage,), (same,) = found.case["stages"], other.case["stages"]
    assert stage["tools"]["punch"]["stroke"] == pytest.approx(12.0)
    assert stage["tools"]["holder"] == same["tools"]["holder"]
    for name, surface in found.meshes.items():
        np.testing.assert_allclose(surface.points, other.meshes[name].points, atol=1e-6)
        np.testing.assert_array_equal(surface.cells, other.meshes[name].cells)
    assert found.case["materials"]["sheet"]["hardening"]["points"][:3] == [[0.0, 200.0], [0.1, 300.0], [0.5, 400.0]]


def test_an_instance_is_moved_and_then_turned() -> None:
    turn, shift = make_pose([["1.", "0.", "0."], ["0.", "0.", "0.", "0.", "0.", "2.", "90."]])
    np.testing.assert_allclose(turn @ [1.0, 0.0, 0.0] + shift, [0.0, 2.0, 0.0], atol=1e-12)
    turn, shift = make_pose([["0.", "0.", "0."], ["1.", "0.", "0.", "1.", "0.", "1.", "180."]])
    np.testing.assert_allclose(turn @ [0.0, 0.0, 5.0] + shift, [2.0, 0.0, 5.0], atol=1e-12)


def test_hills_ratios_are_those_of_the_yield_stresses() -> None:
    ratios = np.array([1.0, 1.05, 1.15, 1.02, 1.0, 1.0])
    values = {name: value for name, value in hill_of_ratios(ratios).items() if name != "law"}
    function = Hill1948(law="hill1948", **values).build()
    k = 1.02 / np.sqrt(3.0)  # R12 is a shear stress over the reference one over the root of three
    stress = np.array([[1.0, 0.0, 0.0], [0.0, 1.05, 0.0], [0.0, 0.0, k], [-1.15, -1.15, 0.0]])
    np.testing.assert_allclose(function.evaluate(stress)[0], 1.0, rtol=1e-12)


AXES = {
    "about the normal": ("0., 1., 0., -1., 0., 0.\n3, 0.", 90.0),
    "turned about the normal": ("1., 0., 0., 0., 1., 0.\n3, 30.", 30.0),
    "by default about axis 1, whose next one is projected": ("0., 0., 1., 1., 0., 0.", 0.0),
}


@pytest.mark.parametrize("name", AXES)
def test_an_orientation_is_the_rolling_direction_of_hills_function(tmp_path, name) -> None:
    rows, angle = AXES[name]
    text = write_deck()
    section, ratios = "*Shell Section, ", "*Potential\n1.,"
    assert section in text
    assert ratios in text
    text = text.replace(section, f"*Orientation, name=Roll\n{rows}\n{section}orientation=Roll, ")
    text = text.replace(ratios, "*Potential\n1.02,")
    case = import_it(tmp_path, text).case
    assert case["blank"].get("rolling_direction", 0.0) == pytest.approx(angle)
    # R11 scales the reference stress of the table along the rolling direction
    assert case["materials"]["sheet"]["hardening"]["points"][0] == [0.0, pytest.approx(1.02 * 200.0)]
    with pytest.raises(CaseError, match="there is no orientation ROLLED; check its name"):
        import_it(tmp_path, text.replace("orientation=Roll,", "orientation=Rolled,"))
    with pytest.raises(CaseError, match=r"\*ORIENTATION: axes of the material that differ from place to place"):
        import_it(tmp_path, text.replace("name=Roll\n", "name=Roll, system=CYLINDRICAL\n"))


STEPS = {
    "one after the other": (
        "*Step\n*Dynamic, Explicit\n, 1.\n*Boundary\npunch-1.Reference, 3, 3, -4.\n*End Step\n"
        "*Step\n*Dynamic, Explicit\n, 2.\n*Boundary\npunch-1.Reference, 3, 3, -10.\n*End Step\n",
        [4.0, 6.0],
    ),
    "back in the second": (
        "*Step\n*Static\n0.01, 1.\n*Boundary\npunch-1.Reference, 3, 3, -4.\n*End Step\n"
        "*Step\n*Static\n0.01, 1.\n*Boundary\npunch-1.Reference, 3, 3, 1.\n*End Step\n",
        [4.0, -5.0],
    ),
    "by an amplitude over the whole time": (
        "*Amplitude, name=Ramp, time=TOTAL TIME\n0., 0., 1., 0., 3., 1.\n"
        "*Step\n*Dynamic, Explicit\n, 1.\n*End Step\n*Step\n*Dynamic, Explicit\n, 2.\n"
        "*Boundary, amplitude=Ramp\npunch-1.Reference, 3, 3, -7.\n*End Step\n",
        [None, 7.0],
    ),
}


@pytest.mark.parametrize("name", STEPS)
def test_steps_come_to_strokes(tmp_path, name) -> None:
    steps, strokes = STEPS[name]
    contact = "*Surface Interaction, name=Oil\n*Contact Pair, interaction=Oil\nSheet, Punch\n"
    symmetry = "*Boundary\nSymmetry_x, XSYMM\nSymmetry_y, YSYMM\n"
    stages = import_it(tmp_path, write_deck(tail=symmetry + contact + steps)).case["stages"]
    found = [stage["tools"].get("punch", {}).get("stroke") for stage in stages]
    assert found == [None if stroke is None else pytest.approx(stroke, rel=1e-3) for stroke in strokes]


BAD = {
    "physics": (("*Output, field", "*Dload\nAll, GRAV, 9810."), r"deck\.inp:\d+ \*DLOAD: carries physics"),
    "an unknown set": (
        ("die-1.Reference, 1, 6", "die-1.Handle, 1, 6"),
        r"\*BOUNDARY: there is no set of nodes DIE-1\.HANDLE",
    ),
    "an unknown amplitude": (("amplitude=Speed, type", "amplitude=Sped, type"), "there is no amplitude SPED"),
    "an unknown surface": (("Sheet, Punch", "Sheet, Stamp"), r"\*CONTACT PAIR: there is no STAMP; check its name"),
    "an acceleration": (("type=VELOCITY", "type=ACCELERATION"), "prescribed by acceleration; give TYPE=DISPLACEMENT"),
    "a section without thickness": (
        ("material=Steel\n1.0, 5", "material=Steel\nthin, 5"),
        r"\*SHELL SECTION: could not",
    ),
    "no flow stress": (("200., 0.\n300., 0.1\n400., 0.5\n", ""), r"\*PLASTIC: the rows below it are cut short"),
    "no number": ((", 0.0073\n*Boundary", ", soon\n*Boundary"), r"\*DYNAMIC: could not convert string to float"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_said_in_a_case_is_named_with_its_line(tmp_path, name) -> None:
    (old, new), message = BAD[name]
    whole = write_deck()
    assert old in whole
    with pytest.raises(CaseError, match=message):
        import_it(tmp_path, whole.replace(old, new))
