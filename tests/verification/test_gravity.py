# SPDX-License-Identifier: Apache-2.0
"""Gravity in every family and both procedures against closed forms: hanging bars, sagging plates, free fall, rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.case.shell.schema import ShellCase
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import StampingCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ToolArrays
from presswork.model import FloatArray, Model
from presswork.process.begin import begin
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.stamping import ExplicitStamping

YOUNG, DENSITY, G = 2e5, 7.85e-9, 9810.0
LENGTH = 2000.0
"""Of hanging bars [mm]."""
HANG = {"solver": {"displacements": "small", "initial_increment": 1.0, "max_increment": 1.0}, "output": {"steps": 1}}


def metal(poisson: float = 0.0) -> dict[str, Any]:
    """Return a material that does not yield."""
    hardening = {"law": "linear", "yield_stress": 900.0, "modulus": 0.0}
    return {"steel": {"young": YOUNG, "poisson": poisson, "density": DENSITY, "hardening": hardening}}


def plane(analysis: str, element: str) -> Model:
    """Return a bar that hangs from its top in the plane or in axisymmetry."""
    quadratic = element.startswith(("tri6", "quad8", "quad9"))
    return build_model(
        Case(
            title="bar", analysis=analysis, materials=metal(), gravity=[0.0, -G],
            workpiece={"material": "steel", "element": element,
                       "mesh": {"size": [40.0, LENGTH], "cells": [2, 2 if quadratic else 5]}},
            boundary={"axis": {"set": "left", "fix": ["x"]}, "top": {"set": "top", "fix": ["y"], "symmetry": False}},
            stages=[{"name": "hang"}], **HANG,
        )
    )  # fmt: skip


def space(element: str) -> Model:
    """Return the same in space, along z."""
    return build_model(
        SpaceCase(
            title="bar", analysis="solid", materials=metal(), gravity=[0.0, 0.0, -G],
            workpiece={"material": "steel", "element": element,
                       "mesh": {"size": [40.0, 40.0, LENGTH], "cells": [1, 1, 4]}},
            boundary={"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]},
                      "top": {"set": "front", "fix": ["z"], "symmetry": False}},
            stages=[{"name": "hang"}], **HANG,
        )
    )  # fmt: skip


def sheet(gravity: list[float], element: str = "shell4_mitc", length: float = LENGTH, width: float = 40.0) -> Model:
    """Return a strip along x, 2 mm thick, clamped at its left end."""
    return build_model(
        ShellCase(
            title="strip", analysis="shell", materials=metal(), gravity=gravity,
            workpiece={"material": "steel", "element": element, "section": {"thickness": 2.0},
                       "mesh": {"size": [length, width], "cells": [16, 1]}},
            boundary={"end": {"set": "left", "hold": "clamped"}}, stages=[{"name": "hang"}], **HANG,
        )
    )  # fmt: skip


def settle(model: Model) -> ImplicitProcedure:
    """Run an implicit model to its end."""
    procedure = ImplicitProcedure(model, threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def check_bar(model: Model, axis: int, at: FloatArray, area: float, within: float = 1e-9) -> None:
    """Hold a bar to rho g (L z - z^2/2)/E, z from where it is held (n_points,), and to its energy and weight."""
    procedure = settle(model)
    nodes = procedure.state.nodes
    exact = DENSITY * G * (LENGTH * at - 0.5 * at**2) / YOUNG
    assert np.abs(nodes.displacement[:, axis]) == pytest.approx(exact, abs=within * exact.max())
    assert abs(procedure.energy_balance()["error_percent"]) < 1e-6
    held = np.abs(nodes.reaction[at == 0.0, axis].sum())
    assert held == pytest.approx(DENSITY * G * LENGTH * area, rel=1e-9)


@pytest.mark.parametrize(("analysis", "element"), [
    ("plane_strain", "quad4_fbar"), ("plane_strain", "quad8_2x2"), ("plane_strain", "tri6_7pt"),
    ("axisymmetric", "quad4"), ("axisymmetric", "quad9"), ("axisymmetric", "tri6_7pt"),
])  # fmt: skip
def test_hanging_bar_in_the_plane_stretches_as_the_closed_form(analysis, element) -> None:
    model = plane(analysis, element)
    check_bar(model, 1, LENGTH - model.mesh.points[:, 1], 40.0 if analysis == "plane_strain" else np.pi * 40.0**2)


@pytest.mark.parametrize(("element", "within"), [("hex8", 1e-9), ("hex8_fbar", 1e-9), ("tet10", 8e-3)])
def test_hanging_bar_in_space_stretches_as_the_closed_form(element, within) -> None:
    model = space(element)
    check_bar(model, 2, LENGTH - model.mesh.points[:, 2], 1600.0, within)


def test_hanging_strip_of_shells_stretches_as_the_closed_form() -> None:
    model = sheet([G, 0.0, 0.0])
    check_bar(model, 0, model.mesh.points[:, 0], 80.0)


def test_clamped_strip_sags_as_a_beam() -> None:
    """Deflection of the end: w L^4/(8 E I), with w = rho g b t and I = b t^3/12."""
    length, thickness = 300.0, 2.0
    procedure = settle(sheet([0.0, 0.0, -G], length=length, width=30.0))
    deflection = 12.0 * DENSITY * G * length**4 / (8.0 * YOUNG * thickness**2)
    assert -procedure.state.nodes.displacement[:, 2].min() == pytest.approx(deflection, rel=2e-4)


def test_blank_laid_on_a_die_sags_as_a_beam_and_the_die_bears_its_weight() -> None:
    """A stage in which nothing moves: w L^4/(384 E I) (5 - 24 c^2/L^2) between supports, c beyond them on each side."""
    width, radius, length, thickness = 400.0, 5.0, 440.0, 0.5
    case = StampingCase(
        title="rest", analysis="stamping", procedure="implicit", materials=metal(), gravity=[0.0, 0.0, -G],
        blank={"material": "steel", "shape": "rectangle", "size": [length, 20.0], "thickness": thickness,
               "element_size": [5.0, 10.0], "symmetry": ["x", "y"]},
        tools={"die": {"kind": "die", "shape": "strip", "width": width, "edge_radius": radius}},
        stages=[{"name": "rest", "duration": 1.0}],
    )  # fmt: skip
    run = begin(build_model(case), threads=1)
    for report in run.advance():
        row = run.row(report)
    span = width + 2.0 * radius
    beyond = 0.5 * (length - span)
    weight = DENSITY * G * thickness
    sag = 12.0 * weight * span**4 / (384.0 * YOUNG * thickness**3) * (5.0 - 24.0 * (beyond / span) ** 2)
    nodes = run.at_work().procedure.state.nodes  # type: ignore[union-attr]
    assert -nodes.displacement[:, 2].min() == pytest.approx(sag, rel=0.02)
    assert row["die.force_z"] == pytest.approx(-weight * length * 20.0, rel=1e-3)


def test_weight_stays_in_later_stages() -> None:
    model = build_model(
        ShellCase(
            title="strip", analysis="shell", materials=metal(), gravity=[G, 0.0, 0.0],
            workpiece={"material": "steel", "element": "shell4_mitc", "section": {"thickness": 2.0},
                       "mesh": {"size": [LENGTH, 40.0], "cells": [4, 1]}},
            boundary={"end": {"set": "left", "hold": "clamped"}},
            stages=[{"name": "hang"}, {"name": "hold", "duration": 1.0}], **HANG,
        )
    )  # fmt: skip
    stretch = settle(model).state.nodes.displacement[:, 0].max()
    assert stretch == pytest.approx(DENSITY * G * LENGTH**2 / (2 * YOUNG), rel=1e-9)


def fall(case: Any, duration: float) -> ExplicitForming | ExplicitStamping:
    """Let an explicit case fall."""
    run = begin(build_model(case), threads=1)
    for _ in run.advance():
        pass
    assert run.time == pytest.approx(duration)
    return run  # type: ignore[return-value]


FALL = 1e-3
DROP = {"stages": [{"name": "fall", "duration": FALL}], "output": {"rows": 2, "steps": 1}, "procedure": "explicit"}


def solid_in_free_fall(kind: str) -> Any:
    """Return a case of a free body of one kind."""
    if kind == "space":
        return SpaceCase(
            title="fall", analysis="solid", materials=metal(0.3), gravity=[0.5 * G, 0.0, -G], **DROP,
            workpiece={"material": "steel", "element": "hex8_1pt", "mesh": {"size": [9.0, 8, 7], "cells": [2, 1, 2]}},
        )  # fmt: skip
    if kind == "sheet":
        return StampingCase(
            title="fall", analysis="stamping", materials=metal(0.3), gravity=[0.5 * G, 0.0, -G], **DROP,
            blank={"material": "steel", "shape": "rectangle", "size": [30, 20], "thickness": 1, "element_size": 8},
        )  # fmt: skip
    return Case(
        title="fall", analysis=kind, materials=metal(0.3), gravity=[0.0, -G], **DROP,
        workpiece={"material": "steel", "element": "quad4_1pt", "mesh": {"size": [9.0, 8.0], "cells": [3, 2]}},
        boundary={"axis": {"set": "left", "fix": ["x"]}} if kind == "axisymmetric" else {},
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["plane_strain", "axisymmetric", "space", "sheet"])
def test_free_body_falls_by_half_g_t_squared_without_strain(kind) -> None:
    """The first half step of central differences starts at rest, so places are g t^2/2 at the ends of steps."""
    run = fall(solid_in_free_fall(kind), FALL)
    moved = run.displacements()[:, : run.model.dimension]
    exact = 0.5 * np.asarray(run.model.gravity) * FALL**2
    assert moved == pytest.approx(np.tile(exact, (len(moved), 1)), abs=2e-3 * np.abs(exact).max())
    assert np.ptp(moved, axis=0).max() < 1e-9


def test_added_mass_does_not_add_weight() -> None:
    """A step ten times as long takes some hundred times the mass; the force that drives it is the true weight."""
    case = solid_in_free_fall("plane_strain")
    plain = begin(build_model(case), threads=1)
    heavy = case.model_copy(update={"explicit": case.explicit.model_copy(update={"target_step": 1e-5})})
    run = begin(build_model(heavy), threads=1)
    assert run.solids.mass.sum() > 10.0 * plain.solids.mass.sum()  # type: ignore[union-attr]
    weight = run.solids.force.sum(axis=0)  # type: ignore[union-attr]
    assert weight[1] == pytest.approx(-DENSITY * G * 72.0)


def test_block_stands_on_a_table_with_its_weight() -> None:
    case = Case(
        title="stand", analysis="plane_strain", materials=metal(0.3), gravity=[0.0, -G], depth=10.0,
        output={"steps": 1},
        workpiece={"material": "steel", "element": "quad4_fbar", "mesh": {"size": [9.0, 8.0], "cells": [3, 2]}},
        tools={"table": {"profile": [[20, 0], [-20, 0]], "contact": "frictionless"}},
        boundary={"side": {"set": "left", "fix": ["x"]}}, stages=[{"name": "stand"}],
    )  # fmt: skip
    procedure = settle(build_model(case))
    force = procedure.state[ToolArrays].force[0]
    assert np.abs(force[1]) == pytest.approx(DENSITY * G * 720.0, rel=1e-6)


@pytest.mark.parametrize(("change", "told"), [
    ({"gravity": [G, 0.0]}, "across the axis"),
    ({"gravity": [0.0, -9.81]}, "plain numbers are mm/s"),
    ({"materials": {"steel": {k: v for k, v in metal()["steel"].items() if k != "density"}}}, "gravity needs it"),
    ({"boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"], "symmetry": True}}},
     "across the symmetry plane boundary.middle"),
])  # fmt: skip
def test_check_says_what_theory_forbids(change, told) -> None:
    case = {
        "title": "bar", "analysis": "axisymmetric", "materials": metal(), "gravity": [0.0, -G],
        "workpiece": {"material": "steel", "element": "quad4", "mesh": {"size": [4.0, 9.0], "cells": [2, 2]}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "top": {"set": "top", "fix": ["y"], "symmetry": False}},
        "stages": [{"name": "hang"}], **change,
    }  # fmt: skip
    with pytest.raises(CaseError, match=told):
        build_model(Case(**case))


def test_check_refuses_gravity_across_a_symmetry_plane_of_a_blank() -> None:
    case = solid_in_free_fall("sheet")
    blank = case.blank.model_copy(update={"symmetry": ("x",)})
    with pytest.raises(CaseError, match="across the symmetry plane x = 0"):
        build_model(case.model_copy(update={"blank": blank}))
