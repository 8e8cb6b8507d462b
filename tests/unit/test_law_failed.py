# SPDX-License-Identifier: Apache-2.0
"""A law that finds no answer has the increment cut: a factor of 1 would try the same increment for ever."""

import pytest

from presswork import _core
from presswork.body.law_failed import LawFailed


@pytest.mark.parametrize("status", [s for s in _core.LawStatus if s.name not in ("done", "smaller")])
def test_every_failure_cuts_the_increment(status) -> None:
    fault = _core.LawFault()  # asks for no factor of its own
    assert fault.step_factor == 1.0
    found = LawFailed.of(0, type("Fault", (), {"cell": 3, "status": status, "step_factor": fault.step_factor})())
    assert found.factor < 1.0
