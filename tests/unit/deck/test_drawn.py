# SPDX-License-Identifier: Apache-2.0
"""Analytical rigid surfaces of Abaqus: profiles turned and swept, in parts and instances."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from presswork import CaseError
from presswork.deck.abaqus.drawn import read_drawn
from presswork.keyword_file import Place
from presswork.mesh.files.abaqus_blocks import Block
from tests.problems.abaqus_deck import TAIL, write_deck
from tests.problems.dyna_deck import DIE, NOSE, OPENING, PUNCH, SHOULDER, THICKNESS
from tests.unit.deck.test_abaqus import import_it

HALF = 0.5 * THICKNESS
PROFILES = {
    "punch": f"START, 0., {HALF}\nLINE, {PUNCH - NOSE}, {HALF}\n"
    f"CIRCL, {PUNCH}, {HALF + NOSE}, {PUNCH - NOSE}, {HALF + NOSE}\nLINE, {PUNCH}, {HALF + 30}",
    "holder": f"START, {OPENING}, {HALF + 20}\nLINE, {OPENING}, {HALF}\nLINE, {DIE + 15}, {HALF}",
    "die": f"START, {OPENING}, {-HALF - 40}\nLINE, {OPENING}, {-HALF - SHOULDER}\n"
    f"CIRCL, {OPENING + SHOULDER}, {-HALF}, {OPENING + SHOULDER}, {-HALF - SHOULDER}\nLINE, {DIE + 15}, {-HALF}",
}


def deck_of_drawn_tools(**changes: str) -> str:
    """Return the cup's deck with analytical tools, each turned about Y of its part, which stands along Z."""
    tail = TAIL
    for name in PROFILES:
        tail = tail.replace(f"Sheet, {name.capitalize()}\n", f"Sheet, {name}-1.Face\n")
    text = write_deck(tail=tail)
    for name, profile in (PROFILES | changes).items():
        part = (
            f"*Part, name={name}\n*Node, nset=Reference\n1, 0., 0., 0.\n"
            f"*Surface, type=REVOLUTION, name=Face\n{profile}\n"
            "*Rigid Body, ref node=Reference, analytical surface=Face\n*End Part"
        )
        text = re.sub(rf"\*Part, name={name}\n.*?\*End Part", part, text, flags=re.DOTALL)
        place = "0., 0., 0.\n0., 0., 0., 1., 0., 0., 90."
        old = rf"\*Instance, name={name}-1, part={name}\n.*?\*Surface, type=ELEMENT, name=\w+\n_{name}, SPOS"
        text = re.sub(old, f"*Instance, name={name}-1, part={name}\n{place}\n*End Instance", text, flags=re.DOTALL)
    return text


def test_tools_of_profiles_make_the_case_of_meshed_ones(tmp_path: Path) -> None:
    found, meshed = import_it(tmp_path, deck_of_drawn_tools()), import_it(tmp_path, write_deck())
    assert found.case["tools"] == meshed.case["tools"]
    assert found.case["stages"] == meshed.case["stages"]
    assert found.case["blank"] == meshed.case["blank"]
    tolerance = 1e-4 * np.hypot(45.0, 45.0) * 1.001
    for name in PROFILES:
        surface = found.meshes[f"{name}.stl"]
        r, z = np.hypot(surface.points[:, 0], surface.points[:, 1]), surface.points[:, 2]
        other = meshed.meshes[f"{name}.stl"].points
        np.testing.assert_allclose([r.max(), z.min(), z.max()], [np.hypot(other[:, 0], other[:, 1]).max(), *np.sort(
            [other[:, 2].min(), other[:, 2].max()])], atol=1e-9)  # fmt: skip
        middles = surface.points[surface.cells].mean(axis=1)
        if name == "punch":
            in_nose = (z > HALF + 1e-6) & (z < HALF + NOSE - 1e-6)
            np.testing.assert_allclose(np.hypot(r - PUNCH + NOSE, z - HALF - NOSE)[in_nose], NOSE, atol=1e-9)
            rise = np.hypot(np.hypot(middles[:, 0], middles[:, 1]) - PUNCH + NOSE, middles[:, 2] - HALF - NOSE)
            is_nose = (middles[:, 2] > HALF + 1e-6) & (middles[:, 2] < HALF + NOSE)
            assert (NOSE - rise[is_nose]).max() < 2.0 * tolerance  # of the arc, and around
            assert surface.points[:, 0].min() == pytest.approx(-PUNCH)


