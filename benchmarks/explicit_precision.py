# SPDX-License-Identifier: Apache-2.0
"""What single precision and the code for cards change in the packaged square cup.

`python -m benchmarks.explicit_precision` prints largest differences to the CPU's loop in double precision;
`--device cuda` computes on a card.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.post.section import measure_draw_in
from presswork.recorder import run_model


def draw(device: str, precision: str, folder: Path) -> Result:
    """Run the packaged cup."""
    keys = [f"explicit.device={device}", f"explicit.precision={precision}"]
    place = folder / f"{device}_{precision}"
    place.mkdir()
    model = build_model(read_case(copy_example("square_cup", place), keys))
    outcome = run_model(model, place / "results", threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--device", default="host")
    device = parser.parse_args().device
    with tempfile.TemporaryDirectory() as folder:
        exact = draw("cpu", "double", Path(folder))
        force = exact.history["punch.force"]
        print(f"draw-in {measure_draw_in(exact):.6f} mm, thinnest {exact.field('thickness').min():.6f} mm, "
              f"force {force.max():.1f} N")  # fmt: skip
        for on, precision in (("cpu", "single"), (device, "double"), (device, "single")):
            found = draw(on, precision, Path(folder))
            errors = (
                abs(measure_draw_in(found) - measure_draw_in(exact)),
                np.abs(found.field("thickness") - exact.field("thickness")).max(),
                np.abs(found.history["punch.force"] - force).max(),
            )
            print("| {} | {} | {:.1e} | {:.1e} | {:.1e} |".format(on, precision, *errors), flush=True)


if __name__ == "__main__":
    main()
