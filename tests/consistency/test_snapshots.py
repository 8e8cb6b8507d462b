# SPDX-License-Identifier: Apache-2.0
"""What is saved of an instant does not change as the run goes on: it is written while the next is computed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.process.begin import begin

EXAMPLES = {
    "square_cup": ["blank.element_size=8"],
    "draw_bending": [],
    "hot_stamping_hat": [],
    "taylor_bar": [],
    "two_bodies": [],
    "hot_upsetting": [],
    "block_upsetting": [],
    "hot_disc": [],
}
"""One or more of every kind of process, and what makes it short."""


def find_arrays(of: Any, name: str = "") -> Iterator[tuple[str, np.ndarray]]:
    if isinstance(of, np.ndarray):
        yield name, of
    elif isinstance(of, dict | tuple | list):
        for key, value in of.items() if isinstance(of, dict) else enumerate(of):
            yield from find_arrays(value, f"{name}.{key}")


@pytest.mark.parametrize("example", EXAMPLES)
def test_a_snapshot_stays_as_it_was(example: str, tmp_path: Path) -> None:
    run = begin(build_model(read_case(copy_example(example, tmp_path), EXAMPLES[example])), 1)
    rows = run.advance()
    for _ in range(2):  # the undeformed state, then one on the way
        saved, points = run.snapshot(), run.mesh.points
        before = {name: values.copy() for name, values in find_arrays([vars(saved), points])}
        assert any("displacement" in name or "temperature" in name for name in before)
        for _ in range(2):
            next(rows)
            run.snapshot()
        for name, values in find_arrays([vars(saved), points]):
            np.testing.assert_array_equal(values, before[name], err_msg=name)
