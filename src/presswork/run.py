# SPDX-License-Identifier: Apache-2.0
"""Run a Model into an output folder: history, saved steps, checkpoints, summary, log; and resume it."""

from __future__ import annotations

import hashlib
import logging
import platform
import resource
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Literal

import numpy as np

from presswork import __version__
from presswork.model import Model, ToolMotion
from presswork.procedure.arc_length import ArcLengthProcedure
from presswork.procedure.implicit import (
    CUTBACKS,
    FRACTION,
    INCREMENTS,
    ITERATIONS,
    STAGE,
    TIME,
    GaveUpError,
    ImplicitProcedure,
    IncrementReport,
)
from presswork.procedure.penetration import Penetration
from presswork.procedure.supports import NotHeldError
from presswork.procedure.tool_quantities import ToolQuantities, measure_tools
from presswork.results import (
    History,
    OutputError,
    Result,
    append_step,
    history_columns,
    load_checkpoint,
    open_output_folder,
    read_history,
    save_checkpoint,
    truncate_steps,
    write_summary,
)
from presswork.results.folder import CASE, CHECKPOINT, HISTORY, LOG, RESULTS, SUMMARY

__all__ = ["NotHeldError", "Outcome", "Progress", "check_start", "fingerprint", "run_model"]

Status = Literal["completed", "gave_up", "interrupted"]


@dataclass(frozen=True)
class Progress:
    """What a progress display needs after each increment."""

    fraction: float
    """Of the whole process."""
    report: IncrementReport
    tools: dict[str, ToolQuantities]


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    status: Status
    folder: Path
    reason: str = ""

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
) -> Outcome:
    """Compute the whole process and write it to the folder.

    A resumed run starts from the folder's checkpoint and gives the same bits as one never stopped. Ctrl-C and a solver
    that gives up leave a checkpoint and readable results, and are told by Outcome.status. Raises OutputError if the
    folder cannot be used or written, NotHeldError if the workpiece is free to move as a rigid body.
    """
    by_arc = model.solver.control == "arc_length"
    procedure = (ArcLengthProcedure if by_arc else ImplicitProcedure)(model, threads=threads)
    path = open_output_folder(folder, overwrite=overwrite, resume=resume)
    run = _Run(model, path, procedure)
    if resume:
        run.load()
    else:
        (path / CASE).write_text(model.case_text, encoding="utf-8")
        run.save_step()
        run.save_checkpoint()
    return run.complete(on_increment)


def check_start(model: Model) -> None:
    """Raise NotHeldError if the workpiece is free to move as a rigid body, or a pushed tool has nothing before it."""
    ImplicitProcedure(model, threads=1)


def fingerprint(model: Model) -> str:
    """Return a digest of what a checkpoint depends on: everything but the title and the output settings."""
    digest = hashlib.sha256()
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        parts = (model.analysis, model.depth, model.materials, model.tools, model.supports, model.stages, model.solver)
        digest.update(repr(parts).encode())
        digest.update(repr((model.bodies, model.contacts)).encode())
    digest.update(np.ascontiguousarray(model.mesh.points).tobytes())
    if model.mesh.normals is not None:
        digest.update(np.ascontiguousarray(model.mesh.normals).tobytes())
    for block in model.mesh.blocks:
        section = repr(block.section).encode() if block.section else b""
        digest.update(block.element.encode() + section + np.ascontiguousarray(block.connectivity).tobytes())
    return digest.hexdigest()


