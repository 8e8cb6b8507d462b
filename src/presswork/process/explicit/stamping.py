# SPDX-License-Identifier: Apache-2.0
"""Stamping by explicit dynamics: stages in rows of cycles, tools that move smoothly, energies watched.

It knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import stop
from presswork.evolution.damage import make_damage
from presswork.explicit.device import refuse
from presswork.explicit.energy import YIELD_OFFSET, EnergyBalance, MassScaling
from presswork.explicit.input_checks import check_damping
from presswork.explicit.mesh_step import MeshStep
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import PHASES, SAFETY, ExplicitShells
from presswork.explicit.space import choose_precision
from presswork.fields.explicit_fields import OnePointFields
from presswork.law.elastic_plastic import first_flow_stress, heats
from presswork.law.umat import open_sheet_law
from presswork.mesh.split import SplitMesh
from presswork.model import BoolArray, ExplicitSheet, FloatArray, Model, Refinement, Stage
from presswork.observe.of_model import list_observers
from presswork.process.explicit.explicit_heat import ExplicitHeat
from presswork.process.explicit.loose_rows import LooseRows
from presswork.process.explicit.sheet_history import SheetHistory
from presswork.process.explicit.stamping_recording import SheetProgress, StampingRecording
from presswork.process.line.laying import find_sag
from presswork.process.mesh_change.refinement import choose_shells, find_planes, place_nodes
from presswork.process.mesh_change.transfer import SheetState, ShellStart, fill_layers, keep_heated, sheet_of_explicit
from presswork.process.model_recording import NamedArrays
from presswork.process.stamping_tools import StampingTools, mean_speeds
from presswork.ranks.world import World

ELEMENT_CYCLES_A_CALL = {"cpu": 2_000_000, "host": 2_000_000, "cuda": 200_000_000}
"""Between two looks at the keyboard: about a second."""
SAMPLES = 10
"""Of the tools' forces in a row, at least: single cycles are noisy."""
START = "start."
"""Prefix in a checkpoint of what the shells of a later operation start from."""
LOOKS = 50
"""A stage, at shells that may have to be split, and at the step of the mesh: once in 2 % of it."""


