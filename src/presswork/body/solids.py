# SPDX-License-Identifier: Apache-2.0
"""Internal force and tangent stiffness of the workpiece: the bridge from the Model's arrays to the kernels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from presswork import _core
from presswork.body.contract import Look, Near
from presswork.body.heat_of_umat import find_heat
from presswork.body.law_failed import LawFailed, place_increment
from presswork.body.law_window import LawWindow, note_rates
from presswork.body.laws_of_solids import gather_law_history, make_law, make_point_settings
from presswork.body.nodal_pressure import describe_freedom, find_scale
from presswork.body.phase_mixtures import no_mixture
from presswork.body.solid_energy import elastic_energy, stress_in_axes
from presswork.body.turned_inside_out import TurnedInsideOut
from presswork.evolution.points import find_evolved
from presswork.fields.contact_stress import BodyTraction, ContactForces
from presswork.fields.instant import Instant, SolidPoints
from presswork.fields.solid_fields import effective_stress, find_contact
from presswork.law.at_rest import history_at_rest
from presswork.law.elastic_plastic import (
    heats,
    plastic_work_density,
    rate_at_rest,
    temperature,
    temperature_at_rest,
)
from presswork.law.history import EQPS, WORK, list_history
from presswork.law.phase_mixture import FLOW
from presswork.model import FloatArray, IntArray, MaskArray, Material, Model
from presswork.outcome import Step
from presswork.ranks.assembler import DividedAssembler
from presswork.state import CellArrays, NodeArrays, State
from presswork.timing import Timing


@dataclass(frozen=True)
class CellBlock:
    """The arrays of a block's cells that are evaluated here; as in CellArrays."""

    stress: FloatArray
    eqps: FloatArray
    hourglass: FloatArray
    volume: FloatArray
    history: FloatArray
    temperature: FloatArray
    mixture: FloatArray


SolidAssembler = _core.Assembler | _core.SpaceAssembler | _core.MixedAssembler | DividedAssembler
NOISE = 1e-8
"""Strain across the workpiece whose forces are taken for round-off where no larger ones have been."""


