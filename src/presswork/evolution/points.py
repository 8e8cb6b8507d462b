# SPDX-License-Identifier: Apache-2.0
"""The evolution laws of a model at work: their arrays in the State, brought up to date once an increment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from presswork.evolution.contract import EvolutionLaw, PointChange
from presswork.evolution.in_parts import advance_in_parts
from presswork.evolution.of_material import BY_NAME, make_laws
from presswork.law.elastic_plastic import back_stress
from presswork.law.history import EQPS, POROSITY
from presswork.model import FloatArray, Model
from presswork.state import POINT, Arrays, OnNewMesh, State

if TYPE_CHECKING:
    from presswork.evolution.porosity import NonlocalPorosity


@dataclass
class EvolvedArrays(Arrays):
    """What evolution laws keep at the integration points of the cells."""

    owner = "evolved"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"values": POINT}
    values: dict[str, list[FloatArray]]
    """Values by the quantity's name: a list entry for each block of cells (n_cells, p), without rows where the material
    has no such law; units as the quantities define them (presswork.evolution.of_material)."""


def find_evolved(state: State) -> dict[str, list[FloatArray]]:
    """Return what evolution laws keep in a State, by quantity and block; nothing where no material has one."""
    return state[EvolvedArrays].values if EvolvedArrays in state else {}


class Evolution:
    """The evolution laws of all blocks of a model."""

    def __init__(self, model: Model) -> None:
        is_solid = model.analysis not in ("shell", "stamping")
        by_material = [make_laws(material, is_solid=is_solid) for material in model.materials]
        self._laws = [by_material[block.material] for block in model.mesh.blocks]
        self._of_blocks = [model.materials[block.material] for block in model.mesh.blocks]
        self._porosity: NonlocalPorosity | None = None
        self._model = model
        self.place(None)

    def place(self, origin: FloatArray | None) -> None:
        """Set where the material of the nodes was when the run began (n_points, 2) [mm]; None: at the mesh's points."""
        if any(material.gtn for material in self._model.materials):
            from presswork.evolution.porosity import NonlocalPorosity  # loads scipy, which dense metals do without

            self._porosity = NonlocalPorosity(self._model, origin)

    @property
    def names(self) -> list[str]:
        """The quantities, in the order of the laws."""
        return list(dict.fromkeys(q.name for laws in self._laws for law in laws for q in law.quantities))

    def critical(self, name: str) -> list[float | None]:
        """Return the critical value of a quantity in each block; None where there is none."""
        return [next((law.critical[name] for law in laws if name in law.critical), None) for laws in self._laws]

    def at_rest(self, state: State) -> EvolvedArrays:
        """Return the arrays at the start, of the size of the State's cells."""
        values: dict[str, list[FloatArray]] = {name: [] for name in self.names}
        for laws, eqps in zip(self._laws, state.cells.eqps, strict=True):
            start = {name: value for law in laws for name, value in law.at_rest().items()}
            for name, of_blocks in values.items():
                of_blocks.append(np.full_like(eqps, start[name]) if name in start else np.zeros((0, eqps.shape[1])))
        return EvolvedArrays(values)

    def advance(
        self, state_n: State, trial: State, dt: float, temperatures: Sequence[tuple[FloatArray, FloatArray] | None]
    ) -> None:
        """Bring the arrays of a converged trial state to the end of its increment of dt [s].

        temperatures: of the points of each block at the increment's start and end (n_cells, p) [degrees C]; None where
        they are not known.
        """
        for block, laws in enumerate(self._laws):
            if laws:
                self._advance_block(block, laws, state_n, trial, dt, temperatures[block])
        if self._porosity is not None:
            self._porosity.advance(trial.cells.history, trial.cells.kept, trial.cells.volume)

    def clip(self, state: State) -> None:
        """Bring values that were fitted on another mesh back to what their quantities can have."""
        for block, material in enumerate(self._of_blocks):
            if material.gtn is not None:
                porosity = state.cells.find_kept(block, POROSITY)
                np.clip(porosity, 0.0, 1.0, out=porosity)
        for name in self.names:
            bounds = BY_NAME[name].lowest, BY_NAME[name].highest
            state[EvolvedArrays].values[name] = [np.clip(of, *bounds) for of in state[EvolvedArrays].values[name]]

    @property
    def names_with_peaks(self) -> list[str]:
        """The quantities whose largest value decides."""
        return [name for name in self.names if BY_NAME[name].peak_counts]

    def _advance_block(
        self, block: int, laws: Sequence[EvolutionLaw], state_n: State, trial: State, dt: float,
        temperatures: tuple[FloatArray, FloatArray] | None,
    ) -> None:  # fmt: skip
        cells_n, cells = state_n.cells, trial.cells
        before, after = state_n[EvolvedArrays].values, trial[EvolvedArrays].values
        components, section = cells.stress[block].shape[-1], self._model.mesh.blocks[block].section
        back, material = None, self._of_blocks[block]
        if material.kinematic is not None and cells.history[block].ndim == 4:  # of shells
            back = back_stress(cells.kept[block], cells.history[block], components).reshape(-1, components)
        change = PointChange(
            cells_n.stress[block].reshape(-1, components),
            cells.stress[block].reshape(-1, components),
            cells_n.eqps[block].ravel(),
            cells.eqps[block].ravel(),
            dt,
            None if temperatures is None else temperatures[0].ravel(),
            None if temperatures is None else temperatures[1].ravel(),
            back_stress=back,
            layers=1 if section is None else section.points,
        )
        for law in laws:
            values = {q.name: before[q.name][block].ravel() for q in law.quantities}
            found = advance_in_parts(law, values, change, self._model.solver.increment_tolerance)
            for name, value in found.items():
                after[name][block] = value.reshape(cells.eqps[block].shape)
            if law.softens:
                cells.eqps[block] = law.hardening_strain(found).reshape(cells.eqps[block].shape)
                if EQPS in cells.kept[block]:  # of shells
                    kept = cells.find_kept(block, EQPS)
                    kept[...] = cells.eqps[block].reshape(kept.shape)
