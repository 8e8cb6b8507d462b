# SPDX-License-Identifier: Apache-2.0
"""The explicit loop: threads, restart, order of the input, laws and options."""

from time import perf_counter

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.energy import EnergyBalance
from presswork.explicit.options import layer_rule
from presswork.explicit.shells import ExplicitError, ExplicitShells, ShellOptions

MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
SWIFT = _core.SheetLaw(207e3, 0.3, MISES, _core.HardeningLaw.swift, [565.0, 0.007, 0.26])
N = 24


def mesh(n: int = N) -> tuple[np.ndarray, np.ndarray]:
    """n x n shells, 48 mm by 48 mm, wavy, inner nodes out of line."""
    x, y = np.meshgrid(np.linspace(0, 48, n + 1), np.linspace(0, 48, n + 1))
    points = np.stack([x.ravel(), y.ravel(), 0.5 * np.sin(x.ravel() / 5) * np.cos(y.ravel() / 7)], axis=1)
    inner = (points[:, :2] > 0).all(axis=1) & (points[:, :2] < 48).all(axis=1)
    points[inner] += np.random.default_rng(8).uniform(-0.3, 0.3, (inner.sum(), 3)) * [1, 1, 0.3]
    first = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    return points, np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)


def halve(cells: np.ndarray) -> np.ndarray:
    """One quadrilateral in five becomes two triangles, at the front."""
    cut = np.arange(len(cells)) % 5 == 0
    return np.concatenate([cells[cut][:, [0, 1, 2, 2]], cells[cut][:, [0, 2, 3, 3]], cells[~cut]])


def make_run(precision: str = "double", law: _core.SheetLaw = SWIFT, n: int = N, **options: object) -> ExplicitShells:
    """One edge held, the opposite one pulled at 5 m/s, and pressed out of the plane: plastic within 100 cycles.

    One quadrilateral in five is halved into triangles.
    """
    points, cells = mesh(n)
    cells = halve(cells)
    shells = ExplicitShells(
        points, cells, 0.8, law, 7.85e-9, options=ShellOptions(**options), precision=precision  # type: ignore[arg-type]
    )  # fmt: skip
    shells.fix(np.flatnonzero(points[:, 0] == 0), "uvwpqr")
    shells.fix(np.flatnonzero(points[:, 0] == 48), "u", 5000.0)
    shells.force = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (len(points), 1))
    return shells


def results(shells: ExplicitShells) -> list[np.ndarray]:
    points = [shells.stress_at_points, shells.history_at_points]
    return [shells.position, shells.velocity, *points, shells.thickness]


KINDS = [("double", "shell4_1pt"), ("single", "shell4_1pt"), ("double", "shell4_mitc_plus")]


