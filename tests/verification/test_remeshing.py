# SPDX-License-Identifier: Apache-2.0
"""What a new mesh may not change: homogeneous states, forces, closed forms."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.fields.solid_fields import effective_stress
from presswork.process.begin import begin
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.process.mesh_change import new_balance


def run(case):
    """Rows of the history, and the recording at its end."""
    recording = begin(build_model(case), 1)
    rows = [recording.row(report) for report in recording.advance()]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, recording


def upsetting(remesh, *, stroke, cells, contact, size=(10.0, 15.0), analysis="axisymmetric"):
    """A block of linear hardening, 700 + 300 e MPa, under a flat platen."""
    width, height = size
    hardening = {"law": "linear", "yield_stress": 700, "modulus": 300}
    return Case(
        title="upsetting",
        analysis=analysis,
        workpiece={"material": "steel", "mesh": {"size": list(size), "cells": cells}},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": hardening}},
        tools={"punch": {"profile": [[0, height], [8 * width, height]], **contact}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}],
        output={"steps": 1},
        solver={"max_increment": 0.02},
        remesh=remesh,
    )


@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_homogeneous_upsetting_does_not_know_of_its_meshes(analysis):
    """Without friction all points share one state: 29 new meshes leave it even, and the force as without any."""
    case = {"stroke": 9.0, "cells": [6, 9], "contact": {"contact": "frictionless"}, "analysis": analysis}
    once, _ = run(upsetting(None, **case))
    often, recording = run(upsetting({"every": 1 / 30, "quality": 0.01}, **case))
    assert often["remeshes"][-1] >= 25
    strain = recording.procedure.state.cells.eqps[0]
    assert np.ptp(strain) < 1e-8 * strain.mean()
    force = np.interp(often["punch.stroke"], once["punch.stroke"], once["punch.force"])
    np.testing.assert_allclose(often["punch.force"], force, rtol=1e-4)
    first, moved = recording.mesh.points, recording.moved(recording.procedure.state.nodes.displacement)
    now = first + moved
    for axis, size in enumerate((10.0, 15.0)):
        np.testing.assert_allclose(first[:, axis], now[:, axis] * size / now[:, axis].max(), atol=1e-7)


@pytest.mark.parametrize("limit", [new_balance.MOST_BEYOND, 1.001])
def test_metal_that_a_new_mesh_would_bring_far_beyond_its_flow_stress_flows(limit, monkeypatch):
    """Below that it answers elastically while the tools are at rest, and is beyond its flow stress then."""
    monkeypatch.setattr(new_balance, "MOST_BEYOND", limit)
    case = upsetting({}, stroke=6.0, cells=[8, 12], contact={"contact": "shear", "m": 0.3})
    recording = begin(build_model(case), 1)
    for _ in zip(range(12), recording.advance(), strict=False):
        pass
    assert recording.observers.find(NewMeshes).remesh("asked for", must=True)
    state = recording.procedure.state
    beyond = effective_stress(state.cells.stress[0]) / recording.procedure.mechanics.flow_stress(0, state)
    assert 1.0005 < beyond.max() < limit * (1.0 + 1e-9)


@pytest.mark.validation
def test_upsetting_with_friction_and_a_new_mesh_every_2_percent_keeps_its_force():
    """To 60 % of the height, m = 0.15: within 0.5 % of a run on one mesh of half the size.

    From 48 % on nodes of the side come to lie on the platen one after the other, on every mesh at other strokes.
    """
    case = {"stroke": 9.0, "contact": {"contact": "shear", "m": 0.15}}
    once, _ = run(upsetting(None, cells=[40, 60], **case))
    often, recording = run(upsetting({"every": 1 / 30}, cells=[20, 30], **case))
    assert often["remeshes"][-1] >= 29
    force = np.interp(often["punch.stroke"], once["punch.stroke"], once["punch.force"])
    assert np.abs(often["punch.force"] / force - 1).max() < 0.005
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 0.5


def test_upsetting_goes_to_90_percent_by_itself():
    """The side folds onto the platen; the disc ends 3 mm high and as wide as its volume asks for."""
    case = upsetting({}, stroke=13.5, cells=[15, 15], contact={"contact": "shear", "m": 0.15})
    rows, recording = run(case)
    assert rows["punch.stroke"][-1] == pytest.approx(13.5)
    assert rows["remeshes"][-1] >= 3
    procedure = recording.procedure
    state, mechanics = procedure.state, procedure.mechanics
    plastic = procedure.volume() - mechanics.elastic_dilatation(state) - procedure.initial_volume
    assert abs(plastic / procedure.initial_volume) < 1e-4
    assert abs(procedure.energy_balance()["error_percent"]) < 0.5
    width = (procedure.model.mesh.points + state.nodes.displacement)[:, 0].max()
    assert width == pytest.approx(10 * np.sqrt(10), rel=0.02)


def backward_extrusion(size):
    """Half a punch of 2 mm with edges of radius 0.1 in a container of 4 mm, frictionless; 100 MPa, no hardening."""
    tools = {
        "punch": {"profile": [[-1, 3], {"to": [1, 3], "radius": 0.1}, [1, 11]], "contact": "frictionless"},
        "container": {"profile": [[2, -1], [2, 11]], "contact": "frictionless"},
        "bottom": {"profile": [[-1, 0], [4, 0]], "contact": "frictionless"},
    }
    hardening = {"law": "linear", "yield_stress": 100, "modulus": 0}
    cells = [round(2 / size), round(3 / size)]
    return Case(
        title="backward extrusion",
        analysis="plane_strain",
        workpiece={"material": "soft", "mesh": {"size": [2, 3], "cells": cells}},
        materials={"soft": {"young": 1e5, "poisson": 0.3, "hardening": hardening}},
        tools=tools,
        boundary={"axis": {"set": "left", "fix": ["x"]}},
        stages=[{"name": "press", "tools": {"punch": {"stroke": 0.6, "direction": [0, -1]}}}],
        output={"steps": 1},
        solver={"max_increment": 0.02},
        remesh={"size": size, "smallest_size": 0.25 * size},
    )


def test_backward_extrusion_takes_the_slip_line_pressure():
    """Plane strain, half the area, frictionless, perfectly plastic: the punch pressure is 2.571 times 2k (slip lines).

    The round edge of the punch carries less than a sharp one: the force lies below.
    """
    rows, recording = run(backward_extrusion(0.12))
    pressure = rows["punch.force"] / 2.0 / (2.0 * 100 / np.sqrt(3))  # over the whole punch, 2 mm by 1 mm
    steady = pressure[rows["punch.stroke"] > 0.1]
    assert rows["remeshes"][-1] >= 5
    assert steady.mean() == pytest.approx(2.571, rel=0.02)
    assert np.ptp(steady) < 0.03 * 2.571
    assert rows["cells"].max() < 1000
    assert recording.procedure.volume() == pytest.approx(6.0, rel=2e-3)  # compressed elastically
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 1.0
