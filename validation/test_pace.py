# SPDX-License-Identifier: Apache-2.0
"""The time that `check` estimates of explicit runs beside the processor time that they take."""

from __future__ import annotations

from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

import pytest

from presswork.api import load, run
from presswork.examples import copy_example
from presswork.model import Model
from presswork.process.begin import check_start
from presswork.process.pace import estimate_seconds

EXAMPLES = (
    "square_cup", "trimmed_cup", "draw_bending", "hemispherical_punch", "welded_blank", "hot_stamping_hat",
    "tube_hydroforming", "press_line", "taylor_bar",
)  # fmt: skip


def _spent() -> float:
    return sum(u.ru_utime + u.ru_stime for u in (getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)))


@pytest.mark.validation
@pytest.mark.parametrize("name", EXAMPLES)
def test_the_estimate_is_within_a_factor_of_one_and_a_half(tmp_path: Path, name: str) -> None:
    model = load(copy_example(name, tmp_path))
    assert isinstance(model, Model)
    estimate = estimate_seconds(check_start(model))
    started = _spent()
    assert run(model, tmp_path / "run", threads=1).status == "completed"
    ratio = (_spent() - started) / (estimate or 0.0)
    print(f"{name}: {estimate:.3g} s estimated, {ratio:.2f} times that taken")
    assert 1.0 / 1.5 < ratio < 1.5
