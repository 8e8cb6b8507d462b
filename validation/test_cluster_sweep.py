# SPDX-License-Identifier: Apache-2.0
"""A sweep on a cluster whose workers are killed and cut off has the rows of the same sweep in processes."""

import pytest

from presswork.study import Cluster
from presswork.study.cluster.pool import open_cluster_pool
from presswork.study.runner import Ended, Task
from tests.problems.dask_cluster import dask_cluster
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


class Murderer:
    """What kills the worker that has it computed."""

    def __reduce__(self):
        return eval, ("__import__('os').kill(__import__('os').getppid(), 9)",)


def test_member_whose_workers_die_again_and_again_fails_and_names_them(tmp_path):
    with dask_cluster(tmp_path) as cluster:
        for _ in range(4):
            cluster.add_worker()
        with open_cluster_pool(Cluster(cluster.address), 0) as pool:
            pool._client.wait_for_workers(4, timeout=60)
            *_, end = pool.run({0: Task(Murderer(), tmp_path / "member_000", "new")})  # type: ignore[arg-type]
    assert isinstance(end, Ended)
    assert end.status == "failed"
    assert "3 workers died or were cut off while they computed it: tcp://127.0.0.1:" in end.reason
    assert not (tmp_path / "member_000").exists()