@pytest.mark.parametrize(("precision", "element"), KINDS)
def test_threads_do_not_change_a_bit(precision: str, element: str) -> None:
    """State, and energies too, after 300 cycles of plastic flow; shells enough for a second thread to be woken."""
    before = _core.max_threads()
    runs = []
    for threads in (1, 2, 3):
        _core.set_threads(threads)
        shells = make_run(precision, n=36, element=element)
        shells.advance(300)
        assert len(shells.thickness) > 1000
        runs.append([*results(shells), np.array(list(vars_of(shells.energies())))])
    _core.set_threads(before)
    assert (runs[0][3] > 0).any()
    for other in runs[1:]:
        for a, b in zip(runs[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_the_clock_of_phases_adds_up() -> None:
    """No more is shared out than the call has taken, and most of it."""
    shells = make_run(n=36)
    started = perf_counter()
    shells.advance(300)
    wall = perf_counter() - started
    spent = shells.seconds
    assert list(spent) == ["nodes", "elements", "contact", "waiting"]
    assert 0 < spent["nodes"] < spent["elements"]
    assert 0.5 * wall < sum(spent.values()) <= wall


def vars_of(energies: object) -> list[float]:
    return [getattr(energies, name) for name in ("kinetic", "internal", "hourglass", "external", "error_percent")]


@pytest.mark.parametrize(("precision", "element"), KINDS)
def test_a_run_restarted_from_a_dump_gives_the_same_bits(precision: str, element: str) -> None:
    whole = make_run(precision, element=element)
    whole.scale_mass(1.2 * whole.dt)
    whole.advance(150)
    dump = whole.dump()
    whole.advance(150)
    again = make_run(precision, element=element)
    again.restore(dump)
    again.advance(150)
    for a, b in zip(results(whole), results(again), strict=True):
        np.testing.assert_array_equal(a, b)
    assert again.energies() == whole.energies()
    assert (again.cycle, again.time) == (whole.cycle, whole.time)


@pytest.mark.parametrize(
    ("options", "cycles"), [({}, 3000), ({"tabulate": False}, 800), ({"element": "shell4_mitc_plus"}, 2000)]
)
def test_single_precision_follows_double(options: dict[str, object], cycles: int) -> None:
    """Plastic cycles, displacements of 3 mm: position to 5e-6 mm, stress to 1e-5 of 460 MPa, strain to 2e-6,
    thickness to 2e-7 mm."""
    double, single = (make_run(precision, **options) for precision in ("double", "single"))
    for shells in (double, single):
        shells.advance(cycles)
    assert double.equivalent_plastic_strain.max() > 0.03
    assert 0 < np.abs(single.position - double.position).max() < 5e-6
    np.testing.assert_allclose(single.stress, double.stress, atol=1e-5 * 460)
    np.testing.assert_allclose(single.equivalent_plastic_strain, double.equivalent_plastic_strain, atol=2e-6)
    np.testing.assert_allclose(single.thickness, double.thickness, atol=2e-7)
    assert single.energies().error_percent == pytest.approx(double.energies().error_percent, abs=1e-4)


def test_a_mesh_of_both_kinds_keeps_its_order() -> None:
    """Values of shells come in the order given, whatever the order inside; triangles may be given with three nodes."""
    points, cells = mesh()
    both = halve(cells)
    thickness = np.linspace(0.5, 1.0, len(both))
    shells = ExplicitShells(points, both, thickness, SWIFT, 7.85e-9)
    np.testing.assert_array_equal(shells.thickness, thickness)
    area = np.linalg.norm(
        np.cross(points[both[:, 2]] - points[both[:, 0]], points[both[:, 3]] - points[both[:, 1]]), axis=1
    )
    assert shells.mass[:, 0].sum() == pytest.approx((0.5 * area * thickness).sum() * 7.85e-9, rel=1e-12)
    first, last = (ExplicitShells(points, c, 0.8, SWIFT, 7.85e-9) for c in (both[:50], both[:50, :3]))
    np.testing.assert_array_equal(first.bound_frequencies(), last.bound_frequencies())


@pytest.mark.parametrize(
    "treatment", [_core.ShellTreatment.warped, _core.ShellTreatment.stabilized, _core.ShellTreatment.mitc]
)
def test_a_mesh_in_two_blocks_moves_as_in_one(treatment: _core.ShellTreatment) -> None:
    points, cells = mesh()
    height, weight = layer_rule(5, "gauss")
    runs = []
    for parts in ((slice(0, None),), (slice(0, 200), slice(200, None))):
        loop = _core.SpaceLoop(points)
        for part in parts:
            n = len(cells[part])
            axis = np.tile([1.0, 0.0, 0.0], (n, 1))
            loop.add_shells(cells[part], np.full(n, 0.8), axis, SWIFT, 7.85e-9, height, weight, treatment=treatment)
        loop.velocity = np.concatenate([1e4 * points * [1, -0.5, 0], 0 * points], axis=1)
        loop.advance(0.0, 1e-7, 1e-7, np.ones(200), np.ones(200))
        runs.append((loop, np.concatenate([loop.history(i) for i in range(len(parts))])))
    (one, history), (two, histories) = runs
    assert (history > 0).any()
    np.testing.assert_allclose(two.position, one.position, atol=1e-9)
    np.testing.assert_allclose(histories, history, atol=1e-10)
    np.testing.assert_allclose(two.bound_frequencies(), one.bound_frequencies(), rtol=1e-8)
    np.testing.assert_array_equal(two.element_mass, one.element_mass)


def test_calls_may_be_long_or_short() -> None:
    one, many = make_run(), make_run()
    ramp = np.linspace(0, 1, 60)
    one.advance(60, velocity_scale=ramp)
    for part in ramp.reshape(6, 10):
        many.advance(10, velocity_scale=part)
    np.testing.assert_array_equal(one.position, many.position)


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
def test_numbering_does_not_matter(element: str) -> None:
    """Nodes, elements and the first node of each element renumbered: the same motion."""
    points, cells = mesh()
    rng = np.random.default_rng(3)
    new = rng.permutation(len(points))
    shuffled = np.empty_like(points)
    shuffled[new] = points
    turned = np.stack([np.roll(new[c], rng.integers(4)) for c in cells])[rng.permutation(len(cells))]
    runs = []
    for x, c, place in ((points, cells, np.arange(len(points))), (shuffled, turned, new)):
        options = ShellOptions(element=element)  # type: ignore[arg-type]
        shells = ExplicitShells(x, c, 0.8, SWIFT, 7.85e-9, options=options)
        shells.fix(place[points[:, 0] == 0], "uvwpqr")
        shells.fix(place[points[:, 0] == 48], "u", 5000.0)
        shells.advance(200)
        runs.append(shells.position[place])
    np.testing.assert_allclose(runs[0], runs[1], atol=1e-9)


def test_shells_begin_with_the_layers_they_are_given() -> None:
    """Fully integrated ones at every point, or with one value for all; triangles beside them take the mean."""
    first = make_run(element="shell4_mitc_plus")
    first.advance(200)
    stress, history = first.stress_at_points, first.history_at_points
    assert stress.shape[:3] == (len(first.connectivity), 4, 5)
    of_quads = first.connectivity[:, 2] != first.connectivity[:, 3]
    assert np.ptp(history[of_quads, ..., 0], axis=1).max() > 1e-3
    np.testing.assert_array_equal(np.ptp(stress[~of_quads], axis=1), 0.0)
    second = make_run(element="shell4_mitc_plus")
    second.set_layers(stress, history)
    np.testing.assert_allclose(second.stress_at_points, stress, atol=1e-12 * np.abs(stress).max())
    np.testing.assert_array_equal(second.history_at_points, history)
    second.set_layers(first.stress, first.history)
    np.testing.assert_allclose(second.stress_at_points[:, 2], first.stress, atol=1e-12 * np.abs(stress).max())
    assert np.abs(second.internal_force).max() > 1.0


def test_the_fast_law_and_the_general_one_give_the_same_run() -> None:
    fast, general = make_run(), make_run(tabulate=False)
    for shells in (fast, general):
        shells.advance(300)
    assert (fast.equivalent_plastic_strain > 1e-3).mean() > 0.1
    np.testing.assert_allclose(fast.position, general.position, atol=1e-6)
    np.testing.assert_allclose(fast.stress, general.stress, atol=1e-3)


@pytest.mark.parametrize(("precision", "element"), KINDS)
def test_a_law_that_finds_no_stress_stops_the_run_with_its_shell(precision: str, element: str) -> None:
    """One node is torn through its neighbours: the first shell to fail is the same for any threads, and news of the
    node can have reached it; what was dumped before runs on.
    """
    law = _core.SheetLaw(
        207e3, 0.3, _core.YieldFunction.hill1948([0.3, 0.4, 0.6, 1.5, 1.5, 1.8]), _core.HardeningLaw.swift,
        [565.0, 0.007, 0.26],
    )  # fmt: skip
    found, torn, before = [], N // 2 * (N + 2), _core.max_threads()
    for threads in (1, 2):
        _core.set_threads(threads)
        points, cells = mesh()
        options = ShellOptions(element=element)  # type: ignore[arg-type]
        shells = ExplicitShells(
            points, np.repeat(cells, 2, axis=0), 0.8, law, 7.85e-9, options=options, precision=precision  # type: ignore[arg-type]
        )  # fmt: skip
        shells.advance(2)
        good = shells.dump()
        shells.fix([torn], "u", 5e6)
        with pytest.raises(
            ExplicitError, match=r"the material law of shell \d+ has failed in cycle \d+ .*too long"
        ) as stop:
            shells.advance(200)
        found.append(str(stop.value))
        assert shells.cycle == 2
        shells.release()
        shells.restore(good)
        shells.advance(20)
        assert np.isfinite(shells.position).all()
    _core.set_threads(before)
    assert found[0] == found[1]
    shell, cycle = (int(found[0].split(word)[1].split()[0]) for word in ("shell ", "cycle "))
    middle = points[np.repeat(cells, 2, axis=0)[shell]].mean(axis=0)
    assert np.linalg.norm(middle - points[torn]) < 3.0 * (cycle - 2)  # news travels by a shell a cycle


HARDENINGS = {
    "swift": [565.0, 0.007, 0.26],
    "linear_voce": [160.0, 400.0, 12.0, 80.0],
    "swift_voce": [0.4, 565.32, 0.007117, 0.2589, 160.0, 400.0, 12.0],
    "monotone_table": [0.0, 160.0, 4000.0, 0.02, 220.0, 2000.0, 0.3, 420.0, 300.0],
    "table": [0.0, 160.0, 0.02, 220.0, 0.3, 420.0],
}


@pytest.mark.parametrize("hardening", HARDENINGS)
def test_every_sheet_law_gives_the_same_run_with_its_hardening_from_a_table(hardening: str) -> None:
    """Barlat's sheet with rate and back stress; a curve of straight lines stays with its formula."""
    law = _core.SheetLaw(
        207e3, 0.3, _core.YieldFunction.barlat1989(1.1, 1.05, 0.97, 1.02, 6), _core.HardeningLaw[hardening],
        HARDENINGS[hardening], rate=_core.RateLaw.cowper_symonds, rate_parameters={"D": 40.0, "q": 5.0},
        chaboche=_core.Chaboche([3000.0], [60.0]),
    )  # fmt: skip
    table, formula = make_run(law=law), make_run(law=law, tabulate=False)
    for shells in (table, formula):
        shells.advance(300)
    assert (table.equivalent_plastic_strain > 1e-3).mean() > 0.1
    np.testing.assert_allclose(table.position, formula.position, atol=1e-6)
    np.testing.assert_allclose(table.stress, formula.stress, atol=1e-3)
    same = np.array_equal(table.stress, formula.stress)
    assert same == (hardening == "table")


def test_the_rolling_direction_turns_with_the_sheet() -> None:
    """Hill's sheet pulled along its rolling direction, whichever way it lies in space: the same force and thickness."""
    yield_function = _core.YieldFunction.hill1948([0.3, 0.4, 0.6, 1.5, 1.5, 1.8])
    law = _core.SheetLaw(207e3, 0.3, yield_function, _core.HardeningLaw.swift, [565.0, 0.007, 0.26])
    found = []
    for angle in (0.0, 0.6):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        points, cells = mesh()
        points[:, 2] = 0.0
        shells = ExplicitShells(points @ turn.T, cells, 0.8, law, 7.85e-9, axis=turn[:, 0])
        motion = np.zeros((len(points), 6))
        motion[:, :3] = (points * [5000.0 / 48, -1500.0 / 48, 0.0]) @ turn.T
        for i, letter in enumerate("uvw"):
            shells.fix(np.arange(len(points)), letter, motion[:, i])
        shells.advance(300)
        found.append((shells.stress, shells.thickness))
    assert found[0][0][:, :, 0].min() > 200.0
    np.testing.assert_allclose(found[0][0], found[1][0], atol=1e-6)
    np.testing.assert_allclose(found[0][1], found[1][1], rtol=1e-9)


@pytest.mark.parametrize(
    "options",
    [
        {"hourglass": "physical"},
        {"warping": False},
        {"hourglass": "viscous"},
        {"coefficients": (0.1, 0.03, 0.03)},
        {"coefficients": (0.03, 0.1, 0.03)},
        {"coefficients": (0.03, 0.03, 0.1)},
        {"n_points": 7},
        {"rule": "lobatto"},
    ],
)
def test_every_option_changes_the_result(options: dict[str, object]) -> None:
    stiff = {"hourglass": "stiffness"}
    plain, other = make_run(**stiff), make_run(**(stiff | options))
    for shells in (plain, other):
        shells.advance(200)
    assert 1e-9 < np.abs(plain.position - other.position).max() < 1.0
    assert abs(other.energies().error_percent) < 1.0


def test_fully_integrated_shells_move_like_those_of_one_point_and_have_no_hourglass_energy() -> None:
    """Tension and pressure on a coarse wavy sheet, plastic: positions within 2 % of the way (1.2 %)."""
    points, cells = mesh()
    runs = []
    for element in ("shell4_1pt", "shell4_mitc_plus"):
        options = ShellOptions(element=element)  # type: ignore[arg-type]
        shells = ExplicitShells(points, cells, 0.8, SWIFT, 7.85e-9, options=options)
        shells.fix(np.flatnonzero(points[:, 0] == 0), "uvwpqr")
        shells.fix(np.flatnonzero(points[:, 0] == 48), "u", 5000.0)
        shells.force = np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (len(points), 1))
        runs.append(shells)
    one, four = runs
    for shells in runs:
        shells.dt = min(one.dt, four.dt)
        shells.advance(1500)
        assert abs(shells.energies().error_percent) < 1.0
    moved = np.abs(one.position - points).max()
    assert 1e-5 * moved < np.abs(one.position - four.position).max() < 0.02 * moved
    assert one.energies().hourglass > 0.0
    assert four.energies().hourglass == 0.0


def test_damping_takes_energy_and_says_how_much() -> None:
    shells = make_run()
    shells.force = np.zeros((len(shells.position), 6))
    shells.advance(200)
    shells.fix(np.arange(len(shells.position))[shells.position[:, 0] > 47], "u", 0.0)
    before = shells.energies()
    shells.advance(2000, damping=5e4)
    after = shells.energies(damping=5e4)
    assert after.kinetic < 0.1 * before.kinetic
    assert after.damping > 0.5 * before.kinetic
    assert abs(after.error_percent) < 1.0


def test_energies_out_of_hand_are_warned_of() -> None:
    """A sheet hurled at its clamp is not quasi-static; one that vibrates in hourglass modes alone says so."""
    shells = make_run()
    shells.advance(20)
    assert ["kinetic energy" in w for w in shells.energies().warnings()].count(True) == 1
    points, cells = mesh()
    points[:, 2] = 0.0
    odd = np.zeros((len(points), 6))
    odd[:, 0] = 1.0 - 2.0 * (np.add(*np.divmod(np.arange(len(points)), N + 1)) % 2)
    shells = ExplicitShells(points, cells, 0.8, SWIFT, 7.85e-9)
    shells.velocity = odd
    shells.advance(5)
    assert any("hourglass energy" in w for w in shells.energies().warnings())
    assert EnergyBalance(1.0, 100.0, 1.0, 100.0, 0.0, 0.1).warnings() == []
    assert "off by 7 %" in EnergyBalance(1.0, 100.0, 1.0, 100.0, 0.0, 7.0).warnings()[0]


def test_mass_scaling_reaches_its_step_and_reports_the_mass() -> None:
    shells = make_run()
    plain, total = shells.dt, shells.mass[:, 0].sum()
    none = shells.scale_mass(0.5 * plain)
    assert none.added == 0.0
    assert none.n_elements == 0
    added = shells.scale_mass(1.3 * plain)
    assert shells.dt == 1.3 * plain
    assert shells.stable_step() == pytest.approx(1.3 * plain / 0.9, rel=1e-9)
    assert 0 < added.n_elements < N * N
    assert shells.mass[:, 0].sum() == pytest.approx(total + added.added, rel=1e-12)
    assert added.percent == pytest.approx(100 * added.added / total, rel=1e-9)
    shells.advance(300)
    assert abs(shells.energies().error_percent) < 1.0


@pytest.mark.parametrize(
    ("n", "rule", "degree"), [(1, "gauss", 1), (5, "gauss", 9), (2, "lobatto", 1), (7, "lobatto", 11)]
)
def test_layer_rules_are_exact_to_their_degree(n: int, rule: str, degree: int) -> None:
    height, weight = (np.array(v) for v in layer_rule(n, rule))
    for power in range(degree + 1):
        exact = 0.0 if power % 2 else 1.0 / (power + 1)
        assert (weight * height**power).sum() == pytest.approx(exact, abs=1e-14)
