# SPDX-License-Identifier: Apache-2.0
"""What workers do: each thread of a worker starts a member's process and passes on its messages.

A member is computed in a folder of its own, of a name that no other attempt has. Only the client puts what it accepts
into the member's place, so a worker that was given up for lost and goes on writing harms nothing.
"""

from __future__ import annotations

import io
import os
import shutil
import signal
import tarfile
import uuid
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Any

from distributed import Worker, get_worker

from presswork.study.member_process import MemberProcess, Mode, Work

_running: dict[str, list[MemberProcess]] = {}
_lock = Lock()


@dataclass(frozen=True)
class Order:
    """One member to be computed by whichever worker takes it."""

    study: str
    """Topic of the events that inform the client."""
    member: int
    job: bytes
    """The pickled case, or its Model."""
    mode: Mode
    folder: str
    """The member's place, where workers see it; else empty, and the results wait on the worker to be fetched."""
    archive: bytes
    """What the folder holds, where workers do not see it and a run is resumed: a tar file."""
    threads: int
    """Threads of the member; 0 for all of the worker."""
    seconds: float | None


def compute(order: Order) -> None:
    """Compute a member. Events report that it started, how far it is, and how it ended."""
    worker = get_worker()
    attempt = uuid.uuid4().hex[:8]

    def send(**words: object) -> None:
        worker.log_event(order.study, {"member": order.member, "attempt": attempt, "worker": worker.address, **words})

    send(kind="started")
    try:
        folder, mode = _open_folder(order, attempt, worker)
    except OSError as error:
        reason = f"worker {worker.address} cannot use the folder ({error}); --bring-back needs no shared folder"
        send(kind="ended", status="failed", reason=reason, folder="", files=[])
        return
    process = MemberProcess(_share_worker(order, worker, str(folder), mode))
    with _lock:
        _running.setdefault(order.study, []).append(process)
    try:
        status, reason = process.follow(
            lambda fraction, text: send(kind="moved", fraction=fraction, text=text), _find_whether_wanted(worker)
        )
    finally:
        with _lock:
            _running[order.study].remove(process)
    files = [(path.name, path.stat().st_size) for path in sorted(folder.glob("*")) if path.is_file()]
    send(kind="ended", status=status, reason=reason, folder=str(folder), files=files)


def _open_folder(order: Order, attempt: str, worker: Worker) -> tuple[Path, Mode]:
    """Create this attempt's folder, with what is there of the member if that is to go on. Raises OSError."""
    if not order.folder:
        folder = Path(worker.local_directory) / f"presswork-{attempt}"
        folder.mkdir()
        if order.archive:
            with tarfile.open(fileobj=io.BytesIO(order.archive)) as archive:
                # from 3.11.4 on; the archive is the study's own
                checked: dict[str, Any] = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
                archive.extractall(folder, **checked)
    else:
        place = Path(order.folder)
        folder = place.with_name(f".{place.name}-{attempt}")
        if order.mode == "resume":
            shutil.copytree(place, folder)
        else:
            folder.mkdir()
    return folder, "resume" if order.mode == "resume" else "new"


def _share_worker(order: Order, worker: Worker, folder: str, mode: Mode) -> Work:
    """Give a member its share of the worker's threads and memory."""
    all_threads = int(worker.state.nthreads)
    threads = order.threads or all_threads
    limit = worker.memory_manager.memory_limit
    memory = int(limit * min(threads / all_threads, 1.0)) if limit else None
    return Work(order.job, folder, mode, threads=threads, seconds=order.seconds, memory=memory)


def _find_whether_wanted(worker: Worker) -> Any:
    """Return a function that returns whether the scheduler still waits for the present task on this worker."""
    key = worker.get_current_task()

    def is_wanted() -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state == "executing" and worker.status.name == "running"

    return is_wanted


def kill_members(study: str) -> None:
    """Kill what runs of a study here."""
    with _lock:
        for process in _running.get(study, []):
            process.stop(signal.SIGKILL)


def holds_token(path: str, words: str) -> bool:
    """Return whether this worker sees a file of these words, and may write beside it."""
    try:
        return Path(path).read_text() == words and os.access(Path(path).parent, os.W_OK)
    except OSError:
        return False


def read_part(path: str, offset: int, size: int) -> bytes:
    """Return a part of a file. Raises OSError."""
    with open(path, "rb") as file:
        file.seek(offset)
        return file.read(size)


def delete_folder(folder: str) -> None:
    """Delete a folder that has been fetched."""
    shutil.rmtree(folder, ignore_errors=True)
