# SPDX-License-Identifier: Apache-2.0
"""Print the figures of docs/verification, from the same functions that the tests call.

Run: python -m validation.print_figures
"""

from __future__ import annotations

import numpy as np

from tests.problems.plane_solids import ELEMENTS, fit_rate, fixed_increments
from tests.verification import test_body_contact as bodies
from tests.verification import test_contact_patch as contact_patch
from tests.verification import test_limit_loads as limit
from tests.verification import test_newton_rate as newton
from tests.verification import test_patch_tests as patch
from tests.verification import test_simple_shear_closed_form as shear
from tests.verification import test_stick_slip as stick_slip
from tests.verification import test_thick_cylinder_and_sphere as ring
from tests.verification import test_uniaxial_closed_form as uniaxial


def print_patch() -> None:
    """Largest stress error of the axisymmetric patch test at 30 % stretch."""
    for element in ELEMENTS:
        stress = patch.squeeze_ring(patch.patch(element, "axisymmetric")).state.cells.stress[0]
        error = np.abs(stress - patch.AXISYMMETRIC_STRESS).max() / np.abs(patch.AXISYMMETRIC_STRESS).max()
        print(f"patch test, axisymmetric, 30 %, {element:12s} error {error:.1e}")


def print_uniaxial() -> None:
    """Error of the stress and the equivalent plastic strain at +-100 %."""
    for strain in (1.0, -1.0):
        for measure, counts in (("log", (10, 1000)), ("stretch", (10, 20, 40, 80, 160, 1000))):
            for n in counts:
                cells = uniaxial.pull("linear", strain, fixed_increments(n, strain_measure=measure))[0].state.cells
                stress, p, _ = uniaxial.exact("linear", strain)
                print(
                    f"uniaxial {strain:+.0f}, {measure:8s} {n:5d} increments: stress off by "
                    f"{cells.stress[0][0, 0, 1] / stress - 1:+.1e}, eqps by {cells.eqps[0][0, 0] / p - 1:+.1e}"
                )


def print_shear() -> None:
    """Elastic simple shear, and what separates the rates in a metal."""
    for g in (0.5, 1.0, 2.0):
        many = shear.shear_element("quad4_fbar", g, 200)
        jaumann, total = shear.jaumann(g), shear.green_naghdi(g)
        print(
            f"simple shear {g}: s12/mu {many[0]:.6f}, s11/mu {many[1]:.6f}; Jaumann {jaumann[0]:.6f} {jaumann[1]:.6f}; "
            f"Green-Naghdi {total[0]:.6f} {total[1]:.6f}; s12 differs by {jaumann[0] / total[0] - 1:+.2%}"
        )
        law = shear.make_law(700.0, 300.0)
        ours, theirs = (shear.shear_point(law, g, 2000, rate) for rate in ("incremental", "green_naghdi"))
        print(
            f"  steel 700 + 300 p: s12 {ours[0, 1]:.4f} and {theirs[0, 1]:.4f} MPa "
            f"({ours[0, 1] / theirs[0, 1] - 1:+.1e}), s11 {ours[0, 0]:.3f} and {theirs[0, 0]:.3f} MPa"
        )


def print_rings() -> None:
    """Convergence of the thick cylinder and sphere."""
    for shape in ("cylinder", "sphere"):
        for element in ring.ELEMENTS:
            quadratic = element in ("tri6_7pt", "quad8_2x2")
            for kind, sizes in (
                ("elastic", [2, 4, 8] if quadratic else [4, 8, 16]),
                ("plastic", [3, 6, 12] if quadratic else [5, 10, 20]),
            ):
                poisson = 0.499 if kind == "plastic" and shape == "cylinder" else 0.3
                if kind == "elastic":
                    pressure = 50.0 * ring.SCALE
                    exact = ring.lame(shape, pressure, poisson)
                else:
                    pressure, *exact = ring.hill(shape, 150.0, poisson)
                errors = [
                    np.abs(np.array(ring.expand(shape, element, n, pressure, poisson)) / exact - 1).max() for n in sizes
                ]
                rate = fit_rate([1 / n for n in sizes], errors).rate
                print(f"{shape:8s} {element:10s} {kind}: rate {rate:.2f}, error on {sizes[-1]} cells {errors[-1]:.1e}")
        for front in (120.0, 150.0, 180.0):
            row = ring.TABLE[shape][ring.TABLE[shape][:, 0] == front][0]
            actual = np.array(ring.expand(shape, "quad8_2x2", 10, 1e3 * ring.SCALE * row[1], 0.3))
            off = actual / (ring.SCALE * row[2:]) - 1
            print(f"{shape:8s} front at {front:.0f}: outer {off[0]:+.2%}, inner {off[1]:+.2%} off the table")


