# SPDX-License-Identifier: Apache-2.0
"""The compiled laws of a solid's materials, what they keep, and the kernels' settings."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.law.elastic_plastic import SolidLaw, is_plain, make_hardening, make_plane_law, make_solid_law
from presswork.law.umat import open_umat
from presswork.model import FloatArray, Material, SolverSettings
from presswork.state import State


def make_law(material: Material, solver: SolverSettings, components: int) -> _core.VonMises | SolidLaw | _core.Umat:
    """Return the compiled material law of a stress of 4 or 6 components, or open the library that has it."""
    if material.umat is not None:
        return open_umat(material.umat)
    if not is_plain(material):
        return make_solid_law(material) if components == 6 else make_plane_law(material)
    assert material.hardening is not None
    consistent = solver.tangent == "consistent" or solver.terms.modulus == "consistent"
    return _core.VonMises(
        material.young,
        material.poisson,
        *make_hardening(material.hardening),
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
        small_displacements=solver.is_small,
    )


def gather_law_history(state: State, block: int, *, whole: bool) -> FloatArray:
    """Return what the law keeps behind the stress (n, n_history), the points of the cells in one row.

    whole: otherwise the equivalent plastic strain alone, its first.
    """
    history, eqps = state.cells.history[block], state.cells.eqps[block].reshape(-1, 1)
    return np.concatenate([eqps, history.reshape(-1, history.shape[2])], axis=1) if whole and history.size else eqps
