# SPDX-License-Identifier: Apache-2.0
"""A cluster of this machine: `python -m presswork.study.cluster.local THREADS`, until its standard input ends.

Prints its address as a line of JSON.
"""

from __future__ import annotations

import json
import sys

from distributed import LocalCluster


def main() -> None:
    """Start the cluster, say where it is, and close it when nobody needs it any more."""
    with LocalCluster(n_workers=1, threads_per_worker=int(sys.argv[1]), dashboard_address=":0") as cluster:
        print(json.dumps({"address": cluster.scheduler_address}), flush=True)
        sys.stdin.buffer.read()


if __name__ == "__main__":
    main()
