# SPDX-License-Identifier: Apache-2.0
"""The ranks of a run, and the messages between them, counted."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Protocol, TypeVar, cast
from weakref import WeakValueDictionary

import numpy as np

from presswork.model import FloatArray, IntArray
from presswork.ranks.launch import count_ranks

NO_MPI = 'pip install "presswork[mpi]" brings both mpi4py and an MPI with its mpiexec; or run without mpiexec'
NO_PETSC = (
    "on Debian and Ubuntu: apt install python3-petsc4py python3-mpi4py openmpi-bin; elsewhere: "
    "pip install petsc4py, which compiles PETSc where there is none; or run without mpiexec"
)


Made = TypeVar("Made")


class RanksError(Exception):
    """The run cannot be divided over ranks."""


class LeadFailed(Exception):  # noqa: N818
    """Rank 0 has ended by an error."""


@dataclass
class Traffic:
    """What one rank has sent by this program; PETSc's solvers send more."""

    messages: int = 0
    """Number of messages from rank to rank."""
    sent: int = 0
    """Sent data in these [bytes]."""
    collectives: int = 0
    """Calls that all ranks take part in."""
    received: int = 0
    """Data received from other ranks in these [bytes]."""

    def numbers(self) -> IntArray:
        """Return the counts (4,)."""
        return np.array([self.messages, self.sent, self.collectives, self.received], dtype=np.int64)


class Helper(Protocol):
    """What is divided over ranks, and gives rank 0 what it asks for while it does something alone."""

    def help(self, what: Any) -> None:
        """Do a rank's part of what rank 0 asks for; all ranks do it at the same time."""


