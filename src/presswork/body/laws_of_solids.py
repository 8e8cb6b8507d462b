# SPDX-License-Identifier: Apache-2.0
"""The compiled laws of a solid's materials, what they keep before the first increment, and the kernels' settings."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.law.elastic_plastic import SolidLaw, is_plain, make_hardening, make_plane_law, make_solid_law
from presswork.law.umat import UNDEFORMED, open_umat
from presswork.model import FloatArray, Material, SolverSettings


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


def history_at_rest(
    law: _core.VonMises | SolidLaw | _core.Umat, size: tuple[int, int], components: int, rolling: FloatArray
) -> FloatArray:
    """Return what a block's law keeps before the first increment (n_cells, n_points, n_history)."""
    if isinstance(law, _core.VonMises):
        return np.zeros((*size, 0))
    if isinstance(law, _core.Umat):
        history = np.zeros((*size, law.n_state + _core.umat_history_size(components)))
        history[..., law.n_state + UNDEFORMED] = 1.0
        return history
    history = np.zeros((*size, _core.kept_values(law)))
    if isinstance(law, _core.SolidLaw):
        across = np.cross([0.0, 0.0, 1.0], rolling)
        length = float(np.linalg.norm(across))
        history[..., -6:-3] = rolling
        history[..., -3:] = across / length if length > 1e-6 else (1.0, 0.0, 0.0)
    else:
        history[..., -2:] = rolling[:2]
    return history


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
