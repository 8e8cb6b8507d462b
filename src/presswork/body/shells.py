# SPDX-License-Identifier: Apache-2.0
"""Internal force and tangent stiffness of shells: what solids.py is for solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from presswork import _core
from presswork.body.contract import Look, Near
from presswork.body.law_failed import LawFailed, place_increment
from presswork.body.law_window import LawWindow, note_rates
from presswork.body.model_directors import find_drilling, find_model_directors, turn_vectors
from presswork.body.shell_arrays import ShellArrays, ShellBlock
from presswork.body.shell_energy import elastic_energy, plastic_work, plastic_work_at_layers
from presswork.evolution.points import find_evolved
from presswork.fields.contact_stress import BodyTraction, ContactForces
from presswork.fields.evolved_layers import find_path_margins
from presswork.fields.instant import Instant
from presswork.fields.shell_fields import (
    ShellGeometry,
    ShellLayers,
    sheet_effective_stress,
    shell_cell_fields,
)
from presswork.law.at_rest import fill_history
from presswork.law.elastic_plastic import rate_at_rest, temperature, temperature_at_rest
from presswork.law.history import EQPS
from presswork.law.umat import SheetUmat, list_sheet_history, open_sheet_law
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import CellBlock, FloatArray, IntArray, MaskArray, Model
from presswork.outcome import BadGuess, Step
from presswork.ranks.assembler import DividedAssembler
from presswork.state import CellArrays, NodeArrays, State
from presswork.timing import Timing

UPRIGHT = 0.99
"""Part of the rolling direction along the normal above which it cannot be laid into the sheet."""
NOISE = 1e-8
"""Strain of bending across the sheet whose forces are taken for round-off where no larger ones have been."""
REASONS = {
    _core.ShellFault.inside_out: "turned inside out",
    _core.ShellFault.turned_too_far: "turned by more than 3 rad in one increment",
    _core.ShellFault.law: "found no stress on the yield surface",
    _core.ShellFault.bubble: "found no balance of its bubble",
}


@dataclass(frozen=True)
class ShellFailed(BadGuess):
    """A shell that could not be evaluated; the increment must be cut."""

    block: int
    cell: int
    fault: _core.ShellFault

    def __str__(self) -> str:
        return f"cell {self.cell} of block {self.block} {REASONS[self.fault]}"


ShellAssembler = _core.ShellAssembler | DividedAssembler


def measure_shells(points: FloatArray, block: CellBlock) -> tuple[FloatArray, FloatArray]:
    """Return the shape functions at the points in the plane (q, n), and the area of each (n_cells, q) [mm2]."""
    N, slopes, weights, _ = _core.shell_shape(block.element)
    base = np.einsum("qaj,cai->cqji", slopes, points[block.connectivity])
    return N, np.linalg.norm(np.cross(base[:, :, 0], base[:, :, 1]), axis=2) * weights


class ShellMechanics:
    """Evaluates all shells of the model over one increment and assembles the result."""

    freedoms = 6

    def __init__(self, model: Model, timing: Timing) -> None:
        self._model = model
        self._timing = timing
        blocks = model.mesh.blocks
        laws = [open_sheet_law(m) for m in model.materials]
        self._laws = [laws[b.material] for b in blocks]
        self._sections = [b.section for b in blocks if b.section is not None]
        if len(self._sections) != len(blocks):
            raise ValueError("every block of shells needs a section")
        self._rules = [thickness_rule(s) for s in self._sections]
        self._connectivity = [np.ascontiguousarray(b.connectivity, dtype=np.int32) for b in blocks]
        self.directors = find_model_directors(model)
        self._evaluated = self._choose_cells(self._connectivity)
        self._directors_of = self._choose_cells(self.directors.of_cell)
        self.assembler = self._make_assembler(None)
        self._couplings: IntArray | None = None
        self.drilling = find_drilling(self.directors)
        self._first_cell = np.cumsum([0, *(len(c) for c in self._connectivity)])
        self._when = _core.UmatPlace()
        self._force: list[FloatArray] = []
        self._stiffness: list[FloatArray] = []
        for connectivity in self._evaluated:
            cells, nodes = connectivity.shape
            packs = -(-cells // _core.pack_width)
            self._force.append(np.zeros((packs, 6 * nodes, _core.pack_width)))
            self._stiffness.append(np.zeros((packs, 6 * nodes, 6 * nodes, _core.pack_width)))
        area = sum(float(measure_shells(model.mesh.points, b)[1].sum()) for b in blocks)
        size = float(np.sqrt(area / sum(len(c) for c in self._connectivity)))
        self.length = np.array([1.0, 1.0, 1.0, size, size, size])
        self.sense = np.ones(6)

    def _choose_cells(self, of_cells: list[IntArray]) -> list[IntArray]:
        """Return the values that are known of cells, block by block, of those that are evaluated here: all of them."""
        return of_cells

    def _make_assembler(self, couplings: IntArray | None) -> ShellAssembler:
        return self._make_core_assembler(self._connectivity, couplings)

    def _make_core_assembler(self, connectivity: list[IntArray], couplings: IntArray | None) -> _core.ShellAssembler:
        n_points, symmetric = len(self._model.mesh.points), self._model.solver.symmetric
        return _core.ShellAssembler(n_points, connectivity, symmetric, couplings)

    def at_rest(self) -> State:
        """Return nodes and cells before the first increment."""
        cells_at_rest = CellArrays([], [], [], [], [], [], [])
        shells = ShellArrays(self.directors.vectors.copy(), [], [], [], [])
        for i, (connectivity, section, law) in enumerate(
            zip(self._connectivity, self._sections, self._laws, strict=True)
        ):
            cells = len(connectivity)
            _, q, internal = _core.shell_sizes(self._model.mesh.blocks[i].element)
            k = section.points
            shells.thickness.append(np.tile(self._model.mesh.blocks[i].thickness[:, None], q))
            kept = list_sheet_history(law)
            cells_at_rest.kept.append(kept)
            cells_at_rest.history.append(fill_history(kept, (cells, q, k)))
            shells.direction.append(np.repeat(self._first_directions(i)[:, :, None], k, axis=2))
            shells.shear.append(np.zeros((cells, q, 2)))
            shells.internal.append(np.zeros((cells, internal)))
            cells_at_rest.stress.append(np.zeros((cells, q * k, 3)))
            cells_at_rest.eqps.append(np.zeros((cells, q * k)))
            material = self._model.materials[self._model.mesh.blocks[i].material]
            cells_at_rest.temperature.append(temperature_at_rest(material, (cells, q * k)))
            cells_at_rest.rate.append(rate_at_rest(material, (cells, q * k)))
            cells_at_rest.volume.append(np.zeros((cells, q * k)))
        nodes = NodeArrays.at_rest(len(self._model.mesh.points), 6)
        return State(nodes, cells_at_rest, shells, LawWindow.at_rest(self._model.materials))

    def _first_directions(self, block: int) -> FloatArray:
        """Return g_1 in the lamina frame (n_cells, q, 2), whose x is the rolling direction laid into the sheet, or the
        axis after it (y for x) where that stands upright.
        """
        cells = self._model.mesh.blocks[block]
        slopes = _core.shell_shape(cells.element)[1]
        base = np.einsum("qaj,cai->cqji", slopes, self._model.mesh.points[cells.connectivity])
        normal = np.cross(base[:, :, 0], base[:, :, 1])
        normal /= np.linalg.norm(normal, axis=2, keepdims=True)
        rolling = np.asarray(cells.rolling or self._model.rolling_direction)
        upright = np.abs(normal @ rolling)[..., None] > UPRIGHT
        axis = np.where(upright, np.roll(rolling, 1), rolling)
        axis = axis - (axis * normal).sum(axis=2, keepdims=True) * normal
        axis /= np.linalg.norm(axis, axis=2, keepdims=True)
        first = base[:, :, 0] / np.linalg.norm(base[:, :, 0], axis=2, keepdims=True)
        return np.stack([(first * axis).sum(axis=2), (first * np.cross(normal, axis)).sum(axis=2)], axis=2)

    def evaluate(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool, dt: float = 0.0
    ) -> FloatArray | ShellFailed | LawFailed:
        """Return the internal nodal force (n_points, 6) [N, N mm] after `increment` (n_points, 6) from state_n.

        dt: time of the increment [s], for laws with a strain rate; in no time they answer elastically. Given
        temperatures are those of the trial state.

        Fills the trial state's stress, history, thickness and volumes and, if asked, the element stiffnesses. Does not
        touch state_n.
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
    ) -> ShellFailed | LawFailed | None:
        """Fill what shells keep in a trial state, element forces too; return why a cell fails, if so."""
        model = self._model
        is_small = model.solver.is_small
        points = model.mesh.points if is_small else model.mesh.points + state_n.nodes.displacement[:, :3]
        for i, block in enumerate(model.mesh.blocks):
            law, law_fault = self._laws[i], _core.LawFault()
            before, now = self._take_block(state_n, i), self._take_block(trial, i)
            cell, fault = _core.evaluate_shells(
                block.element,
                self._evaluated[i],
                self._directors_of[i],
                model.mesh.points,
                points,
                increment,
                state_n[ShellArrays].director,
                *self._rules[i],
                law.umat if isinstance(law, SheetUmat) else law,
                dt=dt,
                penalty=model.solver.kirchhoff_penalty,
                state_n=before.kept,
                state=now.kept,
                volume=now.volume,
                force=self._force[i],
                stiffness=self._stiffness[i] if with_stiffness else None,
                symmetric=model.solver.symmetric,
                small_displacements=is_small,
                temperature=now.temperature if now.temperature.size else None,
                young=law.young,
                poisson=law.poisson,
                first_cell=int(self._first_cell[i]),
                when=self._when,
                fault=law_fault,
            )
            if cell >= 0:
                if fault == _core.ShellFault.law and law_fault.status != _core.LawStatus.done:
                    return LawFailed.of(i, law_fault)
                return ShellFailed(i, cell, fault)
            self._keep_block(now, trial, i)
            self._store_plastic_strain(trial, i)
        return None

    def _take_block(self, state: State, i: int) -> ShellBlock:
        """Return the arrays of a block's shells that are evaluated here."""
        cells, shells = state.cells, state[ShellArrays]
        return ShellBlock(
            shells.thickness[i], cells.stress[i], cells.history[i], shells.direction[i], shells.shear[i],
            shells.internal[i], cells.volume[i], cells.temperature[i],
        )  # fmt: skip

    def _keep_block(self, block: ShellBlock, state: State, i: int) -> None:
        """Put evaluated arrays where _take_block has taken them from; these are the arrays themselves."""

    def _store_plastic_strain(self, trial: State, i: int) -> None:
        """Let the state have the equivalent plastic strain, the first that laws keep, by itself."""
        trial.cells.eqps[i][:] = trial.cells.find_kept(i, EQPS).reshape(trial.cells.eqps[i].shape)

    def look_near(self, looks: Sequence[Look], places: FloatArray) -> list[Near]:
        """Return what each look at tools finds of the nodes at places (n_points, 3) [mm]."""
        return [nearest(places, reach) for nearest, reach in looks]

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Keep the increment's place in the run, for laws that use it."""
        self._when = place_increment(step)

    def complete(self, trial: State) -> None:
        """Let a trial state in equilibrium have the arrays of all cells; it has."""

    def end_increment(self, state_n: State, trial: State, dt: float) -> None:
        """Turn the directors of a converged trial state by its increment; with small displacements they stay.

        Find the rates of plastic strain, after dt [s].
        """
        for i, block in enumerate(self._model.mesh.blocks):
            if trial.cells.rate[i].size and dt > 0.0:
                material, degrees = self._model.materials[block.material], self.temperature_at_points(trial, i)
                note_rates(i, block.material, material, state_n, trial, dt, degrees)
        if self._model.solver.is_small:
            return
        theta = trial.nodes.increment[self.directors.node, 3:]
        turned = turn_vectors(theta, state_n[ShellArrays].director)
        trial[ShellArrays].director = turned / np.linalg.norm(turned, axis=1, keepdims=True)

    def couple(self, couplings: IntArray) -> None:
        """Let the matrix hold these node pairs (n, 2) beside those of the cells; a change makes a new assembler."""
        if self._couplings is None or not np.array_equal(couplings, self._couplings):
            self._couplings = couplings
            self.assembler = self._make_assembler(couplings)

    def assemble_stiffness(self, turned: MaskArray, frames: FloatArray, data: FloatArray) -> None:
        """Fill `data` (nnz) with the stiffness of the last evaluation, rotations in the nodes' frames."""
        started = perf_counter()
        self.assembler.assemble_matrix(self._stiffness, turned, frames, data)
        self._timing.add("assembly", started)

    def force_of_round_off(self) -> float:
        """Nodal force [N] that is nothing even in a workpiece that has never been loaded."""
        size = float(np.ptp(self._model.mesh.points, axis=0).max())
        thickness = min(float(block.thickness.min()) for block in self._model.mesh.blocks)
        return NOISE * max(m.young for m in self._model.materials) * thickness**3 / size

    def nodal_flow_stress(self, state: State) -> FloatArray:
        """Return the mean flow stress of the cells round each node (n_points,) [MPa]."""
        return self._spread([self.flow_stress(i, state).mean(axis=1) for i in range(len(self._connectivity))])

    def nodal_temperature(self, state: State) -> FloatArray | None:
        """Return the mean temperature of the cells round each node (n_points,) [degrees C]; None: it is not known."""
        if not all(degrees.size for degrees in state.cells.temperature):
            return None
        return self._spread([degrees.reshape(len(degrees), -1).mean(axis=1) for degrees in state.cells.temperature])

    def _spread(self, values: Sequence[FloatArray]) -> FloatArray:
        """Return the mean over the cells round each node (n_points,) of values of each block's cells (n_cells,)."""
        n = len(self._model.mesh.points)
        total, count = np.zeros(n), np.zeros(n)
        for connectivity, own in zip(self._connectivity, values, strict=True):
            np.add.at(total, connectivity, own[:, None])
            np.add.at(count, connectivity, 1.0)
        return total / np.maximum(count, 1.0)

    def flow_stress(self, block: int, state: State) -> FloatArray:
        """Return the flow stress [MPa] at a block's points at their rates (n_cells, n_points).

        A UMAT has its effective stress instead.
        """
        law = self._laws[block]
        if isinstance(law, SheetUmat):  # which does not report it
            return sheet_effective_stress(state.cells.stress[block])
        eqps = np.ascontiguousarray(state.cells.find_kept(block, EQPS).ravel())
        heat = self.temperature_at_points(state, block)
        rate = state.cells.rate[block].ravel() if state.cells.rate[block].size else None
        flow, _ = law.flow_stress(eqps, rate, heat)
        result: FloatArray = flow.reshape(state.cells.eqps[block].shape)
        return result

    def temperature_at_points(self, state: State, block: int) -> FloatArray:
        """Return the temperature of a block's points (n,) [degrees C], the rise by the law's own heat included."""
        history = state.cells.history[block].reshape(-1, state.cells.history[block].shape[-1])
        material = self._model.materials[self._model.mesh.blocks[block].material]
        return temperature(material, state.cells.kept[block], history, state.cells.temperature[block])

    def cell_fields(self, state: State) -> dict[str, FloatArray]:
        """Return the quantities of the sheet's cells by name."""
        mesh, cells, shells = self._model.mesh, state.cells, state[ShellArrays]
        director = shells.director
        if self._model.solver.is_small:  # for the strains, directors as far as rotations turn them to first order
            director = director + np.cross(state.nodes.displacement[self.directors.node, 3:], director)
        geometry = [
            ShellGeometry(
                connectivity=block.connectivity,
                director_of=self.directors.of_cell[i],
                slopes=_core.shell_shape(block.element)[1],
                points=mesh.points,
                director=self.directors.vectors,
                thickness=block.thickness,
                layers=self._rules[i][0],
                material=self._model.materials[block.material],
            )
            for i, block in enumerate(mesh.blocks)
        ]
        layers = [
            ShellLayers(
                shells.thickness[i], shells.direction[i], cells.stress[i], cells.eqps[i], cells.history[i],
                cells.temperature[i], cells.kept[i],
            )
            for i in range(len(mesh.blocks))
        ]  # fmt: skip
        now = mesh.points + state.nodes.displacement[:, :3]
        return shell_cell_fields(now, director, geometry, layers) | find_path_margins(mesh.blocks, find_evolved(state))

    def show(
        self,
        state: State,
        contact: ContactForces | None = None,
        between_bodies: BodyTraction | None = None,
    ) -> Instant:
        """Return what the fields are computed from; neither contact nor bodies have stresses on a shell."""
        return Instant(
            self._model,
            state.nodes.displacement[:, :3],
            state,
            reaction=state.nodes.reaction,
            find_sheet=lambda: self.cell_fields(state),
            evolved=find_evolved(state),
            judged=self._model.judged,
        )

    def extremes(self, state: State) -> dict[str, FloatArray]:
        """Return the values whose extremes the summary reports."""
        stress = np.concatenate([s.reshape(-1, 3) for s in state.cells.stress])
        return {
            "equivalent_plastic_strain": np.concatenate([e.ravel() for e in state.cells.eqps]),
            "effective_stress": sheet_effective_stress(stress),
            "thickness": np.concatenate([t.ravel() for t in state[ShellArrays].thickness]),
            "displacement": np.linalg.norm(state.nodes.displacement[:, :3], axis=1),
        }

    def elastic_dilatation(self, state: State) -> float:
        """Return the volume gained elastically [mm3]."""
        blocks = zip(self._model.mesh.blocks, state.cells.stress, state.cells.volume, strict=True)
        total = 0.0
        for block, stress, volume in blocks:
            material = self._model.materials[block.material]
            total += float((stress[..., :2].sum(axis=-1) * (1 - 2 * material.poisson) / material.young * volume).sum())
        return total

    def elastic_energy(self, state: State) -> float:
        """Return the energy stored elastically [N mm], transverse shear included."""
        return elastic_energy(self._model, state)

    def plastic_work(self, state_n: State, trial: State, dt: float) -> float:
        """Return the plastic work of one increment over dt [s] [N mm]."""
        return plastic_work(self._model, self._laws, state_n, trial, dt)

    def layer_heights(self, block: int) -> FloatArray:
        """Return the heights of a block's layers in [-1, 1], from the bottom up."""
        return self._rules[block][0]

    def plastic_work_at_layers(self, state_n: State, trial: State, dt: float) -> list[FloatArray]:
        """Return the plastic work of an increment at the layers of each block (n_cells, q, k) [N mm]."""
        return plastic_work_at_layers(self._model, self._laws, state_n, trial, dt)
