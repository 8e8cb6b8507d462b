# SPDX-License-Identifier: Apache-2.0
"""Connect to a cluster, or start one of this machine, and see that its workers can compute members."""

from __future__ import annotations

import gc
import json
import re
import subprocess
import sys
import tempfile
import uuid
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from presswork.results import OutputError
from presswork.results.whole_file import create_file
from presswork.study.processes import count_cores

if TYPE_CHECKING:
    from distributed import Client

LOCAL = "local"
_ADDRESS = re.compile(r"((tcp|tls|ucx|ws|wss)://)?[^/\s]+:\d{1,5}")
PATIENCE = 10.0
"""Seconds for a scheduler to answer, and for a first worker to be there."""
_MUST_AGREE = ("python", "presswork", "distributed")


class ClusterError(Exception):
    """The cluster cannot be used; the message holds the reason and the remedy."""


@dataclass(frozen=True)
class Cluster:
    """The cluster that computes the members of a study."""

    address: str
    """Address of its scheduler, `tcp://host:8786`; or `local`, for workers on this machine during the study."""
    bring_back: bool = False
    """Whether results are brought back from workers that do not see the folder."""
    on_dashboard: Callable[[str], None] | None = None
    """Gets the address of the dashboard once the cluster is there."""
    security: Any = None
    """Certificates for a scheduler at tls://: distributed.security.Security; None: those of Dask's configuration."""


@contextmanager
def connect(cluster: Cluster, jobs: int) -> Iterator[Client]:
    """Provide a client of the cluster, whose workers have been checked.

    jobs: threads of a local cluster's worker, 0 for one a core. Raises ClusterError.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise ClusterError('--cluster needs distributed: pip install "presswork[cluster]"') from error
    if cluster.address != LOCAL and jobs:
        raise ClusterError("--jobs does not go with the address of a cluster: the threads of its workers are the jobs")
    with _find_scheduler(cluster, jobs) as (address, security):
        gc.collect()  # a client that failed is finalised here: within the start of another it would wait for its lock
        try:
            client = Client(address, timeout=PATIENCE, set_as_default=False, security=security)
        except (OSError, TimeoutError, ValueError) as error:
            raise ClusterError(
                f"no scheduler answers at {address}: start one by `dask scheduler` and give the address that it "
                "prints, or take --cluster local"
            ) from error
        with client:
            _check_workers(client, address)
            if cluster.on_dashboard:
                cluster.on_dashboard(client.dashboard_link)
            yield client


@contextmanager
def _find_scheduler(cluster: Cluster, jobs: int) -> Iterator[tuple[str, Any]]:
    """Provide the address of the scheduler, which is started for `local`, and what a client shows it."""
    from distributed.security import Security

    address = cluster.address
    if address != LOCAL:
        if not _ADDRESS.fullmatch(address):  # a client would try it, and fail once more when it is finalised
            text = "an address has the form tcp://host:8786, as `dask scheduler` prints it; or take --cluster local"
            raise ClusterError(f"no scheduler answers at {address}: {text}")
        security = cluster.security or Security()
        if address.startswith("tls:") and security.get_connection_args("client")["ssl_context"] is None:
            text = "name it in Dask's configuration (distributed.comm.tls), or take Cluster(address, security=...)"
            raise ClusterError(f"the scheduler at {address} asks for a certificate: {text}")
        yield address, security
        return
    if find_spec("cryptography") is None:
        raise ClusterError('--cluster local needs cryptography: pip install "presswork[cluster]"')
    command = [sys.executable, "-P", "-m", "presswork.study.cluster.local", str(jobs or count_cores())]
    with (
        tempfile.TemporaryFile() as errors,
        subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            start_new_session=True,  # Ctrl-C in the terminal is for the study, which stops the members
        ) as process,
    ):
        assert process.stdout is not None
        line = process.stdout.readline()
        if not line:
            errors.seek(0)
            words = errors.read().decode(errors="replace").strip().splitlines()
            raise ClusterError(f"the local cluster did not start: {words[-1] if words else 'no reason given'}")
        answer = json.loads(line)
        yield answer["address"], Security(require_encryption=True, **answer["certificate"])


def _check_workers(client: Client, address: str) -> None:
    """Raise ClusterError if no worker is there, or one that is cannot compute members."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError as error:
        raise ClusterError(
            f"the scheduler at {address} has no workers: start some by `dask worker {address}`, or wait until those "
            "in the queue have started"
        ) from error
    versions = client.get_versions(packages=["presswork"])
    faults = find_unlike(versions["client"]["packages"], {w: v["packages"] for w, v in versions["workers"].items()})
    if faults:
        raise ClusterError("\n".join(faults))


def find_unlike(own: Mapping[str, Any], workers: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return what workers lack, or have in another version than this process, and the remedy, a text for each."""
    faults = []
    for name in _MUST_AGREE:
        wanted = _shorten(name, own[name])
        unlike = {worker: _shorten(name, there.get(name)) for worker, there in workers.items()}
        unlike = {worker: version for worker, version in unlike.items() if version != wanted}
        if not unlike:
            continue
        found = ", ".join(f"{version or 'none'} on {worker}" for worker, version in sorted(unlike.items())[:3])
        more = f" and {len(unlike) - 3} more workers" if len(unlike) > 3 else ""
        remedy = (
            f"start the workers with Python {wanted}"
            if name == "python"
            else f'install there: pip install "presswork[cluster]=={own["presswork"]}"'
            if name == "presswork"
            else f"install there: pip install distributed=={wanted}"
        )
        faults.append(f"workers need {name} {wanted}, as here, and have {found}{more}; {remedy}")
    return faults


def _shorten(name: str, version: str | None) -> str:
    """Return a version as far as it matters: of Python its first two numbers."""
    return ".".join((version or "").split(".")[:2]) if name == "python" else version or ""


def check_sight(client: Client, folder: Path) -> None:
    """Raise ClusterError if a worker does not see the folder, or must not write there."""
    from presswork.study.cluster.on_worker import holds_token

    words = uuid.uuid4().hex
    token = folder / f".token-{words}"
    try:
        with create_file(token) as file:
            file.write(words.encode())
        seen = client.run(holds_token, str(token), words)
    except OSError as error:
        raise OutputError(f"{folder} cannot be used as an output folder: {error.strerror or error}") from error
    finally:
        token.unlink(missing_ok=True)
    blind = sorted(worker for worker, sees in seen.items() if not sees)
    if blind:
        some = ", ".join(blind[:3]) + (f" and {len(blind) - 3} more" if len(blind) > 3 else "")
        raise ClusterError(
            f"workers cannot write to {folder} ({some}): choose a folder that all machines share, or add --bring-back, "
            "by which workers compute in folders of their own and send the results"
        )
