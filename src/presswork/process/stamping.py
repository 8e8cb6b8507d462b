# SPDX-License-Identifier: Apache-2.0
"""Stamping by explicit dynamics: stages in rows of cycles, tools that move smoothly, energies watched.

It knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import stop
from presswork.evolution.damage import make_damage
from presswork.explicit.energy import YIELD_OFFSET, EnergyBalance, MassScaling, warn_of_energies
from presswork.explicit.input_checks import check_damping
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import PHASES, SAFETY, ExplicitShells
from presswork.fields.explicit_fields import OnePointFields
from presswork.fields.formability_fields import FormingVerdict, judge_fields
from presswork.fields.instant import Instant
from presswork.fields.shell_fields import state_variable_field, temperature_field
from presswork.fields.table import compute_fields
from presswork.law.elastic_plastic import first_flow_stress, heats
from presswork.law.umat import open_sheet_law
from presswork.mesh.split import SplitMesh
from presswork.model import BoolArray, ExplicitSheet, FloatArray, Model, Refinement, Stage
from presswork.process.epochs import NamedArrays
from presswork.process.explicit_heat import ExplicitHeat, names_of_heat
from presswork.process.heat_quantities import columns_of_sheet, measure_sheet_heat, summarise_sheet_heat, warn_of_tables
from presswork.process.held_flange import warn_of_holders
from presswork.process.limits import Watched, measure_sheet_penetration, watch_sheet
from presswork.process.marked_points import MarkedPoints
from presswork.process.peaks import find_peaks, peak_row
from presswork.process.press_quantities import RAM_COLUMNS, has_ram, summarise_ram
from presswork.process.reactions import Reactions
from presswork.process.recording import Row, Snapshot, find_never_touched
from presswork.process.refinement import choose_shells, find_planes, place_nodes
from presswork.process.rows import LAST_COLUMNS, STAGE, RowRecording, RowReport, last_energies, process_time
from presswork.process.sheet_history import SheetHistory
from presswork.process.space_surfaces import cut_tools
from presswork.process.stamping_tools import StampingTools, describe_stamping, mean_speeds
from presswork.process.transfer import SheetState, keep_heated, sheet_of_explicit

CYCLES, ADDED_MASS, SHELL_CYCLES = range(2, 5)
"""Of the progress, after stage and row."""
ELEMENT_CYCLES_A_CALL = 2_000_000
"""Between two looks at the keyboard: about a second."""
SAMPLES = 10
"""Of the tools' forces in a row, at least: single cycles are noisy."""
LOOKS = 50
"""A stage, at shells that may have to be split: once in 2 % of it."""