def print_limits() -> None:
    """Limit loads at 300 and 3000 s0/E."""
    cases = [(e, c, None) for e, c in limit.FREE_OF_LOCKING.items()]
    cases += [("tri3", limit.MIDDLE, "right"), ("quad4", limit.MIDDLE, "quad")]
    for problem in limit.PROBLEMS:
        for element, cells, pattern in cases:
            near, far = limit.load_over_limit(problem, element, cells, pattern)
            print(f"{problem} {element:10s} {pattern or '':6s} {cells}: {near:.4f} at 300, {far:.4f} at 3000 s0/E")
    for element in ("tri3", "quad4_fbar"):
        loads = [limit.load_over_limit("punch", element, (n, n + 2, n + 4))[1] for n in (6, 12, 24)]
        print(f"punch {element} refined 6, 12, 24: " + " ".join(f"{x:.4f}" for x in loads))


def print_contact() -> None:
    """Contact patch test, and the strip that sticks and slips."""
    for element in ELEMENTS:
        errors = [
            contact_patch.stress_error(contact_patch.patch(element, analysis, degrees), degrees)
            for analysis, degrees in (("plane_strain", 0.0), ("plane_strain", 30.0), ("axisymmetric", 0.0))
        ]
        print(f"contact patch test {element:12s} " + " ".join(f"{e:.1e}" for e in errors))
    fall = 2 * np.sqrt(stick_slip.MODULUS * stick_slip.SHEAR * 0.5 * stick_slip.WAY / stick_slip.THICKNESS)
    for element in ("quad4_fbar", "quad8_2x2", "tri6_7pt"):
        stresses, drags = stick_slip.push_strip(element)
        front = np.abs(drags[0]).sum() / stick_slip.SHEAR
        back = stick_slip.STRESS - stresses[1]
        print(
            f"strip {element:10s} stress {stresses[0] / stick_slip.STRESS - 1:+.3%}, "
            f"front {front / stick_slip.FRONT - 1:+.3%}, pulled back {back / fall - 1:+.3%}"
        )


def print_newton() -> None:
    """Order of the Newton iteration."""
    for element in ELEMENTS:
        print(f"newton {element:12s} order {np.median(newton.orders(newton.residuals(element, False))):.2f}")
    for symmetric in (False, True):
        print(
            f"newton tri3 symmetric={symmetric}: "
            + " ".join(f"{r:.1e}" for r in newton.residuals("tri3", symmetric)[2])
        )


def print_bodies() -> None:
    """Contact of bodies: Hertz's pressure, Coulomb's drag, a slot that closes."""
    for refined, slave in ((1, 0), (1, 1), (2, 1)):
        x, pressure, a, peak = bodies.press_cylinders(slave, refined)
        exact = peak * np.sqrt(np.maximum(0.0, 1 - (x / a) ** 2))
        inner = x < 0.6 * a
        print(
            f"hertz, slave {slave}, refined {refined}: a = {a:.4f} mm, contact to {x.max():.4f} mm, peak "
            f"{pressure.max() / peak:.4f}, within 0.6 a {np.abs(pressure / exact - 1)[inner].max():.4f}"
        )
    for (force, _), way in zip(bodies.slide_block("coulomb", mu=0.2), ("press", "slide", "back"), strict=True):
        print(f"sliding block, {way}: drag over load {force[0] / force[1]:+.8f}")
    for n in (1, 2, 4):
        whole, half = (bodies.close_slot(n, whole=w)[0] for w in (True, False))
        print(f"slot that closes, refined {n}: force {whole / half - 1:+.5%} off the half on a rigid plane")


if __name__ == "__main__":
    print_patch()
    print_uniaxial()
    print_shear()
    print_rings()
    print_limits()
    print_contact()
    print_newton()
    print_bodies()
