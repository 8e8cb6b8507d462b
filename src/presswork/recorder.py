# SPDX-License-Identifier: Apache-2.0
"""Run a Model into an output folder: history, saved steps, checkpoints, summary, log; and resume it."""

from __future__ import annotations

import logging
import os
import platform
import resource
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass
from functools import partial
from io import TextIOWrapper
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

from numpy.typing import NDArray

from presswork import __version__, stop
from presswork.fingerprint import fingerprint
from presswork.model import Model
from presswork.observe.doubts import find_doubts
from presswork.observe.memory.contract import Memories
from presswork.observe.memory.of_model import list_memories
from presswork.outcome import GaveUpError, GoalReachedError, StartError
from presswork.process.begin import begin
from presswork.process.run import Meta, Report, Run
from presswork.ranks.world import LeadFailed, World
from presswork.results import (
    History,
    OutputError,
    Result,
    load_checkpoint,
    occupy,
    open_output_folder,
    read_history,
    save_checkpoint,
    write_summary,
)
from presswork.results.folder import CASE, CHECKPOINT, HISTORY, LOG, RESULTS, SUMMARY
from presswork.results.pause import end_pause, is_paused
from presswork.results.progress import ProgressFile
from presswork.results.whole_file import explain_write_error, open_to_append, write_whole
from presswork.step_writer import StepWriter, append_snapshot

__all__ = ["Outcome", "Progress", "StartError", "run_model"]

Status = Literal["completed", "gave_up", "interrupted"]


@dataclass(frozen=True)
class Progress:
    """Data that a progress display needs after each increment."""

    fraction: float
    """Fraction of the whole process."""
    text: str
    """Stage, increment and tools in a line."""


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    status: Status
    folder: Path
    reason: str = ""

    @property
    def has_results(self) -> bool:
        """Whether anything was saved: a blank that was not found leaves nothing."""
        return (self.folder / SUMMARY).exists()

    @property
    def result(self) -> Result:
        """The results, read from the folder."""
        return Result(self.folder)


def run_model(
    model: Model,
    folder: Path | str,
    *,
    overwrite: bool = False,
    resume: bool = False,
    threads: int = 0,
    on_increment: Callable[[Progress], None] | None = None,
    procedure: Callable[[Model, int], Run] = begin,
    world: World | None = None,
) -> Outcome:
    """Compute the whole process and write it to the folder.

    procedure: makes the procedure at work on the model, from the model and the number of threads; by default the one
    that the model asks for. world: the ranks of MPI that compute the run together: rank 0 writes.

    A resumed run starts from the folder's checkpoint and gives the same bits as one never stopped. Ctrl-C, SIGTERM and
    a solver that gives up leave a checkpoint and readable results, and appear in Outcome.status. Raises OutputError if
    the folder cannot be used or written, StartError if nothing can be computed from this start: as NotHeldError if the
    workpiece is free to move as a rigid body. A signal that comes too late to interrupt raises KeyboardInterrupt once
    all files are whole.
    """
    recording = procedure(model, threads)
    if world is not None and world.rank > 0:
        with stop.listen(world.largest):
            return _follow(recording, Path(folder), world, resume=resume)
    with stop.listen(world.largest if world else None, partial(is_paused, Path(folder))), ExitStack() as stack:
        with _leading(world):
            path = open_output_folder(folder, overwrite=overwrite, resume=resume)
            stack.enter_context(occupy(path))
            run = _Run(recording, path, model, list_memories(model), world)
            stack.callback(run.steps.close)
            found = run.read_checkpoint() if resume else None
            if found is None:
                run.begin(model.case_text)
        if found is not None:
            run.take_up(*found)
        return run.complete(on_increment)


def _leading(world: World | None) -> AbstractContextManager[None]:
    """Return the context of what rank 0 alone does."""
    return world.leading(GaveUpError) if world else nullcontext()


def _follow(recording: Run, folder: Path, world: World, *, resume: bool) -> Outcome:
    """Compute a rank's part of a run that rank 0 writes, as far as rank 0 goes; Outcome.reason comes from rank 0."""
    try:
        world.follow()
        if resume:
            arrays, meta = load_checkpoint(folder / CHECKPOINT)
            try:
                recording.load_arrays(arrays)
            except ValueError:  # as on rank 0, which reports it
                return Outcome("gave_up", folder)
            recording.load_meta(meta)
            world.follow()
        status = _follow_rows(recording, world)
        world.follow()
    except LeadFailed:
        return Outcome("gave_up", folder)
    return Outcome(status, folder)


def _follow_rows(recording: Run, world: World) -> Status:
    try:
        if not world.follow():
            return "gave_up"
        for _ in recording.advance():
            if not world.follow():
                return "gave_up"
            if recording.remaining() > 0.0:
                stop.look()
        world.describe_traffic()
    except GaveUpError:
        return "gave_up"
    except KeyboardInterrupt:
        return "interrupted"
    return "completed"