class ExplicitStamping(RowRecording):
    """A stamping at work."""

    model: Model

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        assert isinstance(model.explicit, ExplicitSheet)
        super().__init__(model, threads, 6, (*PHASES, "rest"))
        self.settings = model.explicit
        self._sheet = SplitMesh.begin(model.cells, len(model.mesh.points))
        self._judged = model.sheet[1].formability
        self._damage_laws = make_damage(model.sheet[1].damage, model.sheet[1].umat, is_solid=False)
        self.shells = self._make_shells()
        self._mass = float(self.shells.mass[:, 0].sum())
        self.reactions = Reactions(model, 6, [t.name for t in model.tools])
        self._reaction = np.zeros((len(model.mesh.points), 6))
        material = model.sheet[1]
        yield_stress = first_flow_stress(material)
        self._formed = YIELD_OFFSET * yield_stress * self._mass / material.density
        if self.settings.target_step is not None:
            self._scale_mass(self.settings.target_step)
        check_damping(self.settings.damping, self._longest_step())
        self.tools = StampingTools(model, self.shells)
        self.heat = ExplicitHeat(model, self.shells, self.tools.at_work) if model.heat else None
        self.layers = SheetHistory(model, self.shells)
        self.marked = MarkedPoints(model)
        self._begin_stage()
        self.shells.find_contact()

    def _make_shells(self) -> ExplicitShells:
        """Make shells of the undeformed mesh as it is split now, and what makes fields of them."""
        model = self.model
        section, material = model.sheet
        assert section.rule != "simpson"
        rolling, self._cells = model.rolling_direction, model.cells
        self._fields = OnePointFields(model.mesh, self._cells, section, np.asarray(rolling), model.symmetry)
        return ExplicitShells(
            model.mesh.points,
            self._cells,
            section.thickness,
            open_sheet_law(material),
            material.density,
            axis=rolling,
            damage=self._damage_laws,
            heating=(material.heating.start if material.heating else 20.0, heats(material)),
            options=ShellOptions(
                element=self.settings.element,
                n_points=section.points,
                rule=section.rule,
                ironing=self.settings.ironing,
            ),
            precision=self.settings.precision,
            hanging=self._sheet.hanging(),
        )

    # --- the way through ---------------------------------------------------------------------------------------------

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        stage, rows = self.model.stages[number], self.model.output.rows
        if self.model.refinement and row % max(1, rows // LOOKS) == 0:
            self._refine(self.model.refinement)
        begin, end = (stage.duration * r / rows for r in (row, row + 1))
        if self.heat is not None:
            self.heat.begin_row()
        self.layers.begin_row(self.shells)
        found = self._compute_cycles(stage, begin, end)
        self.layers.end_row(self.shells, stage.slower * (end - begin))
        return found

    def _compute_cycles(self, stage: Stage, begin: float, end: float) -> tuple[int, float, EnergyBalance]:
        """Compute a row of cycles, or of a dwell, from one time of a stage to another [s]; return as _compute_row."""
        n_shells = len(self._cells)
        if stage.dwell is not None:
            return self._compute_dwell(stage, end - begin)
        n = int(np.ceil((end - begin) / self._longest_step() * (1 - 1e-12)))
        self.shells.dt = (end - begin) / n
        every, most = max(1, n // SAMPLES), max(1, ELEMENT_CYCLES_A_CALL // n_shells)
        self.tools.begin_row()
        self.shells.reset_reaction()
        self._seconds_n = self.shells.seconds
        for part in np.split(mean_speeds(stage, begin, end, n), range(every, n, every)):
            for speeds in np.split(part, range(most, len(part), most)):
                self.shells.advance(len(speeds), velocity_scale=speeds, damping=self.settings.damping)
            self.tools.sample()
            if self.heat is not None:
                self.heat.sample()
            stop.look()
        self._reaction = self.shells.reaction_impulse / (end - begin)
        energies = self._energies(stage, end)
        self._progress[[CYCLES, SHELL_CYCLES]] += (n, n * n_shells)
        if self.heat is not None:
            self.heat.advance(stage.slower * (end - begin), None)
        return n, self.shells.dt, energies

    def _compute_dwell(self, stage: Stage, dt: float) -> tuple[int, float, EnergyBalance]:
        """Let heat alone flow for a row of dt [s]; shells and tools stay as they are."""
        assert self.heat is not None
        assert stage.dwell is not None
        self.tools.begin_row()
        self.tools.sample()
        self._seconds_n = self.shells.seconds
        self._reaction = np.zeros_like(self._reaction)
        self.heat.advance(dt, stage.dwell)
        self.shells.time += dt
        return 0, dt, self.shells.energies(damping=self.settings.damping, velocity_scale=0.0)

    def _add_time(self, started: float) -> None:
        """Share out the time since `started`, by what the shells' clock said then and says now."""
        spent = {phase: now - self._seconds_n[phase] for phase, now in self.shells.seconds.items()}
        for phase, seconds in spent.items():
            self.timing.add_seconds(phase, seconds)
        self.timing.add_seconds("rest", perf_counter() - started - sum(spent.values()))

    def _refine(self, refinement: Refinement) -> None:
        """Split the shells that are bent, or will be; again, as far as there are levels."""
        for _ in range(refinement.levels):
            shells, tools, planes = self.shells, self.tools.placed(), find_planes(self.mesh)
            chosen = choose_shells(self._sheet, shells.position, shells.thickness, tools, refinement, planes)
            if not chosen.any():
                return
            self._split(chosen)

    def _split(self, chosen: BoolArray) -> None:
        """Split the chosen shells (n,), and others as far as neighbours would be more than a level apart."""
        old, step = self.shells, self._sheet.split(chosen)
        planes, tools = find_planes(self.mesh), self.tools.placed()
        position = place_nodes(self._sheet, step, old.position, old.thickness, planes, tools)
        self._sheet = step.mesh
        self._begin_epoch(step.apply(self.mesh))
        self._make_again()
        self._begin_stage()
        self.shells.inherit(old, position, step.node_parents(), step.parent)
        self.layers.split(step.parent)

    def split_evenly(self) -> None:
        """Split all shells as often as those split most, so that no node hangs."""
        while len(self._sheet.hanging()):
            level = self._sheet.level
            self._split(level < level.max())

    def _make_again(self) -> None:
        """Make shells and tools anew for the present mesh; pushed tools keep their masses."""
        self.shells = self._make_shells()
        self._reaction = np.zeros((len(self.mesh.points), 6))
        self.tools = StampingTools(self.model, self.shells, self.tools)
        self.marked = MarkedPoints(self.model)

    def _longest_step(self) -> float:
        """Return the time step allowed now; add mass where the target asks for it."""
        settings, bound = self.settings, self.shells.stable_step()
        if settings.target_step is None:
            return settings.safety * bound
        if settings.safety * bound < settings.target_step * (1 - 1e-9):
            self._scale_mass(settings.target_step)
        return settings.target_step

    def _scale_mass(self, target: float) -> MassScaling:
        """Add mass so that the target is `safety` times the stable step."""
        scaling = self.shells.scale_mass(target * SAFETY / self.settings.safety)
        self._progress[ADDED_MASS] = scaling.percent
        return scaling

    def _tool_forces(self) -> FloatArray:
        return self.tools.forces()

    def _begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe."""
        number = int(self._progress[STAGE])
        self._prescribe(self.shells)
        self.tools.begin_stage(number)
        if number < len(self.model.stages):
            self.shells.set_slower(self.model.stages[number].slower)

    def _energies(self, stage: Stage, time: float) -> EnergyBalance:
        """Return the energies; the next half step goes on with the present speed."""
        dt = self.shells.dt
        speed = float(mean_speeds(stage, time - dt, time, 1)[0])
        return self.shells.energies(damping=self.settings.damping, velocity_scale=speed)

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        first = ["time", "stage", "increment", "cycles", *self.tools.row()]
        first += [*(RAM_COLUMNS if has_ram(self.model) else ()), *self.reactions.columns]
        first += [f"{law.name}_max" for law in self._damage_laws]
        first += ["shells"] if self.model.refinement else []
        if self.heat is not None:
            first += ["process_time", *columns_of_sheet(self.heat.sheet, self.heat.arrays)]
        return [*first, *self.marked.columns(self.show()), *LAST_COLUMNS]

    def begin_log(self) -> str:
        """Name the procedure and what it starts with."""
        return (
            f"explicit: {len(self._cells)} shells, stable step "
            f"{self.shells.stable_step():.3g} s, added mass {self.added_mass:.3g} %"
        )

    def log_lines(self, report: RowReport) -> list[str]:
        """Say where the row ended, and which energies are beyond their limits."""
        return [*super().log_lines(report), *(f"warning: {each}" for each in report.energies.warnings(self._formed))]

    def progress_text(self, report: RowReport) -> str:
        """Name stage, tools and cycle: what a narrow terminal cuts off comes last."""
        return "  ".join(t for t in (f"{report.stage}:", self.tools.text(), f"cycle {self._progress[CYCLES]:.0f}") if t)

    def row(self, report: RowReport) -> Row:
        """Return the row of the history."""
        return {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "cycles": int(self._progress[CYCLES]),
            **self.tools.row(),
            **self._ram_row(report),
            **self._measure_reactions(),
            **peak_row(self._evolved()),
            **({"shells": len(self._cells)} if self.model.refinement else {}),
            **(self._measure_heat() if self.heat else {}),
            **(self.marked.measure(self.show()) if self.model.points else {}),
            **self._end_row(report),
        }

    def _measure_heat(self) -> Row:
        assert self.heat is not None
        past = process_time(self.model.stages, self.shells.time)
        return {"process_time": past, **measure_sheet_heat(self.heat.sheet, self.heat.arrays)}

    def _measure_reactions(self) -> Row:
        """Return the means over the last row."""
        mesh = self.model.mesh
        moved = np.zeros((len(mesh.points), 6))
        moved[:, :3] = self.shells.position - mesh.points
        return self.reactions.measure(mesh, self._stage_of_row(), self._reaction, moved)

    def show(self) -> Instant:
        """Return what the fields of the present state are computed from."""
        return Instant(
            self.model,
            self.shells.position - self.model.mesh.points,
            reaction=self._reaction,
            tool_force=self.shells.contact_force,
            find_sheet=self._cell_fields,
            evolved=self._evolved(),
            judged=self._judged,
            **(self.heat.show() if self.heat else {}),
        )

    def snapshot(self, now: Instant | None = None) -> Snapshot:
        """Return the fields of the present state. now: what they are computed from, of `show`."""
        points, cells = compute_fields(now or self.show())
        return Snapshot(
            time=self.shells.time,
            point_data=points,
            cell_data=cells,
            info=describe_stamping(self.model),
            surfaces=cut_tools(self.model),
            tool_displacement=self.tools.displacement(),
        )

    def _cell_fields(self) -> dict[str, FloatArray]:
        shells, history = self.shells, self.shells.history_at_points
        fields = self._fields.cell_fields(
            shells.position, shells.thickness, shells.flow_stress_at_points, shells.pressure_at_points, history[..., 0]
        )
        material = self.model.sheet[1]
        degrees = temperature_field(material, history, self.shells.given_temperature)
        return fields | degrees | state_variable_field(material, history)

    def _evolved(self) -> dict[str, list[FloatArray]]:
        """Return what evolution laws keep at the layers by quantity and block of the mesh (n_cells, q k)."""
        return self.layers.show(self.shells, self.model.mesh)

    def _judge(self, fields: Mapping[str, FloatArray]) -> FormingVerdict:
        """Return the verdict on the sheet by its cell fields."""
        position = self.shells.position
        centres = np.concatenate([position[b.connectivity].mean(axis=1) for b in self.model.mesh.blocks])
        verdict = judge_fields(fields, centres, self._judged)
        assert verdict is not None, "shells have principal strains"
        return verdict

    def watch(self) -> Watched:
        """Return how far the present state is towards its limits."""
        thickness = self.model.sheet[0].thickness
        depths = [measure_sheet_penetration(t.name, t.penetration, thickness) for t in self.shells.tools.values()]
        strained = watch_sheet(self._judge(self._cell_fields()))
        critical: dict[str, list[float | None]] = {
            law.name: [law.critical.get(law.name)] * len(self.model.mesh.blocks) for law in self._damage_laws
        }
        peaks = find_peaks(self.model.mesh, self.shells.position, self._evolved(), critical)
        return Watched((*strained.measures, *depths), strained.margin, peaks)

    def sheet(self) -> SheetState:
        """Return the present state of the sheet."""
        return replace(sheet_of_explicit(self.shells, self.layers.values), heated=keep_heated(self.show()))

    @property
    def time(self) -> float:
        """[s]"""
        return self.shells.time

    @property
    def added_mass(self) -> float:
        """Per cent of the true mass."""
        return float(self._progress[ADDED_MASS])

    def row_at_rest(self) -> Row:
        """Return the row of the history once the part is released: strokes, and what the energies have come to."""
        energies = self.shells.energies(damping=self.settings.damping, velocity_scale=0.0)
        report = RowReport(self.number, "", 1.0, self.time, 0, self.shells.dt, energies, is_save_point=True)
        gone = {
            f"{t.name}.{force}": 0.0 for t in self.model.tools for force in ("force", "force_x", "force_y", "force_z")
        }
        return self.row(report) | gone | self.reactions.nothing() | self._ram_at_rest() | {"kinetic_energy": 0.0}

    def _epoch_arrays(self) -> NamedArrays:
        sheet = self._sheet
        return {"level": sheet.level, "side": sheet.side, "middle": sheet.middle} if self.epoch else {}

    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        sheet = SplitMesh.begin(self.model.cells, len(self.mesh.points))
        if self.epoch:
            sheet = replace(sheet, level=epoch["level"], side=epoch["side"], middle=epoch["middle"])
        self._sheet = sheet
        self._make_again()
        self.layers.start(self.shells)

    def _state_arrays(self) -> NamedArrays:
        heat = self.heat.dump() if self.heat else {}
        return {"progress": self._progress.copy(), **self.shells.dump(), **self.layers.dump(), **heat}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._take_up(arrays)
        heated = names_of_heat(arrays) | set(self.layers.dump())
        self.layers.restore(arrays)
        self.shells.restore({name: np.asarray(values) for name, values in arrays.items() if name not in heated})
        if self.heat is not None:
            self.heat.restore(arrays)
        self._begin_stage()

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and energies, with warnings where they are beyond their limits."""
        shells = self.shells
        fields = self._cell_fields()
        verdict = self._judge(fields)
        names = ("equivalent_plastic_strain", "effective_stress", "thickness", "thickness_strain")
        cycles = int(self._progress[CYCLES])
        names_of_tools = [t.name for t in self.model.tools]
        return {
            "increments": self.number,
            "cycles": cycles,
            "work": f"{cycles} cycles of {self._progress[SHELL_CYCLES] / max(cycles, 1):.0f} shells",
            "freedoms": 6 * len(self.model.mesh.points),
            "extremes": {name: [float(fields[name].min()), float(fields[name].max())] for name in names},
            "mass": {"blank_t": self._mass, "added_percent": self.added_mass},
            "energy": last_energies(history),
            "time_simulated": shells.time,
            **summarise_ram(self.model, history),
            **({"heat": summarise_sheet_heat(self.heat.sheet, self.heat.arrays)} if self.heat else {}),
            **self.layers.summarise(),
            "formability": verdict.to_summary(),
            "warnings": [
                *(f"the tool {name} never touched the blank" for name in find_never_touched(names_of_tools, history)),
                *warn_of_holders(self.model, history, float(fields["thickness"].max())),
                *warn_of_energies(history),
                *verdict.warnings(),
                *(warn_of_tables(self.model, history) if self.heat else ()),
                *self.layers.warnings(),
            ],
        }
