# SPDX-License-Identifier: Apache-2.0
"""A small valid case, as data, and a way to write it to a file with changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from presswork.case import Case, CaseError, build_model

CASE = """
title = "A small upsetting"
analysis = "axisymmetric"

[workpiece]
material = "steel"
element = "tri3"

[workpiece.mesh]
kind = "rectangle"
size = [10, 15]
cells = [2, 3]
pattern = "crossed"

[materials.steel]
young = "200 kN/mm^2"
poisson = 0.3

[materials.steel.hardening]
law = "linear"
yield_stress = 700
modulus = "0.3 kN/mm^2"

[tools.punch]
profile = [[0, 15], [30, 15]]
contact = "sticking"

[boundary.axis]
set = "left"
fix = ["x"]

[boundary.middle_plane]
set = "bottom"
fix = ["y"]

[[stages]]
name = "upset"

[stages.tools.punch]
stroke = 9.0
direction = [0, -1]
"""


@pytest.fixture
def write_case(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes the case with pieces of its text replaced: (old, new) pairs."""

    def write(*changes: tuple[str, str]) -> Path:
        text = CASE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "case.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def fail_case(write_case: Callable[..., Path]) -> Callable[..., str]:
    """Return a function that reads and builds the changed case and returns the error's text."""

    def fail(*changes: tuple[str, str]) -> str:
        path = write_case(*changes)
        with pytest.raises(CaseError) as caught:
            build_model(Case.from_toml(path))
        text = str(caught.value)
        assert text.startswith(f"{path}: ")
        return text

    return fail
