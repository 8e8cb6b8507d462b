# SPDX-License-Identifier: Apache-2.0
"""The members of a study on the workers of a cluster: tasks go in, the events of `Processes` come out."""

from __future__ import annotations

import pickle
import queue
import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

from presswork.api import build
from presswork.case import CaseError
from presswork.results import OutputError
from presswork.study.cluster.bring_back import bring_back, pack_folder
from presswork.study.cluster.connection import Cluster, check_sight, connect
from presswork.study.cluster.folders import clear_attempts, put_in_place
from presswork.study.cluster.on_worker import Order, compute, kill_members
from presswork.study.member_process import Ending
from presswork.study.runner import Ended, Event, Interrupts, Moved, Started, Task

if TYPE_CHECKING:
    from distributed import Client

ATTEMPTS = 3
"""A member is computed so often at most, where workers that compute it are lost."""
_LARGE_GRAPH = "distributed.admin.large-graph-warning-threshold"


@dataclass
class _Member:
    """What is known of one member."""

    order: Order
    future: Any = None
    """Future of Dask."""
    tries: int = 0
    """Number of times that it was given to the scheduler."""
    workers: list[str] = field(default_factory=list)
    """Workers that have started it, in turn; all but the last are lost."""
    ended: bool = False


class ClusterPool:
    """Runs each task on a thread of a worker; a worker that is lost costs its members an attempt."""

    def __init__(self, client: Client, cluster: Cluster, seconds: float | None, threads: int) -> None:
        self._client = client
        self._cluster = cluster
        self._seconds = seconds
        self._threads = threads
        self._news: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()
        self.interrupts = Interrupts()

    def run(self, tasks: Mapping[int, Task]) -> Iterator[Event]:
        """Yield events until every task has ended. Ctrl-C stops the running ones; those not started get no event.

        Raises ClusterError if workers do not see the folders, where they must.
        """
        for parent in {task.folder.absolute().parent for task in tasks.values()}:
            clear_attempts(parent)
            if not self._cluster.bring_back:
                check_sight(self._client, parent)
        study, self.interrupts.count, self._stopping = f"presswork-{uuid.uuid4().hex}", 0, False
        self._places = {i: task.folder.absolute() for i, task in tasks.items()}
        self._modes = {i: task.mode for i, task in tasks.items()}
        self._client.subscribe_topic(study, lambda event: self._news.put(("reported", event[1])))
        try:
            with self.interrupts.counted():
                self._members = {}
                for i, task in tasks.items():
                    try:
                        self._members[i] = _Member(self._make_order(study, i, task))
                    except CaseError as error:
                        yield Ended(i, "bad_input", str(error))
                self._submit(*self._members)
                yield from self._listen(study)
        finally:
            self._cancel()
            self._client.unsubscribe_topic(study)
            for parent in {place.parent for place in self._places.values()}:
                clear_attempts(parent)

    def _make_order(self, study: str, member: int, task: Task) -> Order:
        """Pack a task. Workers that do not see the case's files get its Model. Raises CaseError."""
        job, folder, archive = task.job, str(task.folder.absolute()), b""
        if self._cluster.bring_back:
            job = build(job)
            archive = pack_folder(task.folder) if task.mode == "resume" else b""
            folder = ""
        return Order(study, member, pickle.dumps(job), task.mode, folder, archive, self._threads, self._seconds)

    def _submit(self, *numbers: int) -> None:
        """Give members to the scheduler, all at once, so that it keeps those that no worker has a thread for."""
        import dask

        members = [self._members[i] for i in numbers]
        keys = [(m.order.study.replace("presswork-", "member-"), m.order.member, m.tries) for m in members]
        with dask.config.set({_LARGE_GRAPH: "10GB"}):
            futures = self._client.map(compute, [m.order for m in members], key=keys, pure=False)
        for member, future in zip(members, futures, strict=True):
            member.future, member.tries = future, member.tries + 1
            future.add_done_callback(lambda done, i=member.order.member: self._news.put(("done", (i, done))))

    def _listen(self, study: str) -> Iterator[Event]:
        """Yield events until all members have ended, or those that run have, once the user stops them."""
        handled = 0
        while not all(m.ended or (self._stopping and not m.workers) for m in self._members.values()):
            if self.interrupts.count > handled:
                handled += 1
                self._stopping = True
                self._cancel()
                if handled > 1:
                    Thread(target=self._client.run, args=(kill_members, study), daemon=True).start()
                    yield from self._give_up("interrupted", "killed by the user; continue with --resume")
                    return
            try:
                kind, news = self._news.get(timeout=0.2)
            except queue.Empty:
                if self._stopping:
                    yield from self._leave_lost_workers()
                continue
            yield from self._hear(news) if kind == "reported" else self._judge(*news)

    def _hear(self, news: Mapping[str, Any]) -> Iterator[Event]:
        """Take up what a worker reports about a member."""
        i, member = news["member"], self._members[news["member"]]
        if member.ended:
            return
        if news["kind"] == "started":
            member.workers.append(news["worker"])
            if len(member.workers) > ATTEMPTS:
                yield self._end(i, "failed", _name_lost(member.workers[:-1]))
            else:
                yield Started(i) if len(member.workers) == 1 else Moved(i, 0.0, "")
        elif news["kind"] == "moved":
            yield Moved(i, news["fraction"], news["text"])
        else:
            yield from self._take(i, news)

    def _take(self, i: int, news: Mapping[str, Any]) -> Iterator[Event]:
        """Put the results of an attempt into the member's place, from another machine where they lie there."""
        place = self._places[i]
        status: Ending = news["status"]
        reason: str = news["reason"]
        try:
            if news["folder"]:
                folder = Path(news["folder"])
                if self._cluster.bring_back:
                    folder = bring_back(self._client, news, place)
                put_in_place(folder, place, overwrite=self._modes[i] == "overwrite")
        except ConnectionError:
            yield from self._try_again(i, "its results could not be fetched")
            return
        except (OSError, OutputError) as error:
            status, reason = "failed", f"its results could not be put into {place}: {error}"
        yield self._end(i, status, reason)

    def _judge(self, i: int, future: Any) -> Iterator[Event]:
        """Take up that the scheduler is done with a member, which its worker has reported unless it is lost."""
        from distributed.scheduler import KilledWorker

        member = self._members[i]
        if member.ended or future is not member.future or future.status == "finished":
            return
        if future.status == "error":
            error = future.exception()
            if isinstance(error, KilledWorker):
                yield from self._try_again(i, f"worker {error.last_worker.address} died with it")
            else:
                yield self._end(i, "failed", f"its worker could not compute it: {error!r}")
        elif not self._stopping:
            lost = "the scheduler was lost, or dropped it; --resume computes it again"
            yield self._end(i, "failed", lost)

    def _try_again(self, i: int, reason: str) -> Iterator[Event]:
        """Compute a member again, unless it has been often enough."""
        member = self._members[i]
        if self._stopping:
            yield self._end(i, "interrupted", f"{reason}; continue with --resume")
        elif max(member.tries, len(member.workers)) >= ATTEMPTS:
            yield self._end(i, "failed", f"{reason}, after {ATTEMPTS} attempts")
        else:
            self._submit(i)

    def _end(self, i: int, status: Ending, reason: str) -> Ended:
        member = self._members[i]
        member.ended = True
        if member.future is not None:
            member.future.cancel()  # stops an attempt that is still at work on a worker given up for lost
        return Ended(i, status, reason)

    def _give_up(self, status: Ending, reason: str) -> Iterator[Event]:
        """End all members that have been started."""
        for i, member in self._members.items():
            if member.workers and not member.ended:
                yield self._end(i, status, reason)

    def _leave_lost_workers(self) -> Iterator[Event]:
        """End the members of workers that are gone, once nothing is computed again."""
        there = self._client.scheduler_info(n_workers=-1)["workers"]
        for i, member in self._members.items():
            if member.workers and not member.ended and member.workers[-1] not in there:
                yield self._end(i, "interrupted", "its worker was lost; continue with --resume")

    def _cancel(self) -> None:
        """Withdraw all members: what waits is dropped, what runs saves a checkpoint and ends."""
        futures = [m.future for m in self._members.values() if m.future is not None and not m.ended]
        if futures:
            self._client.cancel(futures)


def _name_lost(workers: list[str]) -> str:
    return f"{len(workers)} workers died or were cut off while they computed it: {', '.join(workers)}"


@contextmanager
def open_cluster_pool(
    cluster: Cluster, jobs: int, seconds: float | None = None, threads: int = 1
) -> Iterator[ClusterPool]:
    """Provide the pool of a cluster. threads: of each member, 0 for all of a worker. Raises ClusterError."""
    with connect(cluster, jobs) as client:
        yield ClusterPool(client, cluster, seconds, threads)