def write_start(model: Model, folder: Path) -> list[str]:
    """Write the start of a process as a run of one step into a folder that is there; return its columns of history.csv.

    Raises StartError, OutputError.
    """
    recording = begin(model, 1)
    (folder / RESULTS).unlink(missing_ok=True)
    append_snapshot(folder / RESULTS, recording.mesh, recording.snapshot())
    write_whole(folder / CASE, model.case_text.encode())
    return list(recording.columns)


class _Log(logging.FileHandler):
    """The log; what was there is kept, in a file that no other name leads to. A line without room is lost."""

    def __init__(self, path: Path) -> None:
        write_whole(path, path.read_bytes() if path.exists() else b"")
        super().__init__(path, encoding="utf-8")

    def _open(self) -> TextIOWrapper:
        return os.fdopen(open_to_append(Path(self.baseFilename)), "a", encoding=self.encoding, errors=self.errors)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802
        """Do nothing: files that matter report their own errors."""


class _Run:
    """One run in one folder."""

    def __init__(self, recording: Run, folder: Path, model: Model, memories: Memories, world: World | None) -> None:
        self.recording = recording
        self.world = world
        self.memories = memories
        self.folder = folder
        self.model = model
        self.fingerprint = fingerprint(model)
        self.history = History(folder / HISTORY, recording.columns)
        self.progress = ProgressFile(folder)
        self.steps = StepWriter(folder / RESULTS)
        self.recorded = 0
        self._saved_at = -1
        """Reports when fields were last saved."""
        self.log = logging.getLogger(f"presswork.{id(self)}")
        self.log.setLevel(logging.INFO)
        self.log.propagate = False
        try:
            handler = _Log(folder / LOG)
        except OSError as error:
            raise explain_write_error(error, folder / LOG, 0) from error
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s", "%H:%M:%S"))
        self.log.addHandler(handler)
        self.log.info("presswork %s: %s", __version__, recording.title)
        self.log.info("%s", recording.begin_log())

    # --- the way through ---------------------------------------------------------------------------------------------

    def begin(self, case_text: str) -> None:
        """Write the case and the undeformed state."""
        write_whole(self.folder / CASE, case_text.encode())
        self.save_step()
        self.save_checkpoint()

    def complete(self, on_increment: Callable[[Progress], None] | None) -> Outcome:
        """Advance to the end, recording; always leaves a checkpoint of what the history holds, and a summary."""
        status: Status = "completed"
        reason = ""
        self.progress.report(1.0 - self.recording.remaining(), "")
        try:
            with _leading(self.world):
                if self.recorded:
                    self._look_again()
            for report in self.recording.advance():
                with _leading(self.world):
                    self._record(report, on_increment)
                if self.recording.remaining() > 0.0:
                    stop.look()
            if self.world is not None:
                self.log.info("%s", self.world.describe_traffic())
        except GoalReachedError as goal:
            self._keep_end(str(goal), is_saved=self._saved_at == self.recorded)
        except GaveUpError as error:
            status, reason = "gave_up", str(error)
        except MemoryError:
            if self.world is not None:  # the other ranks wait for this one: all must end
                raise
            remedy = "close other programs, take fewer or larger elements, or go on with --resume on a larger machine"
            status, reason = "gave_up", f"not enough memory; {remedy}"
        except KeyboardInterrupt:
            status, reason = "interrupted", "stopped by the user or a signal; continue with --resume"
        with _leading(self.world):
            self._end(status, reason)
        self.progress.remove()
        end_pause(self.folder)
        timing = self.recording.timing
        self.log.info("%.1f s of wall time: %s", timing.total(), timing.shares())
        for handler in list(self.log.handlers):
            handler.close()
            self.log.removeHandler(handler)
        return Outcome(status, self.folder, reason)

    def _end(self, status: Status, reason: str) -> None:
        """Leave the summary, and of a run that was stopped a checkpoint and the last state."""
        if status != "completed":
            self._keep_end(f"{status}: {reason}")
        self._write_summary(status, reason)

    def _keep_end(self, why: str, *, is_saved: bool = False) -> None:
        """Leave a checkpoint and, unless it is saved, the last state of a run that ends before its stages do."""
        self.log.info("%s", why)
        if self.recording.number == self.recorded:  # else it was stopped before all of it was: the last one stands
            self.save_checkpoint()
        if not (is_saved or stop.is_urgent()):
            self._save_last_state()

    def _look_again(self) -> None:
        """Raise GaveUpError where a run would be resumed beyond a limit that it must not pass."""
        history = read_history(self.folder / HISTORY)
        reason = self.memories.look(self.recording.at_work(), {name: values[-1] for name, values in history.items()})
        if reason is not None:
            raise GaveUpError(reason)
        self._look_for_goals()

    def _record(self, report: Report, on_increment: Callable[[Progress], None] | None) -> None:
        """Write what there is to write after a report. Raises GaveUpError where it is no longer physics."""
        recording = self.recording
        for line in recording.log_lines(report):
            self.log.info("%s", line)
        started = perf_counter()
        self.steps.look()
        row = recording.row(report)
        self.history.append(row)
        reason = self.memories.look(recording.at_work(), row)
        for line in self.memories.news():
            self.log.warning("warning: %s", line)
        if report.is_save_point:
            self.save_step()
            self._saved_at = report.number
            for name, text in recording.files().items():
                write_whole(self.folder / name, text.encode())
        self.recorded = report.number
        if report.number % recording.checkpoint_every == 0 or recording.remaining() == 0.0:
            self.save_checkpoint()
        recording.timing.add("output", started)
        now = Progress(1.0 - recording.remaining(), recording.progress_text(report))
        self.progress.report(now.fraction, now.text)
        if on_increment:
            on_increment(now)
        if reason is not None:
            raise GaveUpError(reason)
        self._look_for_goals()

    def _look_for_goals(self) -> None:
        """Raise GoalReachedError where the run is complete before its end."""
        if (goal := self.memories.reached()) and self.recording.remaining() > 0.0:
            raise GoalReachedError(goal)

    # --- files -------------------------------------------------------------------------------------------------------

    def save_step(self) -> None:
        """Append the present state to the results file, beside what is computed next."""
        now, mesh = self.recording.snapshot(), self.recording.mesh
        self.memories.note_step(self.steps.count, mesh, now)
        self.steps.append(mesh, now)

    def _save_last_state(self) -> None:
        """Save where the run stopped; a resumed run drops this step again."""
        now, mesh = self.recording.snapshot(), self.recording.mesh
        self.memories.note_step(self.steps.count, mesh, now)
        self.steps.append_last(mesh, now)

    def save_checkpoint(self) -> None:
        """Dump the present state; the history and the steps on disk are brought up to it first."""
        self.steps.wait()
        self.history.sync()
        meta = self.recording.meta()
        meta |= {"model": self.fingerprint, "saved_steps": self.steps.count, "increments": self.recording.number}
        meta["memories"] = self.memories.to_text()
        save_checkpoint(self.folder / CHECKPOINT, self.recording.to_arrays(), meta)

    def read_checkpoint(self) -> tuple[dict[str, NDArray[Any]], Meta]:
        """Return the arrays of the checkpoint, and its other data. Raises OutputError."""
        arrays, meta = load_checkpoint(self.folder / CHECKPOINT)
        if meta["model"] != self.fingerprint:
            raise OutputError(
                f"{self.folder / CHECKPOINT} belongs to another case: mesh, materials, tools, stages or solver "
                "settings differ, or the steps at which the implicit procedure ends increments (output.steps, "
                "output.at). Resume with the case and the --set as they were (case.toml beside it has both), or use "
                "--overwrite"
            )
        return arrays, meta

    def take_up(self, arrays: Mapping[str, NDArray[Any]], meta: Meta) -> None:
        """Go on from a checkpoint: state, history and saved steps as they were then; all ranks take up the state."""
        try:
            self.recording.load_arrays(arrays)
        except ValueError as error:
            raise OutputError(f"{self.folder / CHECKPOINT}: {error}; use --overwrite to start anew") from error
        self.recording.load_meta(meta)
        with _leading(self.world):
            self._go_back(meta)

    def _go_back(self, meta: Meta) -> None:
        """Cut what is on disk back to a checkpoint."""
        self.memories.load_text(str(meta["memories"]))
        self.recorded = int(meta["increments"])
        self.history.truncate(self.recorded)
        self.steps.go_back(int(meta["saved_steps"]))
        self.log.info("resumed after increment %d", self.recorded)

    def _write_summary(self, status: Status, reason: str) -> None:
        recording = self.recording
        self.history.sync()
        self.steps.check()
        history = read_history(self.folder / HISTORY)
        found = recording.summary(history)
        doubts = find_doubts(self.model, history, found.get("extremes", {}), is_over=status == "completed")
        warnings = [*doubts.warnings, *self.memories.warnings(), *found["warnings"]]
        for warning in warnings:
            self.log.warning("warning: %s", warning)
        write_summary(
            self.folder / SUMMARY,
            {
                "status": status,
                "reason": reason,
                "verdict": doubts.worst,
                "title": recording.title,
                "version": __version__,
                "fraction_computed": 1.0 - recording.remaining(),
                "wall_seconds": {"total": recording.timing.total(), **recording.timing.seconds},
                "peak_memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                "machine": platform.machine(),
                **found,
                **self.memories.summary(history),
                "warnings": warnings,
            },
        )