class ExplicitStamping(StampingRecording):
    """A stamping at work."""

    model: Model

    def __init__(
        self,
        model: Model,
        *,
        threads: int = 0,
        begin: SheetState | None = None,
        level: int = 0,
        world: World | None = None,
    ) -> None:
        """begin: the sheet that an operation before has left, on the model's mesh; None: the blank.

        level: how often its shells have been split by then. world: ranks that share the cycles.
        """
        self._world = world
        assert isinstance(model.explicit, ExplicitSheet)
        super().__init__(model, threads, SheetProgress(model.output.rows), (*PHASES, "rest"))
        self._start = None if begin is None else ShellStart.of(begin)
        self.settings = model.explicit
        self._first_level = level
        self._sheet = self._begin_split()
        self._judged = model.sheet[1].formability
        self._damage_laws = make_damage(model.sheet[1].damage, model.sheet[1].umat, is_solid=False)
        self.shells = self._make_shells()
        self._mesh_step: MeshStep | None = None
        if begin is not None:
            fill_layers(self.shells, begin)
        self._mass = float(self.shells.mass[:, 0].sum())
        self._reaction = np.zeros((len(model.mesh.points), 6))
        material = model.sheet[1]
        yield_stress = first_flow_stress(material)
        self._formed = YIELD_OFFSET * yield_stress * self._mass / material.density
        if self.settings.target_step is not None:
            self._scale_mass(self.settings.target_step)
        check_damping(self.settings.damping, self._longest_step())
        if model.self_contact is not None:
            self.shells.touch_itself(mu=model.self_contact.mu, undeformed=model.mesh.points)
        sag = 0.0 if begin is None else float(np.linalg.norm(find_sag(begin)[1], axis=1).max())
        self.tools = StampingTools(model, self.shells, sag=sag)
        self.heat = ExplicitHeat(model, self.shells, self.tools.at_work) if model.heat else None
        self.layers = SheetHistory(model, self.shells)
        if begin is not None:
            self.layers.take(begin.blocks)
        self.loose = LooseRows(model)
        self.begin_stage()
        self.shells.find_contact()

    def _make_shells(self) -> ExplicitShells:
        """Make shells of the undeformed mesh as it is split now, and what makes fields of them."""
        model = self.model
        section, material = model.sheet
        assert section.rule != "simpson"
        law = open_sheet_law(material)
        self._precision = self.settings.precision or choose_precision(law)
        if model.refinement:
            refuse(self.settings.device, "refined sheets")
        rolling, self._cells = np.asarray(model.rolling_direction), model.cells
        self._fields = OnePointFields(model.mesh, self._cells, section, rolling, model.symmetry)
        start = self._start
        return ExplicitShells(
            model.mesh.points if start is None else start.position,
            self._cells,
            section.thickness if start is None else start.thickness,
            law,
            material.density,
            axis=rolling if start is None else start.axis,
            damage=self._damage_laws,
            heating=(material.heating.start if material.heating else 20.0, heats(material)),
            options=ShellOptions(
                element=self.settings.element,
                n_points=section.points,
                rule=section.rule,
                ironing=self.settings.ironing,
            ),
            precision=self._precision,
            device=self.settings.device,
            hanging=self._sheet.hanging(),
            world=self._world,
        )

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        stage, rows = self.model.stages[number], self.model.output.rows
        if row % max(1, rows // LOOKS) == 0:
            if self.model.refinement:
                self._refine(self.model.refinement)
            if self.settings.step_bound == "mesh":
                self._mesh_step = self._mesh_step or MeshStep(self.shells, self._precision)
                last = self._progress.mesh_factor
                self._progress.mesh_factor = float(self._mesh_step.find_factor(self.shells, last))
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
        every, most = max(1, n // SAMPLES), max(1, ELEMENT_CYCLES_A_CALL[self.settings.device] // n_shells)
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
        if not self.tools.hold_sheet:
            self.loose.end_row(self.model, self._progress.stage, self.shells, self.shells.mass[:, 0])
        energies = self._energies(stage, end)
        self._progress.cycles += n
        self._progress.shell_cycles += n * n_shells
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
        self._progress.mesh_factor = 0.0
        planes, tools = find_planes(self.mesh), self.tools.placed()
        position = place_nodes(self._sheet, step, old.position, old.thickness, planes, tools)
        self._sheet = step.mesh
        if (start := self._start) is not None:
            place, parent = step.interpolate(start.position), step.parent
            self._start = ShellStart(place, start.thickness[parent], start.axis[parent])
        self.begin_epoch(step.apply(self.mesh))
        self._make_again()
        self.begin_stage()
        self.shells.inherit(old, position, step.node_parents(), step.parent)
        self.layers.split(step.parent)

    def _begin_split(self) -> SplitMesh:
        """Return the present mesh before this operation has split any shell."""
        sheet = SplitMesh.begin(self.model.cells, len(self.model.mesh.points))
        return replace(sheet, level=sheet.level + self._first_level)

    @property
    def level(self) -> int:
        """How often the shells that were split most have been split."""
        return int(self._sheet.level.max())

    def split_evenly(self) -> None:
        """Split all shells as often as those split most, so that no node hangs."""
        while len(self._sheet.hanging()):
            level = self._sheet.level
            self._split(level < level.max())

    def _make_again(self) -> None:
        """Make shells and tools anew for the present mesh; pushed tools keep their masses."""
        self.shells, self._mesh_step = self._make_shells(), None
        self._reaction = np.zeros((len(self.mesh.points), 6))
        self.tools = StampingTools(self.model, self.shells, self.tools)
        self.observers = list_observers(self.model)

    def _longest_step(self) -> float:
        """Return the time step allowed now; add mass where the target asks for it."""
        settings, bound = self.settings, self.shells.stable_step() * max(1.0, self._progress.mesh_factor)
        if settings.target_step is None:
            return settings.safety * bound
        if settings.safety * bound < settings.target_step * (1 - 1e-9):
            self._scale_mass(settings.target_step)
        return settings.target_step

    def _scale_mass(self, target: float) -> MassScaling:
        """Add mass so that the target is `safety` times the stable step."""
        scaling = self.shells.scale_mass(target * SAFETY / self.settings.safety)
        self._progress.added_mass = scaling.percent
        return scaling

    def tool_forces(self) -> FloatArray:
        """Return the mean forces on the tools in the last row (n_tools, 3) [N]."""
        return self.tools.forces()

    def begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe."""
        number = self._progress.stage
        self._prescribe(self.shells)
        self.tools.begin_stage(number)
        if number < len(self.model.stages):
            self.shells.set_slower(self.model.stages[number].slower)

    def _energies(self, stage: Stage, time: float) -> EnergyBalance:
        """Return the energies; the next half step goes on with the present speed."""
        dt = self.shells.dt
        speed = float(mean_speeds(stage, time - dt, time, 1)[0])
        return self.shells.energies(damping=self.settings.damping, velocity_scale=speed)

    def sheet(self) -> SheetState:
        """Return the present state of the sheet."""
        return replace(sheet_of_explicit(self.shells, self.layers.values), heated=keep_heated(self.show()))

    def _epoch_arrays(self) -> NamedArrays:
        sheet, start = self._sheet, self._start
        if not self.epoch:
            return super()._epoch_arrays()
        begun = {} if start is None else {f"{START}{name}": values for name, values in vars(start).items()}
        return {"level": sheet.level, "side": sheet.side, "middle": sheet.middle, **begun, **super()._epoch_arrays()}

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        sheet = self._begin_split()
        if self.epoch:
            sheet = replace(sheet, level=epoch["level"], side=epoch["side"], middle=epoch["middle"])
        if self.epoch and self._start is not None:
            begun = {name: values for name, values in epoch.items() if name.startswith(START)}
            self._start = ShellStart(**{name.removeprefix(START): values for name, values in begun.items()})
        self._sheet = sheet
        self._make_again()
        self.layers.start(self.shells)

    def _keep_run(self) -> Callable[[], Mapping[str, NDArray[Any]]] | None:
        return self.shells.keep()

    def _state_arrays(self) -> NamedArrays:
        return self._arrays_beside_run() | self.shells.dump()

    def _arrays_beside_run(self) -> NamedArrays:
        heat = self.heat.dump() if self.heat else {}
        return {**self._progress.to_arrays(), **self.layers.dump(), **heat, **self.loose.to_arrays()}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._take_up(arrays)
        self.layers.restore(arrays)
        self.loose.load_arrays(arrays)
        self.shells.restore(arrays)
        if self.heat is not None:
            self.heat.restore(arrays)
        self.begin_stage()
