# SPDX-License-Identifier: Apache-2.0
"""What an increment must fulfil to be in equilibrium."""

from types import SimpleNamespace

import numpy as np
import pytest

from presswork.implicit.newton import Equilibrium
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Hardening, Material, Stage, Support
from presswork.outcome import IterationLog
from tests.problems.plane_solids import block_mesh, fixed_increments, make_model

SIZE = 10.0


@pytest.fixture(scope="module")
def equilibrium() -> Equilibrium:
    mesh = block_mesh("quad4_fbar", (1, 1), origin=(0.0, 0.0), size=(SIZE, SIZE))
    steel = Material("steel", 2e5, 0.3, Hardening("linear", np.array([300.0, 500.0])))
    supports = (Support("left", (True, False)), Support("bottom", (False, True)))
    model = make_model(
        mesh, steel, analysis="plane_strain", supports=supports, stages=[Stage("hold")], solver=fixed_increments(1)
    )
    return ImplicitProcedure(model, threads=1).equilibrium


def ends(equilibrium: Equilibrium, residual: float, correction: float, *, missing: float = 0.0, size: float) -> bool:
    """Say whether an iterate is in equilibrium.

    correction: relative. missing: way of constrained nodes to their places [mm]; size: of the last correction [mm].
    """
    log = IterationLog()
    log.residual.append(residual)
    log.correction.append(correction)
    log.contact_changes.append(0)
    balance = SimpleNamespace(bears=lambda *_: True, constraints=SimpleNamespace(value=np.full((4, 2), missing)))
    return equilibrium._has_converged(log, balance, 1.0, size)  # type: ignore[arg-type]


@pytest.mark.parametrize(("missing", "may_end"), [(0.3, False), (0.0, True)])
def test_no_increment_converges_before_constrained_nodes_are_in_their_places(
    equilibrium: Equilibrium, missing: float, may_end: bool
) -> None:
    """A body without load has no residual, though a tool stands in it: a shortened correction leaves it there."""
    assert ends(equilibrium, 1e-15, 1e5, missing=missing, size=1.0) is may_end


def test_round_off_is_no_lack_of_equilibrium(equilibrium: Equilibrium) -> None:
    """A correction of a fifth of the last place of coordinates moves no node; one of a thousand times as much does."""
    residual, least = 1e2 * equilibrium._model.solver.force_tolerance, 0.2 * np.finfo(float).eps * SIZE
    assert residual < 1e-6
    assert ends(equilibrium, residual, 1e-12, size=least)
    assert not ends(equilibrium, residual, 1e-12, size=1e3 * least)
    assert not ends(equilibrium, residual, 1e-12, missing=0.3, size=least)
    assert not ends(equilibrium, 1e-3, 1e-12, size=least)