class Mechanics:
    """Evaluates all cells of the model over one increment and assembles the result."""

    def __init__(self, model: Model, timing: Timing) -> None:
        self._model = model
        self.freedoms = model.freedoms
        self._timing = timing
        self._settings = make_point_settings(model.solver)
        laws = [make_law(m, model.solver, 6 if model.dimension == 3 else 4) for m in model.materials]
        self._laws = [laws[b.material] for b in model.mesh.blocks]
        self._first_cell = np.cumsum([0, *(len(b.connectivity) for b in model.mesh.blocks)])
        self._when = _core.UmatPlace()
        self._connectivity = [np.ascontiguousarray(b.connectivity, dtype=np.int32) for b in model.mesh.blocks]
        self._evaluated = self._choose_cells()
        self._has_pressure = self.freedoms > model.dimension
        self.pressure_scale = find_scale(model)
        """What the last freedom of a node, a length, is multiplied by to make it a pressure [MPa/mm], if it has one."""
        materials = [model.materials[block.material] for block in model.mesh.blocks]
        self._pressure = [describe_freedom(m, self.pressure_scale) if self._has_pressure else None for m in materials]
        self._start = model.mesh.points
        if self._has_pressure:
            self._start = np.column_stack([self._start, np.zeros(len(self._start))])
        self.assembler = self._make_assembler(None)
        self._couplings: IntArray | None = None
        self.answers_elastically = False
        """Whether plain materials do not flow for now."""
        self.sense = np.where(np.arange(self.freedoms) < model.dimension, 1.0, -1.0)
        """-1 where the residual of a freedom falls as it grows: of a pressure."""
        self.length = np.ones(self.freedoms)
        """What each freedom is multiplied by to make it a length [mm]."""
        self._force: list[FloatArray] = []
        self._stiffness: list[FloatArray] = []
        for connectivity in self._evaluated:
            cells, nodes = connectivity.shape
            packs = -(-cells // _core.pack_width)
            self._force.append(np.zeros((packs, self.freedoms * nodes, _core.pack_width)))
            self._stiffness.append(np.zeros((packs, self.freedoms * nodes, self.freedoms * nodes, _core.pack_width)))

    def _choose_cells(self) -> list[IntArray]:
        """Return the connectivity of the cells that are evaluated here, block by block: all of them."""
        return self._connectivity

    def _make_assembler(self, couplings: IntArray | None) -> SolidAssembler:
        return self._make_core_assembler(self._connectivity, couplings)

    def _make_core_assembler(
        self, connectivity: list[IntArray], couplings: IntArray | None
    ) -> _core.Assembler | _core.SpaceAssembler | _core.MixedAssembler:
        n_points, symmetric = len(self._model.mesh.points), self._model.solver.symmetric
        if self.freedoms == 4:
            return _core.MixedAssembler(n_points, connectivity, symmetric, couplings)
        assembler = _core.SpaceAssembler if self.freedoms == 3 else _core.Assembler
        return assembler(n_points, connectivity, symmetric, couplings)

    @contextmanager
    def answering_elastically(self, beyond: float) -> Iterator[None]:
        """Let cells of isotropic hardening answer elastically, up to so many times their flow stress; nodes in contact
        hang.
        """
        kept, components = self._laws, 6 if self._model.dimension == 3 else 4
        given = [self._material(i) for i in range(len(kept))]
        materials = [replace(m, hardening=m.hardening.scale(beyond)) for m in given if m.hardening is not None]
        self._laws = [make_law(material, self._model.solver, components) for material in materials]
        self.answers_elastically = True
        try:
            yield
        finally:
            self._laws, self.answers_elastically = kept, False

    def couple(self, couplings: IntArray) -> None:
        """Let the matrix hold these node pairs (n, 2) beside those of the cells; a change makes a new assembler."""
        if self._couplings is None or not np.array_equal(couplings, self._couplings):
            self._couplings = couplings
            self.assembler = self._make_assembler(couplings)

    def look_near(self, looks: Sequence[Look], places: FloatArray) -> list[Near]:
        """Return what each look at tools finds of the nodes at places (n_points, 3) [mm]."""
        return [nearest(places, reach) for nearest, reach in looks]

    def at_rest(self) -> State:
        """Return nodes and cells before the first increment."""
        blocks, components = self._model.mesh.blocks, 6 if self._model.dimension == 3 else 4
        sizes = [(len(b.connectivity), _core.element_sizes(b.element)[1]) for b in blocks]
        cells = CellArrays(
            stress=[np.zeros((*size, components)) for size in sizes],
            eqps=[np.zeros(size) for size in sizes],
            temperature=[temperature_at_rest(self._material(i), size) for i, size in enumerate(sizes)],
            rate=[rate_at_rest(self._material(i), size) for i, size in enumerate(sizes)],
            history=[self._keep_at_rest(i, size) for i, size in enumerate(sizes)],
            volume=[np.zeros(size) for size in sizes],
            hourglass=[np.zeros((size[0], 2)) for size in sizes],
            mixture=[no_mixture(n, has_phases=self._material(i).phases is not None) for i, n in enumerate(sizes)],
            kept=[list_history(law, components).without(EQPS) for law in self._laws],
        )
        nodes = NodeArrays.at_rest(len(self._model.mesh.points), self.freedoms)
        return State(nodes, cells, LawWindow.at_rest(self._model.materials))

    def _keep_at_rest(self, block: int, size: tuple[int, int]) -> FloatArray:
        material, components = self._material(block), 6 if self._model.dimension == 3 else 4
        porosity = material.gtn.initial if material.gtn else 0.0
        rolling = material.rolling_direction
        return history_at_rest(self._laws[block], size, components, rolling=rolling, porosity=porosity)

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Keep the increment's place in the run, for laws that use it."""
        self._when = place_increment(step)

    def end_increment(self, state_n: State, trial: State, dt: float) -> None:
        """Find the rates of plastic strain of a converged trial state, after an increment over dt [s]."""
        for i, block in enumerate(self._model.mesh.blocks):
            if trial.cells.rate[i].size and dt > 0.0:
                degrees = self.temperature_at_points(trial, i)
                note_rates(i, block.material, self._material(i), state_n, trial, dt, degrees)

    def force_of_round_off(self) -> float:
        """Nodal force [N] that is nothing even in a workpiece that has never been loaded."""
        model = self._model
        size = float(np.ptp(model.mesh.points, axis=0).max())
        if model.analysis == "solid":
            return NOISE * max(m.young for m in model.materials) * size**2
        axisymmetric = model.analysis == "axisymmetric"
        thickness = 2 * np.pi * float(model.mesh.points[:, 0].max()) if axisymmetric else model.depth
        return NOISE * max(m.young for m in model.materials) * size * thickness

    def evaluate(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool, dt: float = 0.0
    ) -> FloatArray | TurnedInsideOut | LawFailed:
        """Return the internal nodal force (n_points, 2) [N] after `increment` (n_points, 2) [mm] from state_n.

        dt: time of the increment [s], for laws with a strain rate; in no time they answer elastically. Given
        temperatures are those of the trial state.

        Fills the trial state's stress, history and volumes and, if asked, the element stiffnesses. Does not touch
        state_n.
        """
        started = perf_counter()
        bad = self._evaluate_cells(state_n, trial, increment, with_stiffness=with_stiffness, dt=dt)
        if bad is not None:
            self._timing.add("assembly", started)
            return bad
        force: FloatArray = self.assembler.assemble_vector(self._force)
        self._timing.add("assembly", started)
        return force

    def _evaluate_cells(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool, dt: float
    ) -> TurnedInsideOut | LawFailed | None:
        """Fill stress, history and volumes of a trial state, element forces too; return why a cell fails, if so."""
        model = self._model
        points = self._start
        if not model.solver.is_small:
            points = points + state_n.nodes.displacement
        elif self._has_pressure:
            points = np.column_stack([model.mesh.points, state_n.nodes.displacement[:, 3]])
        for i, block in enumerate(model.mesh.blocks):
            fault = _core.LawFault()
            before, now = self._take_block(state_n.cells, i), self._take_block(trial.cells, i)
            failed = _core.evaluate_block(
                block.element,
                self._evaluated[i],
                points,
                increment,
                self._laws[i],
                self._settings,
                axisymmetric=model.analysis == "axisymmetric",
                depth=model.depth,
                hourglass_fraction=model.solver.hourglass_stiffness,
                pressure=self._pressure[i],
                stress_n=before.stress,
                eqps_n=before.eqps,
                hourglass_n=before.hourglass,
                stress=now.stress,
                eqps=now.eqps,
                hourglass=now.hourglass,
                volume=now.volume,
                force=self._force[i],
                stiffness=self._stiffness[i] if with_stiffness else None,
                symmetric=model.solver.symmetric,
                history_n=before.history,
                history=now.history,
                first_cell=int(self._first_cell[i]),
                temperature=now.temperature if now.temperature.size else None,
                temperature_n=before.temperature if before.temperature.size else None,
                when=self._when,
                dt=dt,
                fault=fault,
                mixture=now.mixture if now.mixture.size else None,
            )
            if failed >= 0:
                return TurnedInsideOut(i, failed)
            if fault.status != _core.LawStatus.done:
                return LawFailed.of(i, fault)
            self._keep_block(now, trial.cells, i)
        return None

    def _take_block(self, cells: CellArrays, i: int) -> CellBlock:
        """Return the arrays of a block's cells that are evaluated here."""
        given = (cells.temperature, cells.mixture)
        arrays = (cells.stress, cells.eqps, cells.hourglass, cells.volume, cells.history, *given)
        return CellBlock(*(array[i] for array in arrays))

    def _keep_block(self, block: CellBlock, cells: CellArrays, i: int) -> None:
        """Put evaluated arrays where _take_block has taken them from; these are the arrays themselves."""

    def complete(self, trial: State) -> None:
        """Let a trial state in equilibrium have the arrays of all cells; by one process it has."""

    def assemble_stiffness(self, turned: MaskArray, frames: FloatArray, data: FloatArray) -> None:
        """Fill `data` (nnz) with the stiffness of the last evaluation; turned nodes use their own frames."""
        started = perf_counter()
        self.assembler.assemble_matrix(self._stiffness, turned, frames, data)
        self._timing.add("assembly", started)

    def nodal_flow_stress(self, state: State) -> FloatArray:
        """Return the mean flow stress of the cells round each node (n_points,) [MPa]."""
        return self._spread([self._flow_stress_now(i, state).mean(axis=1) for i in range(len(self._connectivity))])

    def nodal_temperature(self, state: State) -> FloatArray | None:
        """Return the mean temperature of the cells round each node (n_points,) [degrees C]; None: it is not known."""
        blocks = range(len(self._connectivity))
        if any(self._material(i).heating is None for i in blocks):
            return None
        of_points = (self.temperature_at_points(state, i).reshape(state.cells.eqps[i].shape) for i in blocks)
        return self._spread([degrees.mean(axis=1) for degrees in of_points])

    def _spread(self, values: Sequence[FloatArray]) -> FloatArray:
        """Return the mean over the cells round each node (n_points,) of values of each block's cells (n_cells,)."""
        total, count = np.zeros(len(self._model.mesh.points)), np.zeros(len(self._model.mesh.points))
        for connectivity, own in zip(self._connectivity, values, strict=True):
            for column in connectivity.T:
                total += np.bincount(column, own, minlength=len(total))
                count += np.bincount(column, minlength=len(total))
        return total / np.maximum(count, 1)

    def _flow_stress_now(self, block: int, state: State) -> FloatArray:
        """Return the flow stress at the points; for a UMAT and an elastic law, the effective stress."""
        material = self._model.materials[self._model.mesh.blocks[block].material]
        if isinstance(self._laws[block], _core.Umat) or material.is_elastic:
            return effective_stress(state.cells.stress[block])
        return self.flow_stress(block, state)

    def flow_stress(self, block: int, state: State) -> FloatArray:
        """Return the flow stress [MPa] at a block's points at their rates (n_cells, n_points)."""
        law, eqps = self._laws[block], state.cells.eqps[block]
        assert not isinstance(law, _core.Umat)
        flat = np.ascontiguousarray(eqps).ravel()
        if isinstance(law, _core.VonMises):
            flow, _ = law.flow_stress(flat)
        else:
            rate = state.cells.rate[block].ravel() if state.cells.rate[block].size else None
            flow, _ = law.flow_stress(flat, rate, self.temperature_at_points(state, block))
            if self._material(block).phases is not None:
                flow = flow * state.cells.mixture[block][..., FLOW].ravel()
        result: FloatArray = flow.reshape(eqps.shape)
        return result

    def _material(self, block: int) -> Material:
        return self._model.materials[self._model.mesh.blocks[block].material]

    def show(
        self,
        state: State,
        contact: ContactForces | None = None,
        between_bodies: BodyTraction | None = None,
    ) -> Instant:
        """Return what the fields are computed from. contact: forces of the tools; in space no tool touches a body."""
        model, cells = self._model, state.cells
        points = SolidPoints(
            cells.stress, cells.eqps, cells.volume, cells.history, cells.kept, self._temperature(state)
        )
        found = Instant(model, state.nodes.moved, state, points=points, evolved=find_evolved(state))
        if contact is not None and model.analysis != "solid":
            found.find_contact = lambda: find_contact(
                model, state.nodes.displacement, contact, self.nodal_flow_stress(state), between_bodies
            )
        return found

    def _temperature(self, state: State) -> FloatArray | None:
        """Return the cell means of the temperature (n_cells,) [degrees C] where a material knows of it."""
        materials = [self._material(i) for i in range(len(self._laws))]
        if all(material.heating is None for material in materials):
            return None
        parts = []
        for i in range(len(materials)):
            weight = state.cells.volume[i] / state.cells.volume[i].sum(axis=1, keepdims=True)
            degrees = self.temperature_at_points(state, i).reshape(weight.shape)
            parts.append((weight * degrees).sum(axis=1))
        return np.concatenate(parts)

    def temperature_at_points(self, state: State, block: int) -> FloatArray:
        """Return the temperature of a block's points (n,) [degrees C], the rise by the law's own heat included."""
        kept, eqps = state.cells.kept[block], state.cells.eqps[block]
        history = state.cells.history[block].reshape(eqps.size, kept.size)
        return temperature(self._material(block), kept, history, state.cells.temperature[block])

    def extremes(self, state: State) -> dict[str, FloatArray]:
        """Return the values whose extremes the summary reports."""
        stress = np.concatenate([s.reshape(-1, s.shape[-1]) for s in state.cells.stress])
        return {
            "equivalent_plastic_strain": np.concatenate([e.ravel() for e in state.cells.eqps]),
            "effective_stress": effective_stress(stress),
            "hydrostatic_stress": stress[:, :3].mean(axis=1),
            "displacement": np.linalg.norm(state.nodes.moved, axis=1),
        }

    def elastic_dilatation(self, state: State) -> float:
        """Return the volume gained elastically [mm3]: strains are logarithmic, and a volume was V exp(-tr e)."""
        bulk = [self._model.materials[b.material] for b in self._model.mesh.blocks]
        return sum(
            float((-np.expm1(-s[..., :3].sum(axis=-1) * (1 - 2 * m.poisson) / m.young) * v).sum())
            for m, s, v in zip(bulk, state.cells.stress, state.cells.volume, strict=True)
        )

    def elastic_energy(self, state: State) -> float:
        """Return the energy stored elastically [N mm]."""
        return elastic_energy(self._model, state)

    def plastic_work(self, state_n: State, trial: State, dt: float) -> float:
        """Return the plastic work of one increment over dt [s] [N mm], by the trapezoidal rule.

        A UMAT counts all work of its stress, since what it stores elastically only the routine knows.
        """
        return sum(float(work.sum()) for work in self.plastic_work_at_points(state_n, trial, dt))

    def plastic_heat_at_points(self, state_n: State, trial: State, dt: float, fraction: float) -> Iterator[FloatArray]:
        """Yield the heat of an increment over dt [s] at the points of block after block (n_cells, n_points) [N mm].

        fraction: of the plastic work. A UMAT reports its heat, or its dissipation (body/heat_of_umat.py).
        """
        for i, work in enumerate(self.plastic_work_at_points(state_n, trial, dt)):
            if isinstance(self._laws[i], _core.Umat):
                yield find_heat(self._material(i), state_n, trial, i, fraction) * trial.cells.volume[i]
            else:
                yield fraction * work

    def plastic_work_at_points(self, state_n: State, trial: State, dt: float) -> Iterator[FloatArray]:
        """Yield the same of every point, block by block (n_cells, n_points) [N mm]."""
        for i, law in enumerate(self._laws):
            if isinstance(law, _core.Umat):
                work = trial.cells.find_kept(i, WORK)
            elif isinstance(law, _core.VonMises):
                mean_flow = 0.5 * (self.flow_stress(i, state_n) + self.flow_stress(i, trial))
                work = mean_flow * (trial.cells.eqps[i] - state_n.cells.eqps[i])
            else:
                hardens = self._material(i).kinematic is not None  # what alone asks for the stress, and for all that a
                whole = hardens or heats(self._material(i))  # law keeps, but the rise of temperature
                before, after = (gather_law_history(state, i, whole=whole) for state in (state_n, trial))
                stress = stress_in_axes(trial, i) if hardens else trial.cells.stress[i].reshape(len(after), -1)
                given = (state_n.cells.temperature[i], trial.cells.temperature[i])
                kept = trial.cells.kept[i].behind(EQPS, 1)
                mixed = self._material(i).phases is not None
                factor = [s.cells.mixture[i][..., FLOW].ravel() for s in (state_n, trial)] if mixed else None
                work = plastic_work_density(self._material(i), law, kept, before, after, stress, dt, given, factor)
                work = work.reshape(trial.cells.eqps[i].shape)
            yield work * trial.cells.volume[i]