class World:
    """All ranks of a run.

    Every method that is not a property is called by all of them at the same place; `ask` by rank 0, while it leads and
    the others follow.
    """

    def __init__(self, communicator: Any, mpi: Any = None) -> None:
        """communicator: of mpi4py; mpi: its module, for messages that are prepared."""
        self._comm, self._mpi = communicator, mpi
        self.rank: int = communicator.Get_rank()
        self.size: int = communicator.Get_size()
        self.traffic = Traffic()
        self.leads = False
        """Whether this is rank 0 while it does something alone."""
        self._helpers: WeakValueDictionary[int, Helper] = WeakValueDictionary()
        self._n_helpers = 0

    def exchange(self, outgoing: Mapping[int, FloatArray], incoming: Mapping[int, FloatArray]) -> None:
        """Send arrays to ranks and fill those that come from ranks, in place."""
        requests = [self._comm.Irecv(array, source=rank) for rank, array in sorted(incoming.items())]
        for rank, array in sorted(outgoing.items()):
            requests.append(self._comm.Isend(array, dest=rank))
            self.traffic.messages += 1
            self.traffic.sent += array.nbytes
        for request in requests:
            request.Wait()

    def prepare_send(self, array: FloatArray, rank: int) -> Any:
        """Return a message to a rank, to be started again and again; the array stays where it is."""
        return self._comm.Send_init(array, dest=rank)

    def prepare_receive(self, array: FloatArray, rank: int) -> Any:
        """Return a message from a rank, to be started again and again."""
        return self._comm.Recv_init(array, source=rank)

    def start(self, prepared: list[Any], messages: int, sent: int) -> None:
        """Start prepared messages, of which so many send so much [bytes]."""
        self._mpi.Prequest.Startall(prepared)
        self.traffic.messages += messages
        self.traffic.sent += sent

    def start_to_agree(self, shared: FloatArray, *, sums: int) -> list[Any]:
        """Start to find, in place, the largest of the ranks' first numbers, and the sums of so many that follow."""
        mpi = self._mpi
        started = [self._comm.Iallreduce(mpi.IN_PLACE, shared[:1], op=mpi.MAX)]
        if sums:
            started.append(self._comm.Iallreduce(mpi.IN_PLACE, shared[1 : 1 + sums], op=mpi.SUM))
        self.traffic.collectives += len(started)
        self.traffic.received += 8 * (1 + sums)
        return started

    def wait(self, requests: list[Any]) -> None:
        """Wait until messages have come and gone."""
        self._mpi.Request.Waitall(requests)

    def swap(self, outgoing: Mapping[int, Any]) -> dict[int, Any]:
        """Send any object to each of some ranks; return what has come, by rank. For set-up, not for iterations."""
        listed = self._comm.alltoall([outgoing.get(rank) for rank in range(self.size)])
        self.traffic.collectives += 1
        return {rank: what for rank, what in enumerate(listed) if what is not None}

    def gather(self, own: FloatArray, counts: IntArray) -> FloatArray:
        """Return the values of all ranks one after another; counts: of each rank."""
        whole = np.empty(int(counts.sum()))
        self._comm.Allgatherv(np.ascontiguousarray(own), [whole, counts.astype(np.int32)])
        self.traffic.collectives += 1
        self.traffic.received += whole.nbytes - own.nbytes
        return whole

    def gather_rows(self, own: FloatArray) -> FloatArray:
        """Return the rows (n, k) of all ranks one after another, of which each has any number."""
        counts = self.gather(np.array([float(own.size)]), np.ones(self.size, dtype=np.int32)).astype(np.int32)
        return self.gather(own.reshape(-1), counts).reshape(-1, own.shape[1])

    def gather_to_lead(self, own: FloatArray, counts: IntArray) -> FloatArray | None:
        """Return on rank 0 the values of all ranks one after another; counts: of each rank."""
        whole = np.empty(int(counts.sum())) if self.rank == 0 else None
        into = None if whole is None else [whole, counts.astype(np.int32)]
        self._comm.Gatherv(np.ascontiguousarray(own), into, root=0)
        self.traffic.collectives += 1
        self.traffic.received += 0 if whole is None else whole.nbytes - own.nbytes
        return whole

    def largest(self, number: int) -> int:
        """Return the largest of the ranks' numbers."""
        return int(self.gather(np.array([float(number)]), np.ones(self.size, dtype=np.int32)).max())

    def find_largest(self, numbers: FloatArray) -> None:
        """Find the largest of each number (n,) of all ranks, in place."""
        self._comm.Allreduce(self._mpi.IN_PLACE, numbers, op=self._mpi.MAX)
        self.traffic.collectives += 1
        self.traffic.received += numbers.nbytes

    def gather_objects(self, own: Any) -> list[Any]:
        """Return any object of each rank. For what seldom happens."""
        self.traffic.collectives += 1
        return list(self._comm.allgather(own))

    def share(self, make: Callable[[], Made], fault: type[Exception]) -> Made:
        """Return what rank 0 makes, while the others wait, or raise its error of a kind. For what seldom happens."""
        found: Made | Exception | None = None
        if self.rank == 0:
            try:
                found = make()
            except fault as error:
                found = error
        found = self._comm.bcast(found, root=0)
        self.traffic.collectives += 1
        if isinstance(found, fault):
            raise found
        return cast(Made, found)

    @contextmanager
    def leading(self, gave_up: type[Exception] | tuple[()] = ()) -> Iterator[None]:
        """Do on rank 0 what it does alone; the others hear by follow() whether it has ended without an error.

        gave_up: an error after which all ranks end in common.
        """
        goes_on: bool | None = None
        self.leads = True
        try:
            yield
            goes_on = True
        except gave_up:
            goes_on = False
            raise
        finally:
            self.leads = False
            self._comm.bcast((0, goes_on), root=0)

    def follow(self) -> bool:
        """Help rank 0 until it has done what it does alone; return whether the run goes on.

        Raises LeadFailed where rank 0 has ended by an error, which rank 0 reports.
        """
        number, what = self._comm.bcast(None, root=0)
        while number > 0:
            self._helpers[number].help(what)
            number, what = self._comm.bcast(None, root=0)
        if what is None:
            raise LeadFailed
        return bool(what)

    def register(self, helper: Helper) -> int:
        """Return the number by which rank 0 asks a helper, made by all ranks in the same order."""
        self._n_helpers += 1
        self._helpers[self._n_helpers] = helper
        return self._n_helpers

    def ask(self, number: int, what: Any) -> None:
        """Let all ranks do what their helper of this number does for rank 0, which leads."""
        assert self.leads, "the others follow"
        self._comm.bcast((number, what), root=0)
        self.traffic.collectives += 1
        self._helpers[number].help(what)

    def describe_traffic(self) -> str:
        """Describe in a line what all ranks have sent up to now."""
        messages, sent, collectives, received = sum(self.gather_objects(self.traffic.numbers()))
        return (
            f"{self.size} ranks: {messages} messages of {sent / 1e6:.3f} MB from rank to rank, "
            f"{collectives // self.size} collective calls, in which ranks received {received / 1e6:.3f} MB; "
            "the linear solver's own not counted"
        )


def find_world() -> World | None:
    """Return the ranks that mpiexec has started, None if this process computes alone. Raises RanksError."""
    if count_ranks() == 1:
        return None
    try:
        from mpi4py import MPI
    except (ImportError, RuntimeError) as error:  # the second where no library of an MPI is found
        raise RanksError(f"a run on {count_ranks()} ranks needs mpi4py and an MPI ({error}); {NO_MPI}") from error
    world = World(MPI.COMM_WORLD, MPI)
    if world.size != count_ranks():
        raise RanksError(
            f"mpiexec has started {count_ranks()} processes, of which each sees {world.size}: mpi4py was made for "
            "another MPI than that of this mpiexec; take the mpiexec of mpi4py's MPI, or rebuild mpi4py"
        )
    _end_all_on_errors()
    return world


def start_petsc(world: World) -> None:
    """Make PETSc ready, which shares implicit runs. Raises RanksError."""
    try:
        import petsc4py

        petsc4py.init([])
    except ImportError as error:
        raise RanksError(f"an implicit run on {world.size} ranks needs petsc4py ({error}); {NO_PETSC}") from error


def _end_all_on_errors() -> None:
    """End all ranks where one ends by an error that nobody handles: the others would wait for it for ever."""
    before = sys.excepthook

    def end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        from mpi4py import MPI

        before(kind, error, trace)
        sys.stderr.flush()
        MPI.COMM_WORLD.Abort(1)

    sys.excepthook = end
