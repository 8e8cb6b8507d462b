# SPDX-License-Identifier: Apache-2.0
"""Slips of time in hot cases: a rate far outside the window of the law, by hand: stroke over height over time."""

from __future__ import annotations

from typing import Any

import pytest

from presswork.case import Case, build_model

LAW = {"law": "norton_hoff", "K": 200, "m": 0.2, "n": 0, "strain_window": [0.01, 1], "rate_window": [0.1, 50],
       "temperature_window": [800, 1200]}  # fmt: skip


def find_warning(caplog: pytest.LogCaptureFixture, **stage: Any) -> str:
    """Return the warnings of rates where a disc of 10 mm is upset by 3 mm."""
    caplog.clear()
    build_model(Case.model_validate({
        "title": "hot disc", "analysis": "axisymmetric",
        "workpiece": {"material": "m", "mesh": {"size": [10, 10], "cells": [2, 2]}},
        "materials": {"m": {"young": "100 GPa", "poisson": 0.35, "heating": {"start": 1000}, "hardening": LAW}},
        "tools": {"top": {"profile": [[-1, 10], [30, 10]], "contact": "frictionless"}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "press", "tools": {"top": {"stroke": 3, "direction": [0, -1]}}, **stage}],
    }))  # fmt: skip
    return next((record.getMessage() for record in caplog.records if "was fitted from" in record.getMessage()), "")


@pytest.mark.parametrize(("stage", "rate", "meant"), [
    ({"duration": 100}, "0.003 1/s", 'are "100 ms" meant?'), ({"velocity": 0.02}, "0.002 1/s", "mm/s"),
    ({"duration": 3e-4}, "1e+03 1/s", "plain numbers are s"),
])  # fmt: skip
def test_a_rate_far_outside_the_window_is_named_before_the_run(
    stage: dict[str, Any], rate: str, meant: str, caplog: pytest.LogCaptureFixture
) -> None:
    text = find_warning(caplog, **stage)
    assert text.startswith("stages.0: its tools travel 3 mm")
    assert rate in text
    assert meant in text


@pytest.mark.parametrize("duration", [20, 1, 0.001])
def test_a_rate_within_ten_times_of_the_window_is_not(duration: float, caplog: pytest.LogCaptureFixture) -> None:
    assert find_warning(caplog, duration=duration) == ""
