# SPDX-License-Identifier: Apache-2.0
"""Cost of one plane-stress update per point, every point plastic: by packs and a point at a time, one thread.

    python -m benchmarks.sheet_update [--strain 2e-3]

Increments of 0.2 % of strain, as an implicit increment makes them (an explicit step is about 1e-5), from a state that
has been strained by 5 %, in processor time. The figures hold the copying of arrays in and out as well.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from presswork import _core
from presswork.case.material.yield_function import Barlat1989, Hill1948

N = 40_000
YOUNG, POISSON = 70e3, 0.33
ALPHA = [0.4865, 1.3783, 0.7536, 1.0246, 1.0363, 0.9036, 1.2321, 1.4858]
YIELDS = {
    "von Mises": _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5]),
    "Hill 1948": Hill1948(r00=1.79, r45=1.51, r90=2.27).build(),
    "Barlat 1989, 6": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=6).build(),
    "Barlat 1989, 8": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=8).build(),
    "Yld2000-2d, 6": _core.YieldFunction.yld2000(ALPHA, 6),
    "Yld2000-2d, 8": _core.YieldFunction.yld2000(ALPHA, 8),
}
HARDENINGS = {
    "linear": ("linear", [200.0, 300.0], {}),
    "Swift": ("swift", [565.0, 0.007, 0.26], {}),
    "Voce": ("voce", [140.0, 330.0, 12.4], {}),
    "table": ("table", [0.0, 200.0, 0.05, 300.0, 0.5, 400.0], {}),
    "Voce, Chaboche": ("voce", [140.0, 330.0, 12.4], {"chaboche": _core.Chaboche([3000.0, 500.0], [60.0, 5.0])}),
    "Yoshida-Uemori": (
        "linear",
        [150.0, 0.0],
        {"yoshida_uemori": _core.YoshidaUemori(Y=150.0, B=190.0, C=200.0, m=12.0, b=40.0, Rsat=190.0, h=0.4)},
    ),
}


def time_update(law: _core.SheetLaw, size: float, *, tangent: bool, packed: bool) -> float:
    """Return nanoseconds for one point, the best of seven."""
    rng = np.random.default_rng(1)
    direction = rng.standard_normal((N, 3))
    stress, history = np.zeros((N, 3)), np.zeros((N, law.history_size))
    for _ in range(5):
        stress, history, *_ = law.update(0.01 * direction, stress, history)
    strain = size * (direction + 0.1 * rng.standard_normal((N, 3)))
    best = np.inf
    for _ in range(7):
        start = time.process_time()
        _, after, _, _, failed = law.update(strain, stress, history, tangent=tangent, packed=packed)
        best = min(best, time.process_time() - start)
    plastic = (after[:, 0] > history[:, 0]).mean()
    assert plastic > 0.99, f"{plastic:.1%} of the points are plastic"
    assert not failed.any()
    return best / N * 1e9


def main() -> None:
    """Print the table: yield functions with Voce's law, then hardening laws with Yld2000-2d."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--strain", type=float, default=2e-3, help="size of the increment")
    size = parser.parse_args().strain
    print(f"packs of {_core.pack_width}; ns a point   {'packs':>8} {'+ tangent':>10} {'scalar':>8} {'+ tangent':>10}")
    for name, function in YIELDS.items():
        law = _core.SheetLaw(YOUNG, POISSON, function, _core.HardeningLaw.voce, HARDENINGS["Voce"][1])
        print_row(name, law, size)
    print("with Yld2000-2d, 8:")
    for name, (kind, parameters, options) in HARDENINGS.items():
        function = YIELDS["Yld2000-2d, 8"]
        law = _core.SheetLaw(YOUNG, POISSON, function, _core.HardeningLaw[kind], parameters, **options)
        print_row(name, law, size)


def print_row(name: str, law: _core.SheetLaw, size: float) -> None:
    """Time one law in the four ways."""
    times = [time_update(law, size, tangent=t, packed=p) for p in (True, False) for t in (False, True)]
    print(f"{name:24}   {times[0]:8.1f} {times[1]:10.1f} {times[2]:8.1f} {times[3]:10.1f}")


if __name__ == "__main__":
    main()
