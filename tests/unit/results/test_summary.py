# SPDX-License-Identifier: Apache-2.0
"""summary.json is strict JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from presswork.results import write_summary


def test_numpy_and_non_finite_values_become_strict_json(tmp_path: Path) -> None:
    summary = {
        "status": "completed",
        "increments": np.int64(3),
        "extremes": {"stress": (np.float32(0.5), float("nan")), "force": np.array([1.0, np.inf])},
        "output": tmp_path,
        "reached_end": np.True_,
    }
    write_summary(tmp_path / "summary.json", summary)

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    assert json.loads((tmp_path / "summary.json").read_text(), parse_constant=refuse) == {
        "status": "completed",
        "increments": 3,
        "extremes": {"stress": [0.5, None], "force": [1.0, None]},
        "output": str(tmp_path),
        "reached_end": True,
    }


def test_former_summary_is_replaced(tmp_path: Path) -> None:
    write_summary(tmp_path / "summary.json", {"status": "running"})
    write_summary(tmp_path / "summary.json", {"status": "completed"})
    assert json.loads((tmp_path / "summary.json").read_text()) == {"status": "completed"}
    assert [path.name for path in tmp_path.iterdir()] == ["summary.json"]
