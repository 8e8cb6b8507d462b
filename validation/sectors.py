# SPDX-License-Identifier: Apache-2.0
"""The packaged examples of the plane and of axisymmetry as slices and sectors in space, a row for each.

Run: python -m validation.sectors [names]
"""

from __future__ import annotations

import sys

import numpy as np

from tests.problems.examples_in_space import TRIALS, compare


def main() -> None:
    """Print a row for each example."""
    print("example, reached; largest difference of the force: of an increment, of a twentieth of the way, of all;")
    print("profile, heat [%]; seconds")
    for name in sys.argv[1:] or TRIALS:
        found = compare(name)
        force = (np.abs(found.force).max(), np.abs(found.part).max(), found.work)
        shown = [100 * x for x in (found.reached, *force, found.profile, found.cooling)]
        print(name, *(f"{x:.2f}" for x in shown), *(f"{c.seconds:.1f}" for c in found.courses), flush=True)
        for course in found.courses:
            if course.reason:
                print("  ", course.reason)


if __name__ == "__main__":
    main()