def test_profiles_may_stand_in_instances_of_empty_parts(tmp_path: Path) -> None:
    text = deck_of_drawn_tools()
    for name in PROFILES:
        begin, end = text.index(f"*Part, name={name}\n"), text.index("*End Part", text.index(f"*Part, name={name}\n"))
        content = text[begin:end].partition("\n")[2]
        text = text[:begin] + f"*Part, name={name}\n" + text[end:]
        place = text.index("*End Instance", text.index(f"*Instance, name={name}-1"))
        text = text[:place] + content + text[place:]
    found, other = import_it(tmp_path, text), import_it(tmp_path, deck_of_drawn_tools())
    assert found.case == other.case
    for name, surface in other.meshes.items():
        np.testing.assert_allclose(found.meshes[name].points, surface.points, atol=1e-9)


def surface_of(text: str, **parameters: str):
    return read_drawn(
        Block(
            "SURFACE", {key.replace("_", " "): value for key, value in parameters.items()}, Place("", 1), text.encode()
        )
    )


def test_a_swept_profile_reaches_past_the_sheet_along_its_generator() -> None:
    """The local y is x times the generator: points c = a - Y, profile (1, 2) lies at -Z."""
    surface = surface_of("0., 0., 5., 1., 0., 5.\n0., -1., 5.\nSTART, 1., 2.\nLINE, 4., 2.\n", TYPE="CYLINDER")
    sheet = np.array([[0.0, -30.0, 0.0], [0.0, 10.0, 0.0]])
    points, cells = surface.mesh(sheet, 0.01)
    np.testing.assert_allclose(points[:, 2], 3.0)
    np.testing.assert_allclose([points[:, 1].min(), points[:, 1].max()], [-34.0, 14.0])
    np.testing.assert_allclose(np.sort(np.unique(points[:, 0])), [1.0, 4.0])
    assert cells.tolist() == [[0, 1, 3, 2]]


def test_parabolas_pass_through_their_middle_and_arcs_go_the_short_way() -> None:
    surface = surface_of("START, 0., 0.\nPARAB, 1., 1., 2., 4.\nCIRCL, 4., 4., 3., 4.\n", TYPE="CYLINDER")
    with_parabola = surface.profile(1e-3)
    x, y = with_parabola[:17].T
    np.testing.assert_allclose(y, x**2, atol=1e-12)
    np.testing.assert_allclose(np.hypot(with_parabola[17:, 0] - 3.0, with_parabola[17:, 1] - 4.0), 1.0, atol=1e-12)


BAD = {
    "an arc whose ends": "START, 0., 0.5\nCIRCL, 10., 0.5, 4., 0.5",
    "not a piece of a profile": "START, 0., 0.5\nSPLINE, 10., 0.5",
    "START and at least one piece": "LINE, 0., 0.5",
    "beyond its axis": "START, -5., 0.5\nLINE, 10., 0.5",
}


@pytest.mark.parametrize("message", BAD)
def test_bad_profiles_are_named_with_their_line(tmp_path: Path, message: str) -> None:
    with pytest.raises(CaseError, match=rf"deck\.inp:\d+: \*(SURFACE|RIGID BODY): .*{message}"):
        import_it(tmp_path, deck_of_drawn_tools(punch=BAD[message]))


def test_profiles_in_the_plane_and_rounded_corners_are_refused(tmp_path: Path) -> None:
    text = deck_of_drawn_tools()
    with pytest.raises(CaseError, match=r"a profile in the plane \(TYPE=SEGMENTS\).*TYPE=CYLINDER or REVOLUTION"):
        import_it(tmp_path, text.replace("type=REVOLUTION", "type=SEGMENTS", 1))
    with pytest.raises(CaseError, match="give their arcs by CIRCL"):
        import_it(tmp_path, text.replace("type=REVOLUTION,", "type=REVOLUTION, fillet radius=2.,", 1))
    with pytest.raises(CaseError, match="there is no surface FAC; check its name"):
        import_it(tmp_path, text.replace("analytical surface=Face", "analytical surface=Fac", 1))
