# SPDX-License-Identifier: Apache-2.0
"""What follows forming: the part is trimmed, and springs back.

It is cut along the trim lines while its tools hold it (trim.py). Then it is released, and the implicit procedure finds
where it comes to rest. The tools are gone; what they and inertia held fades over a few increments (transfer.py), and so
does what the cut took away. Only symmetry planes stay, and as many freedoms of three nodes as rigid motions are left:
such supports bear no force, so they leave the shape alone and only choose from where it is seen. The first node lies in
the middle of the blank, the other two near it along x and y, so that the bottom of a part stays where it is and its
walls and flange move.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.instant import Instant
from presswork.fields.table import compute_fields
from presswork.implicit.progress import IncrementReport, Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.checks import MeshError
from presswork.mesh.files.dynain import write_dynain
from presswork.mesh.topology import find_parts
from presswork.model import FloatArray, Mesh, Model
from presswork.observe.contract import Observed, Row
from presswork.observe.marked_points import find_marked
from presswork.outcome import GaveUpError, StartError
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.process.implicit.stamping import ImplicitStamping
from presswork.process.line.formed_sheet import make_formed
from presswork.process.line.hem import HemShape, find_hemmed, measure_hem, summarise_hem
from presswork.process.line.laying import find_half_thickness
from presswork.process.line.released_model import ELEMENTS, NAME, make_springback_model
from presswork.process.line.released_part import TRIM, Released
from presswork.process.mesh_change.transfer import TEMPERATURE, SheetState, TransferError, begin_with, sheet_of_implicit
from presswork.process.mesh_change.trim import Cut, TrimError, explain_beside, trim_sheet
from presswork.process.model_run import ModelRun, NamedArrays
from presswork.process.run import Meta, Report, Snapshot
from presswork.ranks.world import World

DEVIATION, HEM = "deviation", "hem"
FORMING, FORMED, ELASTIC = "forming.", "formed", "elastic"
"""Names in a checkpoint: the prefix of the formed part, and what Released (released_part.py) keeps."""
HEATED = "heated."
"""Prefix in a checkpoint of SheetState.heated."""
STORED = ("internal_energy", "external_energy", "elastic_energy", "external_work")
"""Columns of the history that lose the elastic energy which springback sets free."""
SHARE = 0.03
"""Share of springback in the progress display of the whole process."""


@dataclass(frozen=True)
class TrimReport:
    """The part has been cut."""

    number: int
    is_save_point: bool = True


@dataclass(frozen=True)
class SpringbackReport:
    """An increment of springback."""

    number: int
    """What was reported before included."""
    increment: IncrementReport
    is_save_point: bool


@dataclass(frozen=True)
class LaidPart:
    """A formed part on the tools of its next operation."""

    state: SheetState
    turned: FloatArray
    """Rotation from the undeformed sheet to how it lies (3, 3)."""
    level: int = 0
    """How often its shells have been split."""


class ReleasedStamping(ModelRun):
    """A stamping after which the part is trimmed, or springs back, or both: with that the last epoch begins.

    An operation of a line need not have either: then it ends as its tools have left the part.
    """

    model: Model

    def __init__(
        self,
        model: Model,
        *,
        threads: int = 0,
        begin: LaidPart | None = None,
        shows_springback: bool = False,
        world: World | None = None,
    ) -> None:
        """begin: of a later operation, the part that it takes; None: the blank.

        shows_springback: whether the fields of springback are saved though this operation has none. world: ranks that
        share the forming. They share the springback, too, after an implicit one; after an explicit one each computes it
        whole, since MPI without PETSc serves that.
        """
        super().__init__(model)
        state = None if begin is None else begin.state
        self._turned = None if begin is None else begin.turned
        self._begin = state
        self.forming: ExplicitStamping | ImplicitStamping
        if model.explicit is None:
            self.forming = ImplicitStamping(model, threads=threads, begin=state, world=world)
        else:
            level = 0 if begin is None else begin.level
            self.forming = ExplicitStamping(model, threads=threads, begin=state, level=level, world=world)
        self.timing = self.forming.timing
        self.threads = threads
        self._world = world if model.explicit is None else None
        self._shows_springback = shows_springback or model.springback is not None
        self.released: Released | None = None
        """What has become of the part without its tools."""
        self.hold: Callable[[Model], Model] | None = None
        """Returns the Model of the released part with other supports."""
        self.after_release: Callable[[ImplicitProcedure], None] | None = None
        """Called with the procedure of the part once its tools are removed."""

    def advance(self) -> Iterator[Report]:
        """Form the part row after row, cut it, then let it go. Raises GaveUpError."""
        yield from self.forming.advance()
        if not self._is_released_at_last:
            return
        if self.released is None:
            released = self.release()
            if self.after_release is not None:
                self.after_release(released.implicit)
            self.released = released
            if self.model.trim:
                yield TrimReport(self.forming.number + 1)
        if self.model.springback is None:
            return
        before = self.forming.number + bool(self.model.trim)
        for report in self.released.implicit.advance():
            yield SpringbackReport(before + report.number, report, report.is_save_point)

    @property
    def time(self) -> float:
        """Since the operation began [s]."""
        return self.forming.time if self.released is None else self._time()

    @property
    def level(self) -> int:
        """How often the shells have been split."""
        return self.forming.level if isinstance(self.forming, ExplicitStamping) else 0

    @property
    def first_mesh(self) -> Mesh:
        """The undeformed mesh that the operation has begun with."""
        return self._first_mesh

    @property
    def _is_released_at_last(self) -> bool:
        return bool(self.model.trim) or self.model.springback is not None

    def sheet(self) -> SheetState:
        """Return the part at the end of the operation, on `mesh`; in an explicit one no node of it hangs any more."""
        if self.released is not None:
            state = sheet_of_implicit(self.released.implicit)
            return replace(state, heated=self.released.heated)
        if isinstance(self.forming, ExplicitStamping):
            self.forming.refined.split_evenly()
        return self.forming.sheet()

    def formed_shape(self) -> FloatArray:
        """Return where the nodes of `mesh` were in the tools, after trimming, before springback (n_points, 3) [mm]."""
        if self.released is None:
            return np.asarray(self.sheet().position)
        return np.asarray(self.mesh.points + self.released.formed)

    def files(self) -> dict[str, str]:
        """Return the part as a dynain at its end, where the case asks for it."""
        if not self.model.output.dynain or self.remaining() > 0.0:
            return {}
        return {"part.dynain": self.write_part()}

    def write_part(self) -> str:
        """Return the part as a dynain."""
        return write_dynain(make_formed(self.sheet(), self.mesh, self.model.formed), self.model.title)

    def _make_released_model(self, mesh: Mesh) -> Model:
        """Return the Model of the part without its tools. mesh: undeformed."""
        model = make_springback_model(self.model, mesh, self._turned)
        return model if self.hold is None else self.hold(model)

    def release(self) -> Released:
        """Begin the epoch of the part without its tools: the implicit procedure cannot use hanging nodes."""
        if isinstance(self.forming, ExplicitStamping):
            self.forming.refined.split_evenly()
        mesh, state, cut = self.forming.mesh, self.forming.sheet(), None
        try:
            if self.model.trim:
                trimmed = trim_sheet(mesh, state, self.model.trim, ELEMENTS, self.model.symmetry)
                mesh, state, cut = trimmed.mesh, trimmed.state, trimmed.cut
            springback = self._make_released_model(mesh)
            implicit = ImplicitProcedure(springback, threads=self.threads, world=self._world)
            begin_with(state, implicit)
        except TrimError as error:
            raise GaveUpError(str(error)) from error
        except (MeshError, StartError, TransferError) as error:
            raise GaveUpError(f"springback cannot begin: {error}") from error
        self.begin_epoch(mesh)
        elastic = implicit.mechanics.elastic_energy(implicit.state)
        return Released(implicit, cut, state.position - mesh.points, elastic, state.heated)

    def remaining(self) -> float:
        """Return the part of the whole process still to be computed; springback counts as a small one."""
        if not self._is_released_at_last:
            return self.forming.remaining()
        left = 1.0 if self.released is None else 0.0
        if self.released is not None and self.model.springback is not None:
            left = self.released.implicit.remaining()
        return (1.0 - SHARE) * self.forming.remaining() + SHARE * left

    @property
    def number(self) -> int:
        """Rows and increments so far."""
        if self.released is None:
            return self.forming.number
        increments = self.released.implicit.state[Progress].increments
        return self.forming.number + bool(self.model.trim) + increments

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def mesh(self) -> Mesh:
        """The undeformed sheet: the blank, and what trimming leaves of it."""
        return self.forming.mesh if self.released is None else self.model.mesh

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        return self.forming.columns

    def begin_log(self) -> str:
        """Name the procedure that forms, and what it starts with."""
        return self.forming.begin_log()

    def log_lines(self, report: Any) -> list[str]:
        """Describe where the row or increment ended."""
        if isinstance(report, TrimReport):
            assert self.released is not None
            assert self.released.cut is not None
            before, after = (sum(len(b.connectivity) for b in m.blocks) for m in (self.forming.mesh, self.mesh))
            cut = self.released.cut
            line = f"{TRIM}: {after} of {before} shells, cut within {cut.off_line:.3g} mm of the line"
            return [line, *(f"warning: {text}" for text in explain_beside(cut))]
        if not isinstance(report, SpringbackReport):
            return self.forming.log_lines(report)
        found = report.increment
        return [
            *(f"{NAME} cut back: {reason}" for reason in found.cutbacks),
            f"increment {report.number}, stage {NAME} at {found.fraction:.4f}, {len(found.log)} iterations, residuals "
            f"{' '.join(f'{r:.1e}' for r in found.log.residual)}",
        ]

    def progress_text(self, report: Any) -> str:
        """Name stage and cycle or increment."""
        if isinstance(report, TrimReport):
            return TRIM
        if not isinstance(report, SpringbackReport):
            return self.forming.progress_text(report)
        return f"{NAME}: {report.increment.fraction:.0%} of the forces taken away"

    def row(self, report: Any) -> Row:
        """Return the row of the history; of a part without tools no tool has a force, and nothing moves."""
        if not isinstance(report, TrimReport | SpringbackReport):
            return self.forming.row(report)
        assert self.released is not None
        implicit = self.released.implicit
        row = self.forming.row_at_rest()
        freed = self.released.elastic - implicit.mechanics.elastic_energy(implicit.state)
        row |= {name: float(row[name]) - freed for name in STORED if name in row}
        stage = TRIM if isinstance(report, TrimReport) else NAME
        if self.model.points and not self.model.trim:
            released = find_marked(self.forming).measure(self._show_released())
            row |= {name: released[name] for name in self.forming.columns if name in released}
        return row | {"time": self._time(), "stage": stage, "increment": report.number}

    def _time(self) -> float:
        assert self.released is not None
        return self.forming.time + self.released.implicit.state[Progress].time

    def at_work(self) -> Observed | None:
        """Return what observers see; None of a released part."""
        return self.forming.at_work() if self.released is None else None

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state.

        `springback` is the displacement since the part was released, `deviation` how far it lies off the shape that it
        had in its tools, along that shape's normal, after the best fit.
        """
        now = self.forming.show()
        if self.released is None:
            if self._shows_springback:
                now.springback, now.deviation = np.zeros_like(self.mesh.points), np.zeros(len(self.mesh.points))
            return self.forming.snapshot(now)
        snapshot = self.forming.snapshot(now)
        now = self._show_released()
        if self._shows_springback:
            now.springback = self.released.moved
            now.deviation = self.released.find_deviation(self.mesh, self.model.symmetry)
        points, cells = compute_fields(now)
        common = {name: cells[name] for name in snapshot.cell_data}  # what both procedures have
        return replace(snapshot, time=self._time(), point_data=points, cell_data=common)

    def _show_released(self) -> Instant:
        """Return what the fields of the released part are computed from."""
        assert self.released is not None
        now = self.released.implicit.mechanics.show(self.released.implicit.state)
        now.tool_force, now.judged = np.zeros_like(self.mesh.points), self.model.judged
        now.heated, now.temperature = self.released.heated, self.released.heated.get(TEMPERATURE)
        return now

    def _epoch_arrays(self) -> NamedArrays:
        released = self.released
        if released is None:
            return {}
        heated = {f"{HEATED}{name}": values for name, values in released.heated.items()}
        return {FORMED: released.formed, ELASTIC: np.array(released.elastic), **heated}

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        if not self.epoch:
            self.released = None
            return
        springback = self._make_released_model(self.model.mesh)
        implicit = ImplicitProcedure(springback, threads=self.threads, world=self._world)
        heated = {name.removeprefix(HEATED): v for name, v in epoch.items() if name.startswith(HEATED)}
        self.released = Released(implicit, None, epoch[FORMED], float(epoch[ELASTIC]), heated)

    def _state_arrays(self) -> NamedArrays:
        parts = {FORMING: self.forming.to_arrays()}
        if self.released is not None:
            parts[f"{NAME}."] = self.released.implicit.state.to_arrays()
        return {f"{part}{name}": values for part, arrays in parts.items() for name, values in arrays.items()}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        def of(part: str) -> dict[str, NDArray[Any]]:
            return {name.removeprefix(part): values for name, values in arrays.items() if name.startswith(part)}

        self.forming.load_arrays(of(FORMING))
        if self.released is not None:
            if self.after_release is not None:
                self.after_release(self.released.implicit)
            self.released.implicit.state.load_arrays(of(f"{NAME}."))

    def meta(self) -> Meta:
        """Return how the part was cut, which no array holds."""
        cut = None if self.released is None else self.released.cut
        return {} if cut is None else {TRIM: cut.to_text()}

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up what meta gave."""
        if self.released is not None and TRIM in meta:
            self.released = replace(self.released, cut=Cut.from_text(str(meta[TRIM])))

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the summary of a stamping, of its trimming, and of the displacements by springback."""
        summary = self.forming.summary(history)
        report, warnings = self.summarise_release()
        report |= self.summarise_hem()
        return summary | report | {"warnings": [*summary["warnings"], *warnings]}

    def summarise_release(self) -> tuple[dict[str, Any], list[str]]:
        """Return the summary of trimming and springback, and its warnings."""
        if self.released is None:
            return {}, []
        report, warnings = self.released.summarise_cut(self.mesh)
        if self.model.springback is not None:
            report[NAME], more = self.released.summarise_springback(
                self.mesh, self.model.symmetry, self.model.springback
            )
            warnings = [*warnings, *more]
        return report, warnings

    def summarise_hem(self) -> dict[str, Any]:
        """Return the summary of the hem, where there is one to be measured."""
        hem = self.model.hem
        if hem is None:
            return {}

        def measure(state: SheetState, mesh: Mesh) -> HemShape:
            flat = mesh.points if self._turned is None else mesh.points @ self._turned.T
            own = find_hemmed(hem, flat, find_parts([b.connectivity for b in mesh.blocks], len(flat))[1])
            return measure_hem(hem, flat[own], state.position[own], find_half_thickness(state)[own])

        before = None if self._begin is None else measure(self._begin, self._first_mesh)
        released = None if self.released is None else measure(self.sheet(), self.mesh)
        return {HEM: summarise_hem(measure(self.forming.sheet(), self.forming.mesh), before, released)}
