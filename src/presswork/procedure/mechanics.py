# SPDX-License-Identifier: Apache-2.0
"""Internal force and tangent stiffness of the workpiece: the bridge from the Model's arrays to the kernels."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from presswork import _core
from presswork.model import FloatArray, IntArray, MaskArray, Material, Model, SolverSettings
from presswork.procedure.timing import Timing
from presswork.state import State


@dataclass(frozen=True)
class TurnedInsideOut:
    """A cell that the trial displacement has turned inside out; the increment must be cut."""

    block: int
    cell: int

    def __str__(self) -> str:
        return f"cell {self.cell} of block {self.block} turned inside out"


@dataclass(frozen=True)
class PassedThrough:
    """Bodies whose surfaces the trial displacement has moved through each other; the increment must be cut."""

    contact: str

    def __str__(self) -> str:
        return f"surfaces of contact {self.contact!r} passed through each other"


BadGuess = TurnedInsideOut | PassedThrough


def make_law(material: Material, solver: SolverSettings) -> _core.VonMises:
    """Return the compiled material law."""
    consistent = solver.tangent == "consistent" or solver.terms.modulus == "consistent"
    return _core.VonMises(
        material.young,
        material.poisson,
        _core.HardeningLaw[material.hardening.law],
        [float(p) for p in material.hardening.parameters],
        integrator=_core.Integrator[solver.integrator],
        substeps=solver.substeps,
        modulus=_core.Modulus.consistent if consistent else _core.Modulus.continuum,
    )


def make_point_settings(solver: SolverSettings) -> _core.PointSettings:
    """Return the kernels' settings of kinematics and tangent."""
    return _core.PointSettings(
        measure=_core.StrainMeasure[solver.strain_measure],
        tangent=_core.TangentKind[solver.tangent],
        green_lagrange_matrix=solver.terms.strain_matrix == "Bbar",
        k_e=solver.terms.k_e,
        k_u=solver.terms.k_u,
        k_v=solver.terms.k_v,
    )


class Mechanics:
    """Evaluates all cells of the model over one increment and assembles the result."""

    def __init__(self, model: Model, timing: Timing) -> None:
        self._model = model
        self._timing = timing
        self._settings = make_point_settings(model.solver)
        laws = [make_law(m, model.solver) for m in model.materials]
        self._laws = [laws[b.material] for b in model.mesh.blocks]
        self._connectivity = [np.ascontiguousarray(b.connectivity, dtype=np.int32) for b in model.mesh.blocks]
        self.assembler = self._make_assembler(None)
        self._couplings: IntArray | None = None
        self._force: list[FloatArray] = []
        self._stiffness: list[FloatArray] = []
        for connectivity in self._connectivity:
            cells, nodes = connectivity.shape
            packs = -(-cells // _core.pack_width)
            self._force.append(np.zeros((packs, 2 * nodes, _core.pack_width)))
            self._stiffness.append(np.zeros((packs, 2 * nodes, 2 * nodes, _core.pack_width)))

    def _make_assembler(self, couplings: IntArray | None) -> _core.Assembler:
        n_points = len(self._model.mesh.points)
        return _core.Assembler(n_points, self._connectivity, self._model.solver.symmetric, couplings)

    def couple(self, couplings: IntArray) -> None:
        """Let the matrix hold these node pairs (n, 2) beside those of the cells; a change makes a new assembler."""
        if self._couplings is None or not np.array_equal(couplings, self._couplings):
            self._couplings = couplings
            self.assembler = self._make_assembler(couplings)

    def evaluate(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool
    ) -> FloatArray | TurnedInsideOut:
        """Return the internal nodal force (n_points, 2) [N] after `increment` (n_points, 2) [mm] from state_n.

        Fills the trial state's stress, history and volumes and, if asked, the element stiffnesses. Does not touch
        state_n.
        """
        started = perf_counter()
        model = self._model
        points = model.mesh.points + state_n.displacement
        for i, block in enumerate(model.mesh.blocks):
            failed = _core.evaluate_block(
                block.element,
                self._connectivity[i],
                points,
                increment,
                self._laws[i],
                self._settings,
                axisymmetric=model.analysis == "axisymmetric",
                depth=model.depth,
                hourglass_fraction=model.solver.hourglass_stiffness,
                stress_n=state_n.stress[i],
                eqps_n=state_n.eqps[i],
                hourglass_n=state_n.hourglass[i],
                stress=trial.stress[i],
                eqps=trial.eqps[i],
                hourglass=trial.hourglass[i],
                volume=trial.volume[i],
                force=self._force[i],
                stiffness=self._stiffness[i] if with_stiffness else None,
                symmetric=model.solver.symmetric,
            )
            if failed >= 0:
                self._timing.add("assembly", started)
                return TurnedInsideOut(i, failed)
        force: FloatArray = self.assembler.assemble_vector(self._force)
        self._timing.add("assembly", started)
        return force

    def assemble_stiffness(self, turned: MaskArray, frames: FloatArray, data: FloatArray) -> None:
        """Fill `data` (nnz) with the stiffness of the last evaluation; turned nodes use their own frames."""
        started = perf_counter()
        self.assembler.assemble_matrix(self._stiffness, turned, frames, data)
        self._timing.add("assembly", started)

    def nodal_flow_stress(self, state: State) -> FloatArray:
        """Return the mean flow stress of the cells round each node (n_points,) [MPa]."""
        total, count = np.zeros(len(self._model.mesh.points)), np.zeros(len(self._model.mesh.points))
        for i, connectivity in enumerate(self._connectivity):
            flow = self.flow_stress(i, state.eqps[i]).mean(axis=1)
            for column in connectivity.T:
                total += np.bincount(column, flow, minlength=len(total))
                count += np.bincount(column, minlength=len(total))
        return total / np.maximum(count, 1)

    def flow_stress(self, block: int, eqps: FloatArray) -> FloatArray:
        """Return the flow stress [MPa] at equivalent plastic strains of any shape."""
        flow, _ = self._laws[block].flow_stress(np.ascontiguousarray(eqps).ravel())
        result: FloatArray = flow.reshape(eqps.shape)
        return result


def elastic_energy(model: Model, state: State) -> float:
    """Return the energy stored elastically [N mm]."""
    total = 0.0
    for block, stress, volume in zip(model.mesh.blocks, state.stress, state.volume, strict=True):
        material = model.materials[block.material]
        trace = stress[..., :3].sum(axis=-1)
        square = (stress[..., :3] ** 2).sum(axis=-1) + 2 * stress[..., 3] ** 2
        density = ((1 + material.poisson) * square - material.poisson * trace**2) / (2 * material.young)
        total += float((density * volume).sum())
    return total


def plastic_work_of_increment(mechanics: Mechanics, state_n: State, trial: State) -> float:
    """Return the plastic work of one increment [N mm], by the trapezoidal rule on the flow stress."""
    total = 0.0
    for i in range(len(trial.eqps)):
        mean_flow = 0.5 * (mechanics.flow_stress(i, state_n.eqps[i]) + mechanics.flow_stress(i, trial.eqps[i]))
        total += float((mean_flow * (trial.eqps[i] - state_n.eqps[i]) * trial.volume[i]).sum())
    return total
