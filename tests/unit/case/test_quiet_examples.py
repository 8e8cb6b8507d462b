# SPDX-License-Identifier: Apache-2.0
"""No packaged example meets a check that looks for slips: their tools meet resistance, and their units fit."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from presswork import examples
from presswork.case import build_model, read_case
from presswork.case.onestep.schema import OneStepCase

FOLDER = Path(examples.__file__).parent
SLIPS = (
    "looks like",
    "slides along",
    "would move with the tool",
    "times the workpiece",
    "thinner than foil",
    "thick for a sheet",
    "elvin",
)


@pytest.mark.parametrize("name", sorted(examples.list_examples()))
def test_a_packaged_example_looks_like_no_slip(name: str, caplog: pytest.LogCaptureFixture) -> None:
    case = read_case(FOLDER / f"{name}.toml")
    assert not isinstance(case, OneStepCase)
    with caplog.at_level(logging.WARNING, logger="presswork"):
        build_model(case, run_user_code=False)
    assert not [slip for slip in SLIPS if slip in caplog.text]