class _Run:
    """One run in one folder."""

    def __init__(self, model: Model, folder: Path, procedure: ImplicitProcedure) -> None:
        self.model = model
        self.folder = folder
        self.procedure = procedure
        self.turning = [
            t.name for t in model.tools if any(s.tool_motion.get(t.name, ToolMotion()).turn for s in model.stages)
        ]
        columns = history_columns([t.name for t in model.tools], self.turning, [c.name for c in model.contacts])
        self.history = History(folder / HISTORY, columns)
        self.saved_steps = 0
        self.penetration = Penetration()
        self.log = logging.getLogger(f"presswork.{id(self)}")
        self.log.setLevel(logging.INFO)
        self.log.propagate = False
        handler = logging.FileHandler(folder / LOG, encoding="utf-8")
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s", "%H:%M:%S"))
        self.log.addHandler(handler)
        self.log.info("presswork %s: %s", __version__, model.title)
        self.log.info("linear solver: %s", self.procedure.equilibrium.solver.name)

    # --- the way through ---------------------------------------------------------------------------------------------

    def complete(self, on_increment: Callable[[Progress], None] | None) -> Outcome:
        """Advance to the end, recording; always leaves a checkpoint and a summary."""
        status: Status = "completed"
        reason = ""
        try:
            for report in self.procedure.advance():
                self._record(report, on_increment)
        except GaveUpError as error:
            status, reason = "gave_up", str(error)
        except KeyboardInterrupt:
            status, reason = "interrupted", "stopped by the user or a signal; continue with --resume"
        if status != "completed":
            self.log.info("%s: %s", status, reason)
            self.save_checkpoint()
            self._save_last_state()
        self._write_summary(status, reason)
        for handler in list(self.log.handlers):
            handler.close()
            self.log.removeHandler(handler)
        return Outcome(status, self.folder, reason)

    def _record(self, report: IncrementReport, on_increment: Callable[[Progress], None] | None) -> None:
        for reason in report.cutbacks:
            self.log.info("increment %d cut back: %s", report.number, reason)
        self.log.info(
            "increment %d, stage %s at %.4f, %d iterations, residuals %s, corrections %s, contact changes %s",
            report.number,
            report.stage,
            report.fraction,
            len(report.log),
            " ".join(f"{r:.1e}" for r in report.log.residual),
            " ".join(f"{c:.1e}" for c in report.log.correction),
            sum(report.log.contact_changes),
        )
        started = perf_counter()
        self.penetration.note(self.model, self.procedure.contact, self.procedure.state)
        tools = measure_tools(self.procedure, self._stage())
        row: dict[str, float | int | str] = {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "iterations": len(report.log),
        }
        for name, tool in tools.items():
            row[f"{name}.stroke"], row[f"{name}.force"] = tool.stroke, tool.force
            row[f"{name}.force_x"], row[f"{name}.force_y"] = (float(f) for f in tool.vector)
            row[f"{name}.force_z"] = 0.0
            if name in self.turning:
                row[f"{name}.angle"], row[f"{name}.torque"] = float(np.degrees(tool.angle)), tool.torque
        for name, (force_x, force_y) in self.procedure.contact_forces().items():
            row[f"{name}.force_x"], row[f"{name}.force_y"] = force_x, force_y
        self.history.append(row)
        if report.is_save_point:
            self.save_step()
        every = self.model.output.checkpoint_every
        if report.number % every == 0 or self._is_over():
            self.save_checkpoint()
        self.procedure.timing.add("output", started)
        if on_increment:
            on_increment(Progress(1.0 - self.procedure.remaining(), report, tools))

    def _is_over(self) -> bool:
        return int(self.procedure.state.progress[STAGE]) == len(self.model.stages)

    def _stage(self) -> int:
        """The stage that the converged state belongs to."""
        progress = self.procedure.state.progress
        stage = int(progress[STAGE])
        return stage - 1 if progress[FRACTION] == 0.0 and stage > 0 else stage

    # --- files -------------------------------------------------------------------------------------------------------

    def save_step(self) -> None:
        """Append the converged state to the results file."""
        self._append_step()
        self.saved_steps += 1

    def _save_last_state(self) -> None:
        """Save where the run stopped; a resumed run drops this step again."""
        truncate_steps(self.folder / RESULTS, self.saved_steps)
        self._append_step()

    def _append_step(self) -> None:
        procedure, model = self.procedure, self.model
        state = procedure.state
        forces = procedure.contact.forces(state, procedure.equilibrium.fixed(self._stage()))
        append_step(
            self.folder / RESULTS,
            model.mesh,
            float(state.progress[TIME]),
            procedure.mechanics.point_fields(state, forces, procedure.interface_stress()),
            procedure.mechanics.cell_fields(state),
            tools={t.name: t.segments for t in model.tools},
            tool_centre={t.name: np.asarray(t.centre) for t in model.tools},
            tool_displacement={t.name: state.tool_displacement[i] for i, t in enumerate(model.tools)},
            tool_angle={t.name: float(state.tool_angle[i]) for i, t in enumerate(model.tools)},
            info={
                "title": model.title,
                "analysis": model.analysis,
                "depth": model.depth,
                "mirrored_x": "\n".join(t.name for t in model.tools if t.mirrored_across[0]),
                "mirrored_y": "\n".join(t.name for t in model.tools if t.mirrored_across[1]),
            },
        )

    def save_checkpoint(self) -> None:
        """Dump the converged state; the history on disk is brought up to it first."""
        self.history.sync()
        meta: dict[str, int | float | str] = {
            "model": fingerprint(self.model),
            "saved_steps": self.saved_steps,
            "increments": int(self.procedure.state.progress[INCREMENTS]),
            "initial_volume": self.procedure.initial_volume,
            "node_penetration": self.penetration.node,
            "edge_penetration": self.penetration.edge,
        }
        save_checkpoint(self.folder / CHECKPOINT, self.procedure.state.to_arrays(), meta)

    def load(self) -> None:
        """Take up the checkpoint: state, history and saved steps as they were then."""
        arrays, meta = load_checkpoint(self.folder / CHECKPOINT)
        if meta["model"] != fingerprint(self.model):
            raise OutputError(
                f"{self.folder / CHECKPOINT} belongs to another case: mesh, materials, tools, stages or solver "
                "settings differ. Resume with the case and the --set as they were (case.toml beside it has both), or "
                "use --overwrite"
            )
        try:
            self.procedure.state.load_arrays(arrays)
        except ValueError as error:
            raise OutputError(f"{self.folder / CHECKPOINT}: {error}; use --overwrite to start anew") from error
        self.saved_steps = int(meta["saved_steps"])
        self.penetration = Penetration(float(meta["node_penetration"]), float(meta["edge_penetration"]))
        self.history.truncate(int(meta["increments"]))
        truncate_steps(self.folder / RESULTS, self.saved_steps)
        self.log.info("resumed after increment %d", int(meta["increments"]))

    def _shortest_edge(self) -> float:
        edges, points = self.model.mesh.boundary_edges, self.model.mesh.points
        return float(np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1).min(initial=np.inf))

    def _never_touched(self) -> list[str]:
        """Return the tools that no force of the workpiece has ever reached."""
        history = read_history(self.folder / HISTORY)
        forces = {t.name: [history[f"{t.name}.{way}"] for way in ("force_x", "force_y")] for t in self.model.tools}
        return [name for name, columns in forces.items() if not np.any(columns)]

    def _write_summary(self, status: Status, reason: str) -> None:
        procedure, model = self.procedure, self.model
        state = procedure.state
        elastic_volume = procedure.mechanics.elastic_dilatation(state)
        volume, initial = procedure.volume(), procedure.initial_volume
        extremes = procedure.mechanics.extremes(state)
        write_summary(
            self.folder / SUMMARY,
            {
                "status": status,
                "reason": reason,
                "title": model.title,
                "version": __version__,
                "fraction_computed": 1.0 - procedure.remaining(),
                "increments": int(state.progress[INCREMENTS]),
                "iterations": int(state.progress[ITERATIONS]),
                "cutbacks": int(state.progress[CUTBACKS]),
                "freedoms": procedure.mechanics.freedoms * len(model.mesh.points),
                "wall_seconds": {"total": procedure.timing.total(), **procedure.timing.seconds},
                "peak_memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                "extremes": {name: [float(v.min()), float(v.max())] for name, v in extremes.items()},
                "volume": {
                    "initial_mm3": initial,
                    "final_mm3": volume,
                    "change_percent": 100 * (volume / initial - 1),
                    "elastic_part_percent": 100 * elastic_volume / initial,
                },
                "contact": {
                    "tolerance_mm": procedure.contact.tolerance,
                    "largest_node_penetration_mm": self.penetration.node,
                    "largest_edge_penetration_mm": self.penetration.edge,
                    "shortest_edge_mm": self._shortest_edge(),
                    "tools_never_touched": self._never_touched(),
                },
                "energy": procedure.energy_balance(),
                "linear_solver": procedure.equilibrium.solver.name,
                "machine": platform.machine(),
            },
        )
