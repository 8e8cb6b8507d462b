# SPDX-License-Identifier: Apache-2.0
"""A cluster of this machine: `python -m presswork.study.cluster.local THREADS`, until its standard input ends.

Prints its address as a line of JSON, with the certificate that a client needs: nobody else on this machine has it.
"""

from __future__ import annotations

import json
import sys

from distributed import LocalCluster
from distributed.security import Security


def main() -> None:
    """Start the cluster, print its address, and close it when nobody needs it any more."""
    security = Security.temporary()
    certificate = {name: getattr(security, name) for name in ("tls_ca_file", "tls_client_key", "tls_client_cert")}
    with LocalCluster(
        n_workers=1,
        threads_per_worker=int(sys.argv[1]),
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        protocol="tls",
        security=security,
    ) as cluster:
        print(json.dumps({"address": cluster.scheduler_address, "certificate": certificate}), flush=True)
        sys.stdin.buffer.read()


if __name__ == "__main__":
    main()
