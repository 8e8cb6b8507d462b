# SPDX-License-Identifier: Apache-2.0
"""Laws identified on the first part of a measured test with a reversal, held against the rest of it.

The test is that of NIST for NUMISHEET 2020: AA6xxx-T4, tension to a true strain of 0.0505 and compression back to
-0.0044 (`validation/measured/`). Laws that are fitted to the tension and to a part of the compression predict the rest.

    python -m validation.cyclic_hardening --picture docs/img/cyclic_hardening.png
"""

from __future__ import annotations

import argparse
from functools import cache
from pathlib import Path

from presswork.material.cyclic import CyclicTest, read_cyclic
from presswork.material.cyclic_laws import CYCLIC_LAWS
from presswork.material.identify_cyclic import CyclicFit, fit_cyclic

DATA = Path(__file__).parent / "measured" / "nist_numisheet2020_aa6xxx_t4_two_branches.csv"
YOUNG = 68.5e3
"""[MPa] Between the slopes of both branches, 70.3 and 66.6 GPa."""
PARTS = (1.1, 1.2, 1.3, 1.5, 2.0)
"""Branches that are fitted; 2: all."""
SHOWN = 1.2


@cache
def read_test() -> CyclicTest:
    """Return the measured test."""
    return read_cyclic(DATA)


@cache
def fit(law: str, fitted: float) -> CyclicFit:
    """Return a law fitted to the first branches of the test."""
    return fit_cyclic(read_test(), law, YOUNG, fitted)[0]


def main() -> None:
    """Print errors by law and part fitted, and draw one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    top = max(float(abs(branch.stress).max()) for branch in read_test().branches)
    print(f"largest stress {top:.1f} MPa; root mean square errors [MPa]: fitted / predicted, of the largest stress")
    for law in CYCLIC_LAWS:
        cells = []
        for part in PARTS:
            one = fit(law, part)
            fitted, predicted = one.find_error(fitted=True), one.find_error(fitted=False)
            cells.append(f"{part:g}: {fitted:5.1f} / {predicted:5.1f} ({100 * predicted / top:4.1f} %)")
        print(f"{law:16s}", "   ".join(cells))
    for law in CYCLIC_LAWS:
        print(law, {name: float(f"{value:.5g}") for name, value in fit(law, 2.0).parameters.items()})
    if arguments.picture:
        from presswork.material.cyclic_plot import draw_cyclic

        fits = sorted((fit(law, SHOWN) for law in CYCLIC_LAWS), key=lambda one: one.criterion)
        title = "AA6xxx-T4, NIST: laws of the tension and of a fifth of the compression"
        draw_cyclic(read_test(), fits, title, arguments.picture)


if __name__ == "__main__":
    main()
