# SPDX-License-Identifier: Apache-2.0
"""Choose what runs the members of a study."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from presswork.study.cluster.connection import Cluster
from presswork.study.processes import Processes
from presswork.study.runner import Runner


@contextmanager
def open_runner(
    jobs: int, cluster: Cluster | str | None, member_timeout: float | None, *, threads: int = 1
) -> Iterator[Runner]:
    """Provide processes of this machine, or the workers of a cluster as long as the block lasts.

    jobs: members at a time, 0 for one a core, on a cluster for one a thread of its workers. cluster: of its scheduler,
    or its address. member_timeout: longest time of a member [s]. threads: of each member, 0 for all there are. Raises
    ClusterError.
    """
    if cluster is None:
        yield Processes(jobs, member_timeout, threads)
        return
    from presswork.study.cluster.pool import open_cluster_pool

    with open_cluster_pool(
        Cluster(cluster) if isinstance(cluster, str) else cluster, jobs, member_timeout, threads
    ) as pool:
        yield pool
