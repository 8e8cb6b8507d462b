# SPDX-License-Identifier: Apache-2.0
"""What an increment must fulfil to be in equilibrium."""

from types import SimpleNamespace

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Hardening, Material, Stage, Support
from presswork.outcome import IterationLog
from tests.problems.plane_solids import block_mesh, fixed_increments, make_model


@pytest.mark.parametrize(("missing", "may_end"), [(0.3, False), (0.0, True)])
def test_no_increment_converges_before_constrained_nodes_are_in_their_places(missing: float, may_end: bool) -> None:
    """A body without load has no residual, though a tool stands in it: a shortened correction leaves it there."""
    mesh = block_mesh("quad4_fbar", (1, 1), origin=(0.0, 0.0), size=(10.0, 10.0))
    steel = Material("steel", 2e5, 0.3, Hardening("linear", np.array([300.0, 500.0])))
    supports = (Support("left", (True, False)), Support("bottom", (False, True)))
    model = make_model(
        mesh, steel, analysis="plane_strain", supports=supports, stages=[Stage("hold")], solver=fixed_increments(1)
    )
    log = IterationLog()
    log.residual.append(1e-15)
    log.correction.append(1e5)
    log.contact_changes.append(0)
    constraints = SimpleNamespace(value=np.full((4, 2), missing))
    balance = SimpleNamespace(bears=lambda *_: True, constraints=constraints)
    equilibrium = ImplicitProcedure(model, threads=1).equilibrium
    assert equilibrium._has_converged(log, balance, 1.0) is may_end  # type: ignore[arg-type]
