# SPDX-License-Identifier: Apache-2.0
"""Explicit shells between two plates that leave less room than they are thick: closed forms of plane compression."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.tools import RigidTool
from tests.problems.explicit_shells import DENSITY, POISSON, YOUNG, grid, mises, triangles
from tests.verification.test_explicit_contact import flat

THICKNESS, SIDE = 0.8, 8.0
K, E0, N = 565.0, 0.007, 0.26
SWIFT = mises("swift", (K, E0, N))
KINDS: dict[str, dict[str, Any]] = {
    "one_point": {},
    "single": {"precision": "single"},
    "triangles": {"cut": True},
    "mitc": {"options": ShellOptions(element="shell4_mitc_plus")},
    "hourglass_control": {"options": ShellOptions(hourglass="stiffness")},
    "general_law": {"options": ShellOptions(tabulate=False)},
}


def plates(
    stroke: float, *, law: _core.SheetLaw = SWIFT, held: str = "", cut: bool = False, mu: float = 0.0, n: int = 4,
    speed: float = 150.0, **how: Any,
) -> tuple[ExplicitShells, RigidTool]:  # fmt: skip
    """A quarter of a sheet, 16 x 16 mm, on a plate, and pressed by another; held: freedoms that all nodes lack."""
    points, cells = grid(n, n, SIDE, SIDE)
    sheet = ExplicitShells(
        points + np.array([0, 0, 0.5 * THICKNESS]), triangles(cells) if cut else cells, THICKNESS, law, DENSITY, **how
    )
    for axis, letter in enumerate("uv"):
        sheet.fix(np.flatnonzero(points[:, axis] == 0), letter)
    if held:
        sheet.fix(np.arange(len(points)), held)
    sheet.add_tool("below", flat(), mu=mu)
    above = sheet.add_tool("above", flat(False), mu=mu)
    above.position = [0, 0, THICKNESS]
    move(sheet, above, -stroke, speed)
    return sheet, above


def move(sheet: ExplicitShells, tool: RigidTool, way: float, speed: float = 150.0) -> None:
    """Move a tool along z by so many mm, at a mean speed [mm/s] so slow that inertia does not matter."""
    cycles = max(200, int(abs(way) / speed / sheet.dt))
    tool.velocity = [0, 0, way / (cycles * sheet.dt)]
    sheet.advance(cycles, velocity_scale=1 - np.cos(2 * np.pi * (np.arange(cycles) + 0.5) / cycles))


def area(sheet: ExplicitShells) -> float:
    return float(sheet.position[:, 0].max() * sheet.position[:, 1].max())


@pytest.mark.parametrize("kind", KINDS)
def test_strip_squeezed_in_plane_strain_meets_its_closed_form(kind: str) -> None:
    """Pressure 2/sqrt(3) of the flow stress at 2/sqrt(3) ln(t0/t): 0.1 %; as thick as there is room: 2 %."""
    sheet, above = plates(0.2, held="v", **KINDS[kind])
    thickness, root = sheet.thickness.mean(), 2 / np.sqrt(3)
    strain = np.log(THICKNESS / thickness)
    exact = root * K * (E0 + root * strain) ** N
    strain -= exact / YOUNG * (1 - 0.5 * POISSON)  # the elastic part
    exact = root * K * (E0 + root * strain) ** N
    np.testing.assert_allclose(sheet.pressure, exact, rtol=1e-2)
    assert sheet.pressure.mean() == pytest.approx(exact, rel=1e-3)
    assert above.force[2] == pytest.approx(exact * area(sheet), rel=1e-3)
    assert 1.0 < thickness / above.position[2] < 1.02
    elastic = exact * (1 - 2 * POISSON) / YOUNG  # of the volume, less what the stress along the strip has
    assert thickness * area(sheet) == pytest.approx(THICKNESS * SIDE**2 * (1 - 1.5 * elastic), rel=2e-4)
    np.testing.assert_allclose(sheet.equivalent_plastic_strain.mean(), root * strain, rtol=5e-3)
    # along the strip there is no stress, across it half the pressure
    np.testing.assert_allclose(sheet.stress[:, :, :2].mean(axis=(0, 1)), [0.0, -0.5 * exact], atol=0.02 * exact)
    energy = sheet.energies()
    assert abs(energy.error_percent) < 0.05
    assert energy.internal == pytest.approx(
        root * K * _swift_integral(root * strain) / root * THICKNESS * SIDE**2, rel=0.02
    )


def _swift_integral(strain: float) -> float:
    """Integral of (E0 + e)^N."""
    return float(((E0 + strain) ** (N + 1) - E0 ** (N + 1)) / (N + 1))


@pytest.mark.parametrize("law", ["von Mises", "hill1948"])
def test_sheet_squeezed_freely_flows_at_its_equibiaxial_stress(law: str) -> None:
    """-q across the sheet and nothing in its plane is q, q in the plane and a pressure that does not matter: 0.5 %."""
    r0, r45, r90 = (1.0, 1.0, 1.0) if law == "von Mises" else (1.79, 1.51, 2.27)
    f, g, h = r0 / (r90 * (1 + r0)), 1 / (1 + r0), r0 / (1 + r0)
    n = (r0 + r90) * (1 + 2 * r45) / (2 * r90 * (1 + r0))
    function = _core.YieldFunction.hill1948([f, g, h, n, 1.5, 1.5])
    sheet, above = plates(0.16, law=_core.SheetLaw(YOUNG, POISSON, function, _core.HardeningLaw.swift, [K, E0, N]))
    biaxial = 1 / np.sqrt(f + g)  # of the yield stress along the rolling direction
    exact = biaxial * K * (E0 + biaxial * np.log(THICKNESS / sheet.thickness.mean())) ** N
    assert sheet.pressure.mean() == pytest.approx(exact, rel=5e-3)
    assert above.force[2] == pytest.approx(exact * area(sheet), rel=1e-2)
    assert abs(sheet.energies().error_percent) < 0.05


def test_sheet_held_in_its_plane_is_compressed_by_the_constrained_modulus() -> None:
    sheet, above = plates(0.004, law=mises(), held="uv")
    modulus = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    np.testing.assert_allclose(sheet.pressure, modulus * np.log(THICKNESS / sheet.thickness), rtol=1e-5)
    across = -POISSON / (1 - POISSON) * sheet.pressure[:, None]
    np.testing.assert_allclose(sheet.stress[:, :, 0], np.broadcast_to(across, sheet.stress.shape[:2]), rtol=1e-6)
    assert sheet.energies().internal == pytest.approx(
        0.5 * modulus * (1 - sheet.thickness.mean() / THICKNESS) ** 2 * THICKNESS * SIDE**2, rel=0.01
    )
    stress, thickness = sheet.released()
    move(sheet, above, 0.01)
    np.testing.assert_allclose(thickness, THICKNESS, rtol=1e-6)
    np.testing.assert_allclose(sheet.thickness, THICKNESS, rtol=1e-6)
    np.testing.assert_allclose(stress, 0.0, atol=1e-3)
    np.testing.assert_array_equal(sheet.pressure, 0.0)
    assert above.force[2] == 0.0
    assert abs(sheet.energies().internal) < 1e-3


def compressed_flange(n: int, *, penalty: float, mass_factor: float, held: bool) -> ExplicitShells:
    """A strip compressed by 4 % along x, kept flat without a tool or by two, one pushed with 4 MPa.

    Across its middle it is 2 % thicker.
    """
    points, cells = grid(n, n, SIDE, SIDE)
    thick = np.abs(points[cells][..., 0].mean(axis=1) - 0.5 * SIDE) < 0.25 * SIDE
    sheet = ExplicitShells(points, cells, np.where(thick, 1.02, 1.0) * THICKNESS, SWIFT, DENSITY)
    sheet.scale_mass(np.sqrt(mass_factor) * sheet.stable_step())
    for axis, letter in enumerate("uv"):
        sheet.fix(np.flatnonzero(points[:, axis] == 0), letter)
    time = 0.04 * SIDE / 2000.0
    sheet.fix(np.flatnonzero(points[:, 0] == SIDE), "u", -2000.0)
    if held:
        for name, upwards in (("below", True), ("above", False)):
            tool = sheet.add_tool(name, flat(upwards), penalty=penalty)
            tool.position = [0, 0, (-0.51 if upwards else 0.51) * THICKNESS]
        tool.push([0, 0, -1], ((0.0, 0.2 * time), (0.0, 4.0 * SIDE**2)), damping=2e4)
    else:
        sheet.fix(np.arange(len(points)), "wpq")
    sheet.advance(int(time / sheet.dt))
    return sheet


@pytest.mark.parametrize(
    ("n", "penalty", "mass_factor"), [(4, 0.1, 1.0), (4, 0.03, 1.0), (4, 0.2, 1.0), (8, 0.1, 1.0), (4, 0.1, 9.0)]
)
def test_a_holder_of_a_few_mpa_does_not_thin_a_flange_that_flows(n: int, penalty: float, mass_factor: float) -> None:
    """4 MPa rest on the half that is thicker; it becomes as thick as without them: 0.0001 of it."""
    held, free = (
        compressed_flange(n, penalty=penalty, mass_factor=mass_factor, held=is_held) for is_held in (True, False)
    )
    assert free.thickness.max() > 1.03 * THICKNESS
    np.testing.assert_allclose(held.thickness, free.thickness, rtol=1e-4)
    np.testing.assert_array_equal(held.pressure, 0.0)


def test_a_force_beyond_the_yield_stress_squeezes_the_sheet_to_its_flow_stress() -> None:
    """In plane strain 2/sqrt(3) of it, all of the force: 1 %; the energies balance."""
    sheet, above = plates(0.0, held="v")
    root, force = 2 / np.sqrt(3), 450.0 * SIDE**2
    above.push([0, 0, -1], ((0.0, 4e-3), (0.0, force)), damping=1e5)
    sheet.advance(int(4e-3 / sheet.dt))
    pressure = sheet.pressure.mean()
    strain = np.log(THICKNESS / sheet.thickness.mean()) - pressure / YOUNG * (1 - 0.5 * POISSON)
    assert strain > 0.1
    assert pressure == pytest.approx(root * K * (E0 + root * strain) ** N, rel=1e-2)
    assert pressure * area(sheet) == pytest.approx(force, rel=1e-3)
    assert abs(sheet.energies().error_percent) < 0.05


def test_a_holder_that_stops_pushing_stands_without_squeezing() -> None:
    sheet, above = plates(0.0)
    above.push([0, 0, -1], 10.0 * SIDE**2, damping=2e4)
    sheet.advance(2000)
    above.stop()
    sheet.advance(2000)
    assert above.force[2] > 0.0
    np.testing.assert_array_equal(sheet.pressure, 0.0)


def test_without_ironing_tools_sink_into_the_sheet() -> None:
    sheet, _ = plates(0.1, options=ShellOptions(ironing=False))
    np.testing.assert_allclose(sheet.thickness, THICKNESS, rtol=1e-3)
    np.testing.assert_array_equal(sheet.pressure, 0.0)


def test_a_squeezed_sheet_that_is_shaken_gains_no_energy() -> None:
    """Elastic, of uneven mesh, at 330 MPa, nodes thrown at random by up to 10 m/s: 0.5 % in 4000 cycles."""
    points, cells = grid(8, 8, SIDE, SIDE, distort=0.25)
    sheet = ExplicitShells(points, cells, THICKNESS, mises(), DENSITY)
    sheet.add_tool("below", flat(), mu=0.1, penalty=0.2, damping=0.0).position = [0, 0, -0.5 * THICKNESS]
    above = sheet.add_tool("above", flat(False), mu=0.1, penalty=0.2, damping=0.0)
    above.position = [0, 0, 0.5 * THICKNESS]
    move(sheet, above, -0.006)
    above.velocity = [0, 0, 0]
    moving = sheet.velocity
    moving[:, :3] += np.random.default_rng(5).normal(0.0, 3000.0, (len(points), 3))
    sheet.velocity = moving
    first = sheet.energies()
    assert sheet.pressure.min() > 300.0
    sheet.advance(4000)
    last = sheet.energies()
    total = [e.kinetic + e.internal + e.hourglass + e.contact + e.friction for e in (first, last)]
    assert total[1] == pytest.approx(total[0], rel=5e-3)
    assert first.kinetic > 0.05 * total[0]
    assert last.kinetic < first.kinetic


@pytest.mark.parametrize("precision", ["double", "single"])
def test_squeezed_run_goes_on_with_the_same_bits(precision: str) -> None:
    def begin() -> ExplicitShells:
        return plates(0.02, mu=0.1, precision=precision)[0]

    ahead, resumed = begin(), begin()
    dump = ahead.dump()
    ahead.advance(300)
    resumed.restore(dump)
    resumed.advance(300)
    assert ahead.pressure.min() > 100.0
    for name, values in ahead.dump().items():
        np.testing.assert_array_equal(values, resumed.dump()[name], err_msg=name)
