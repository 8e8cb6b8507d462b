# SPDX-License-Identifier: Apache-2.0
"""Decks whose sheet has a past: thickness of its own, stresses, strains, in any frame, units and form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import CaseError, build_model, read_case
from presswork.cli import app
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.stamping import ImportedStamping, make_stamping
from presswork.deck.units import SYSTEMS
from presswork.mesh.checks import MeshError
from presswork.mesh.files.dynain import first_sides, read_dynain
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import FloatArray, Section
from tests.problems.dyna_deck import write_deck
from tests.unit.deck.test_dyna import QUARTERS

HEIGHTS = thickness_rule(Section(1.0, 3))[0]
ORDER = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))


def past(n: int, turn: FloatArray, *, is_large: bool, heights: FloatArray = HEIGHTS, history: int = 0) -> list[str]:
    """Return the cards of stresses and strains of n shells: known tensors, in the frame of a turned press."""
    width = 16 if is_large else 10
    number = f"{{:{width}.{width - 7}e}}".format

    def six(tensor: FloatArray) -> list[str]:
        turned = turn @ tensor @ turn.T
        return [number(turned[i, j]) for i, j in ORDER]

    lines = ["*INITIAL_STRESS_SHELL"]
    for cell in range(1, n + 1):
        lines.append(f"{cell:10d}{1:10d}{len(heights):10d}{history:10d}{0:10d}{int(is_large):10d}")
        for height in heights:
            row = [number(height), *six(stress(cell, height)), number(0.01 * cell)]
            lines += ["".join(row[:5]), "".join(row[5:])] if is_large else ["".join(row)]
            lines += ["".join([number(7.0)] * history)] if history else []
    lines.append("*INITIAL_STRAIN_SHELL")
    for cell in range(1, n + 1):
        lines.append(f"{cell:10d}{1:10d}{2:10d}{int(is_large):10d}")
        for height in (-1.0, 1.0):
            row = [*six(strain(cell)), number(height)]
            lines += ["".join(row[:5]), "".join(row[5:])] if is_large else ["".join(row)]
    return lines


def stress(cell: int, height: float) -> FloatArray:
    return np.array([[1.0 * cell, 20.0, 0.0], [20.0, -50.0, 0.0], [0.0, 0.0, 0.0]]) * (1.0 + height)


def strain(cell: int) -> FloatArray:
    return np.diag([1e-3 * cell, 2e-3, -3e-3])


def deck_with_past(turn: FloatArray | None = None, *, is_large: bool = True, own: bool = True, **options) -> str:
    """Return the deck of the cup, its blank with thickness cards, stresses and strains."""
    turn = np.eye(3) if turn is None else turn
    text = write_deck(turn)
    begin = text.index("*ELEMENT_SHELL\n")
    end = text.index("*PART", begin)
    shells = text[begin:end].split("\n")[1:-1]
    cards = ["*ELEMENT_SHELL_THICKNESS"]
    for number, shell in enumerate(shells, start=1):
        cards += [shell, 4 * f"{1.0 + 1e-3 * number:16.9e}"]
    text = text[:begin] + "\n".join(cards) + "\n" + text[end:]
    return text.replace(
        "*END", "\n".join([*(past(len(shells), turn, is_large=is_large, **options) if own else []), "*END"])
    )


def import_it(folder: Path, text: str) -> ImportedStamping:
    path = folder / "deck.k"
    path.write_text(text)
    notes = Notes(path)
    deck = DynaDeck(path, notes).read()
    notes.check()
    return make_stamping(deck, SYSTEMS["mm-t-s"], notes)


@pytest.mark.parametrize("turn", [np.eye(3), *QUARTERS.values()], ids=["upright", *QUARTERS])
@pytest.mark.parametrize("is_large", [True, False], ids=["long", "short"])
def test_stresses_strains_and_thickness_turn_with_the_press(tmp_path, turn, is_large) -> None:
    found = import_it(tmp_path, deck_with_past(turn, is_large=is_large))
    sheet = found.formed
    assert sheet is not None
    assert found.case["blank"] | {"path": "blank.dynain", "points": 3, "rule": "gauss"} == found.case["blank"]
    assert "blank.vtk" not in found.meshes
    n = len(sheet.cells)
    accuracy = 1e-8 if is_large else 2e-3
    for k, height in enumerate(HEIGHTS):
        expected = [[stress(cell, height)[i, j] for i, j in ORDER] for cell in range(1, n + 1)]
        np.testing.assert_allclose(sheet.stress[:, k], expected, rtol=accuracy, atol=100 * accuracy)
    np.testing.assert_allclose(sheet.plastic_strain[:, 1], 0.01 * np.arange(1, n + 1), rtol=accuracy)
    np.testing.assert_allclose(sheet.thickness, 1.0 + 1e-3 * np.arange(1, n + 1), rtol=1e-8)
    assert sheet.strain is not None
    np.testing.assert_allclose(sheet.strain[3], [4e-3, 2e-3, -3e-3, 0.0, 0.0, 0.0], atol=1e-2 * accuracy)
    np.testing.assert_allclose(np.abs(sheet.axis[:, 0]), 1.0, atol=1e-9)  # the rolling direction of the deck


def test_the_command_leaves_a_formed_sheet_that_a_run_begins_with(tmp_path) -> None:
    (tmp_path / "cup.k").write_text(deck_with_past(history=2))
    done = CliRunner().invoke(app, ["import", str(tmp_path / "cup.k")])
    assert done.exit_code == 0, done.output
    assert "history variables beyond the plastic strain (back stresses, damage) are left out" in done.output
    assert "a formed sheet (blank.dynain): 144 shells of 1.001 to 1.144 mm, stresses in 3 layers" in done.output
    model = build_model(read_case(tmp_path / "cup" / "case.toml"))
    assert model.formed is not None
    assert model.formed.stress[9, 2, 0] == pytest.approx(stress(10, HEIGHTS[2])[0, 0], rel=1e-8)
    side, _ = first_sides(model.formed.points, model.formed.cells)
    assert side.shape == (144, 3)


def test_a_blank_of_several_thicknesses_is_a_sheet_without_stress(tmp_path) -> None:
    found = import_it(tmp_path, deck_with_past(own=False))
    assert found.formed is not None
    assert not found.formed.stress.any()
    assert np.ptp(found.formed.thickness) == pytest.approx(0.143)
    assert found.case["blank"]["points"] == 5


@pytest.mark.parametrize("last", [0.0, 1.2])
def test_a_triangle_of_a_dynain_has_the_mean_of_three_thicknesses(tmp_path, last) -> None:
    nodes = [(1, 0.0, 0.0), (2, 4.0, 0.0), (3, 0.0, 4.0)]
    rows = ["*NODE", *(f"{i:8d}{x:16.8f}{y:16.8f}{0.0:16.8f}" for i, x, y in nodes)]
    rows += ["*ELEMENT_SHELL_THICKNESS", "".join(f"{i:8d}" for i in (1, 1, 1, 2, 3, 3))]
    rows += [f"{1.2:16.8f}" * 3 + f"{last:16.8f}{0.0:16.8f}"]
    rows += ["*INITIAL_STRESS_SHELL", "".join(f"{i:10d}" for i in (1, 1, 2, 0, 0, 0))]
    rows += [f"{height:10.5f}" + f"{0.0:10.1f}" * 7 for height in (-0.57735, 0.57735)]
    path = tmp_path / "part.dynain"
    path.write_text("\n".join([*rows, "*END", ""]))
    np.testing.assert_allclose(read_dynain(path).thickness, [1.2])


BAD = {
    "no rule": (
        deck_with_past(heights=np.array([-0.9, 0.0, 0.9])),
        "stresses at -0.9, 0, 0.9 .*: the points of no rule",
    ),
    "another form": (
        deck_with_past().replace("*INITIAL_STRAIN_SHELL", "*INITIAL_STRAIN_SHELL_SET"),
        "a state of the formed sheet that is not read",
    ),
    "cut short": (deck_with_past().partition("*INITIAL_STRAIN")[0][:-200] + "\n*END\n", "cut short"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_past_that_cannot_be_carried_is_refused(tmp_path, name) -> None:
    text, message = BAD[name]
    with pytest.raises(CaseError, match=message):
        import_it(tmp_path, text)


def test_binary_files_are_refused_in_words(tmp_path) -> None:
    (tmp_path / "part.dynain").write_bytes(b"LSDA\0\1\2\3")
    with pytest.raises(MeshError, match="a binary file"):
        read_dynain(tmp_path / "part.dynain")
    (tmp_path / "deck.k").write_bytes(b"*KEYWORD\n*INCLUDE\npart.dynain\n")
    with pytest.raises(CaseError, match="a binary file; give the deck of LS-DYNA as text"):
        import_it(tmp_path, "*KEYWORD\n*INCLUDE\npart.dynain\n")
