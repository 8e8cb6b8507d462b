# SPDX-License-Identifier: Apache-2.0
"""A sweep on a cluster whose workers are killed and cut off has the rows of the same sweep in processes."""

import pytest

from validation.cluster_sweep import COUNT, ENDLESS, read_rows, run_both

pytestmark = pytest.mark.validation


def test_killed_and_cut_off_workers_and_an_endless_member_cost_no_other_row(tmp_path):
    alone, swept = run_both(tmp_path)
    assert swept.counts == alone.counts == {"completed": COUNT - 1, "failed": 1}
    assert swept.members[ENDLESS].status == "failed"
    assert "not over after --member-timeout" in swept.members[ENDLESS].reason
    assert read_rows(swept.folder) == read_rows(alone.folder)
    for one, other in zip(alone.members, swept.members, strict=True):
        if one.number != ENDLESS:
            assert (one.folder / "history.csv").read_bytes() == (other.folder / "history.csv").read_bytes()
    assert not list(swept.folder.glob(".*"))
