# SPDX-License-Identifier: Apache-2.0
"""The code for cards, by its host build: agreement with the loop of the CPU, threads, restart across both, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import _core
from presswork.cli.commands import app
from presswork.explicit.shells import Device, ExplicitError, ExplicitShells, ShellOptions
from presswork.explicit.space import Precision
from presswork.model import ExplicitElement
from tests.consistency import test_explicit_cup as cup
from tests.consistency.test_explicit_shells import SWIFT, N, halve, mesh, results
from tests.verification.test_squeezed_sheet import plates

CYCLES, CYCLES_OF_TOOLS = 400, 1200
AGREEMENT = {"double": 1e-12, "single": 1e-5}
"""Of the largest value, after CYCLES: round-off; 5e-15 and 1e-6 are found."""
WITH_TOOLS = {"double": 1e-10, "single": 1e-3}
"""Of the largest value, after CYCLES_OF_TOOLS: contact comes and goes by round-off; 4e-12 and 1e-4 are found."""
SQUEEZED = 1e-9
"""Of the largest value; 4e-11 is found, of velocities. Pressed four times slower, round-off grows to all of them."""


def make_run(device: Device, precision: Precision = "double", n: int = N, **changes: object) -> ExplicitShells:
    """One edge held, the opposite one pulled at 20 m/s, and pressed out of the plane; some mass added.

    One quadrilateral in five is halved into triangles.
    """
    points, cells = mesh(n)
    cells = halve(cells)
    given = {"law": SWIFT, "options": ShellOptions()} | changes
    shells = ExplicitShells(
        points, cells, 0.8, density=7.85e-9, precision=precision, device=device, **given  # type: ignore[arg-type]
    )  # fmt: skip
    shells.fix(np.flatnonzero(points[:, 0] == 0), "uvwpqr")
    shells.fix(np.flatnonzero(points[:, 0] == 48), "u", 20000.0)
    shells.force = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (len(points), 1))
    shells.scale_mass(1.2 * shells.stable_step())
    return shells


def advance(shells: ExplicitShells, n: int) -> None:
    shells.advance(n, damping=50.0, force_scale=np.linspace(0.5, 1.0, n), velocity_scale=np.linspace(0.2, 1.0, n))


def everything(shells: ExplicitShells) -> list[np.ndarray]:
    energies = shells.energies()
    kinds = [energies.internal, energies.hourglass, energies.kinetic, energies.external, energies.damping]
    return [*results(shells), shells.internal_force, shells.reaction_impulse, np.array(kinds)]


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_host_build_agrees_with_the_loop(precision: Precision, element: ExplicitElement) -> None:
    """Motion, layers, thickness, forces, reactions and energies after plastic flow."""
    options = ShellOptions(element=element)
    runs = [make_run(device, precision, options=options) for device in ("cpu", "host")]
    for run in runs:
        advance(run, CYCLES)
    assert runs[0].history_at_points.max() > 0.04
    for expected, found in zip(*map(everything, runs), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=AGREEMENT[precision] * np.abs(expected).max())


@pytest.mark.parametrize(("precision", "radius"), [("double", 3.0), ("single", 3.0), ("double", 1.0)])
@pytest.mark.parametrize("triangles", [False, True])
def test_a_cup_drawn_on_the_host_build_agrees_with_the_loop(
    precision: Precision, triangles: bool, radius: float
) -> None:
    """Die, punch and pushed holder with friction: motion, stress, thickness, forces of tools, energies.

    Radii of 1 mm are sharp for the mesh: edges touch.
    """
    runs = [cup.draw(precision, triangles=triangles, radius=radius, device=device) for device in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES_OF_TOOLS)
    assert np.abs(runs[0].tools["punch"].force).max() > 1000.0
    for expected, found in zip(*map(cup.results, runs), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=WITH_TOOLS[precision] * np.abs(expected).max())


def test_a_sheet_squeezed_on_the_host_build_agrees_with_the_loop() -> None:
    """Two plates press a sheet of each kind of shells thinner by a tenth."""
    mitc = {"options": ShellOptions(element="shell4_mitc_plus")}
    for kind in ({"cut": False}, {"cut": True}, mitc):
        runs = [plates(0.08, mu=0.1, speed=1200.0, device=device, **kind)[0] for device in ("cpu", "host")]
        assert runs[0].thickness.max() < 0.77
        for expected, found in zip(*map(cup.results, runs), strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=SQUEEZED * np.abs(expected).max())


@pytest.mark.parametrize(("first", "second"), [("host", "host"), ("cpu", "host"), ("host", "cpu")])
def test_a_cup_goes_on_across_devices(first: Device, second: Device) -> None:
    whole, begun, resumed = (cup.draw(radius=1.0, device=device) for device in (second, first, second))
    whole.advance(500)
    whole.advance(400)
    begun.advance(500)
    resumed.restore(begun.dump())
    resumed.advance(400)
    for expected, found in zip(cup.results(whole), cup.results(resumed), strict=True):
        if first == second:
            np.testing.assert_array_equal(found, expected)
        else:
            np.testing.assert_allclose(found, expected, rtol=0, atol=WITH_TOOLS["double"] * np.abs(expected).max())


def test_tools_moved_by_hand_and_taken_away_on_the_host_build() -> None:
    """A tool that is placed, one that is taken away, and one that a pushed tool comes to stand on."""
    runs = [cup.draw(device=device) for device in ("cpu", "host")]
    for run in runs:
        run.advance(400)
        run.remove_tool("die")
        run.tools["holder"].stop()
        run.tools["holder"].position = run.tools["holder"].position + np.array([0.0, 0.0, 0.01])
        run.advance(600)  # until the sheet lies still: contact comes and goes by round-off before
    for expected, found in zip(*map(cup.results, runs), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=WITH_TOOLS["double"] * np.abs(expected).max())


def test_threads_and_a_second_run_do_not_change_a_bit() -> None:
    before, runs = _core.max_threads(), []
    for threads in (1, 2, 3, 3):
        _core.set_threads(threads)
        shells = make_run("host", n=36)
        advance(shells, 60)
        runs.append(everything(shells))
    _core.set_threads(before)
    for other in runs[1:]:
        for a, b in zip(runs[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(("first", "second"), [("host", "host"), ("cpu", "host"), ("host", "cpu")])
def test_a_dump_goes_on_across_devices(first: Device, second: Device) -> None:
    """With the same bits as one device that is never stopped; from one to another by the agreement of both."""
    whole, begun, resumed = make_run(second), make_run(first), make_run(second)
    whole.advance(120)
    begun.advance(70)
    resumed.restore(begun.dump())
    resumed.advance(50)
    for expected, found in zip(results(whole), results(resumed), strict=True):
        if first == second:
            np.testing.assert_array_equal(found, expected)
        else:
            np.testing.assert_allclose(found, expected, rtol=0, atol=AGREEMENT["double"] * np.abs(expected).max())


def test_what_no_device_computes_is_refused() -> None:
    with pytest.raises(ExplicitError, match="does not compute shells of one point without physical"):
        make_run("host", options=ShellOptions(hourglass="stiffness"))
    points, cells = mesh()
    with pytest.raises(ExplicitError, match="give 'cpu' or 'host' or 'cuda'"):
        ExplicitShells(points, cells, 0.8, SWIFT, 7.85e-9, device="gpu")  # type: ignore[arg-type]


def test_a_card_that_is_not_there_is_refused_with_the_way_out() -> None:
    cards, why = _core.list_cuda_cards()
    if cards:
        pytest.skip("there is a card")
    assert "PRESSWORK_CUDA=ON" in why or "NVIDIA" in why
    with pytest.raises(ExplicitError, match=r'device = "cuda": .*; or take device = "cpu"'):
        make_run("cuda")
    listed = CliRunner().invoke(app, ["devices"]).output
    assert [line.split()[0] for line in listed.splitlines()] == ["cpu", "host", "cuda"]
    assert why in listed
