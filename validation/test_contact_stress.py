# SPDX-License-Identifier: Apache-2.0
"""Contact stress at the end of the examples of bulk forming: what the metal carries, and the tools' forces."""

from __future__ import annotations

import numpy as np
import pytest

from validation.contact_stress import FORGINGS, SHOWN, compute

pytestmark = pytest.mark.validation


@pytest.mark.parametrize("example", FORGINGS)
def test_no_node_has_more_shear_than_the_metal_carries_or_pulls(example):
    face = compute(example)
    assert (np.abs(face.shear) <= face.strength * (1 + 1e-9)).all()
    assert face.pressure.min() >= 0.0


@pytest.mark.parametrize("example", FORGINGS)
def test_traction_and_pressure_integrate_to_the_forces_of_the_nodes(example):
    face = compute(example)
    assert face.traction_error < 1e-12
    assert face.pressure_error < 1e-12


@pytest.mark.parametrize("example", [name for name in FORGINGS if not name.startswith(("upsetting", "heading"))])
def test_shear_by_a_law_of_friction_integrates_to_the_drag(example):
    assert compute(example).shear_left < 1e-9


@pytest.mark.parametrize("example", SHOWN)
def test_pressure_inside_the_face_is_that_of_a_fine_mesh_within_11_percent(example):
    fine, face = compute("upsetting_q4", ("workpiece.mesh.cells=[60,60]",)), compute(example)
    inner = face.place < 8.0
    np.testing.assert_allclose(face.pressure[inner], np.interp(face.place[inner], fine.place, fine.pressure), rtol=0.11)
