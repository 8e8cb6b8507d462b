# SPDX-License-Identifier: Apache-2.0
"""One table of elements: case files, documents and procedures know no name that it has not."""

import re
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from presswork import CaseError, _core
from presswork.case.reader import read_toml
from presswork.case.shell.schema import ShellCase
from presswork.case.stamping.schema import StampingCase
from presswork.examples import copy_example
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import (
    ELEMENTS,
    ElementName,
    ExplicitElement,
    ShellElement,
    SolidElement,
    SpaceElement,
    list_names,
)

ROOT = Path(__file__).parents[2]
NAME = re.compile(r"`((?:tri|quad|hex|shell)\d(?:_\w+)?)`")
CELLS = {element.cell for element in ELEMENTS.values()}


def test_names_are_unique_and_begin_with_family_and_number_of_nodes() -> None:
    assert len(ELEMENTS) == len(_core.elements())
    for name, element in ELEMENTS.items():
        family = "shell" if element.family == _core.Family.shell else element.cell.rstrip("0123456789")
        assert name.startswith(f"{family}{element.nodes}")
        assert element.cell.endswith(str(element.nodes))
        assert element.in_implicit or element.in_explicit


def test_choices_of_case_files_are_the_table() -> None:
    families = {_core.Family.plane: SolidElement, _core.Family.shell: ShellElement}
    for family, choices in families.items():
        assert get_args(choices) == list_names(family, in_implicit=True)
    assert get_args(SpaceElement) == list_names(_core.Family.space)
    assert set(get_args(ExplicitElement)) == {"shell4_1pt", "shell4_mitc_plus"}
    assert set(get_args(ElementName)) == set(ELEMENTS)


@pytest.mark.parametrize("page", ["docs/theory/elements.md", "docs/theory/shells.md", "docs/howto/elements.md"])
def test_documents_name_only_elements_that_there_are(page) -> None:
    assert set(NAME.findall((ROOT / page).read_text())) - CELLS <= set(ELEMENTS)


def test_every_element_has_its_place_in_the_theory() -> None:
    pages = ("elements.md", "shells.md", "explicit_shells.md", "explicit_solids.md")
    text = "\n".join((ROOT / "docs/theory" / page).read_text() for page in pages)
    missing = [name for name in ELEMENTS if not re.search(rf"\b{name}\b", text)]
    assert not missing


@pytest.mark.parametrize("element", list_names(_core.Family.plane))
def test_the_explicit_loop_takes_the_elements_that_the_table_says(element) -> None:
    material = SolidMaterial(young=200e3, poisson=0.3, density=7.85e-9)
    mesh = mesh_rectangle(np.array([0.0, 1.0]), np.array([0.0, 1.0]), element=element)
    if ELEMENTS[element].in_explicit:
        ExplicitSolids(mesh, [material], axisymmetric=False)
    else:
        with pytest.raises(Exception, match="element"):
            ExplicitSolids(mesh, [material], axisymmetric=False)


def test_a_former_name_is_refused_with_the_one_that_stands(tmp_path) -> None:
    path = copy_example("square_cup", tmp_path)
    data, _ = read_toml(path)
    data.setdefault("explicit", {})["element"] = "shell4_one_point"
    with pytest.raises(CaseError, match="did you mean `shell4_1pt`"):
        StampingCase(**data)


def test_an_unknown_shell_is_refused_with_the_nearest(tmp_path) -> None:
    data, _ = read_toml(copy_example("scordelis_lo_roof", tmp_path))
    data["workpiece"]["element"] = "shell4_one_pt"
    with pytest.raises(CaseError, match="did you mean `shell4_1pt`"):
        ShellCase(**data)
