# SPDX-License-Identifier: Apache-2.0
"""5,000 crosses of the examples: no traceback, every message with file, key and remedy; remedies of 1,500 faults.

`PRESSWORK_CROSSES=N` reads N, `PRESSWORK_FIRST_CROSS=K` begins at K.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.mutants.crosses import read_cross, write_cross, write_files
from tests.mutants.remedies import try_remedies

pytestmark = pytest.mark.validation

COUNT = int(os.environ.get("PRESSWORK_CROSSES", "5000"))
FIRST = int(os.environ.get("PRESSWORK_FIRST_CROSS", "0"))


def test_crosses_are_described_or_refused_by_key_and_remedy(tmp_path: Path) -> None:
    write_files(tmp_path)
    case = tmp_path / "case.toml"
    faults = []
    for seed in range(FIRST, FIRST + COUNT):
        case.write_bytes(write_cross(seed))
        try:
            read_cross(case)
        except Exception as error:  # each is a fault, and all are wanted
            faults.append(f"{seed}: {type(error).__name__}: {error}")
    assert not faults, "\n".join(faults)


def test_remedies_that_messages_spell_out_help(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_files(tmp_path)
    tried = [try_remedies(tmp_path / "case.toml", seed) for seed in range(FIRST, FIRST + COUNT * 3 // 10)]
    with capsys.disabled():
        print(
            f"\n{sum(one.helped for one in tried)} remedies helped, {sum(one.left for one in tried)} need an engineer"
        )
    faults = [fault for one in tried for fault in one.faults]
    assert not faults, "\n".join(faults)
