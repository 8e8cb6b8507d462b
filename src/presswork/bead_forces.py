# SPDX-License-Identifier: Apache-2.0
"""Forces of drawbeads from their geometry, by pulling a strip through each; kept in a file beside the case."""

from __future__ import annotations

import json
import logging
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.case import CaseError, build_model
from presswork.case.errors import Problem
from presswork.fingerprint import fingerprint
from presswork.recorder import StartError, run_model
from presswork.results import OutputError, Result
from presswork.results.whole_file import write_whole

if TYPE_CHECKING:
    from presswork.case.any_case import AnyCase
    from presswork.case.stamping.schema import StampingCase

logger = logging.getLogger(__name__)

STEADY = 0.6, 0.95
"""Share of the pulled distance over which the forces are averaged: by then all the metal has passed every radius."""


def find_bead_forces(case: AnyCase, *, may_compute: bool = True) -> AnyCase:
    """Return a stamping whose drawbeads have the forces that follow from their geometry; any other case unchanged.

    Forces that the file beside the case has for the same strip are taken from it; the others are computed and written
    there. may_compute: without it beads whose forces are not there stay as they are. Raises CaseError for a strip that
    cannot be pulled through its bead.
    """
    if getattr(case, "analysis", None) != "stamping":  # what is no case is told by build_model
        return case
    from presswork.case.stamping.bead_strip import list_geometries, make_strip, put_forces, read_forces
    from presswork.case.stamping.schema import StampingCase

    assert isinstance(case, StampingCase)
    given = list_geometries(case)
    if not given:
        return case
    kept, found = read_forces(case), {}
    for key, geometry in given:
        try:
            model = build_model(make_strip(case, geometry))
        except CaseError as error:
            wording = "; ".join(str(problem) for problem in error.problems)
            text = f"the strip that is pulled through the bead cannot be computed: {wording}"
            raise CaseError([Problem(key, text, "change the geometry, or give force instead")], case.source) from None
        name = fingerprint(model)
        if name not in kept and not may_compute:
            continue
        if name not in kept:
            logger.info("%s: a strip is pulled through the bead", key)
            with tempfile.TemporaryDirectory() as folder:
                try:
                    outcome = run_model(model, folder, threads=1)
                except StartError as error:
                    raise CaseError([Problem(key, str(error), "change the geometry")], case.source) from None
                if outcome.status == "interrupted":
                    raise KeyboardInterrupt
                if outcome.status != "completed":
                    text = f"the strip cannot be pulled through the bead: {outcome.reason}"
                    raise CaseError([Problem(key, text, "change the geometry, or give force instead")], case.source)
                force, closing = measure_strip(Path(folder))
            row = {"force": force, "closing_force": closing, "thickness": case.blank.thickness}
            kept[name] = row | {"material": case.blank.material, **geometry.model_dump()}
            _keep(case, kept)
        found[key] = float(kept[name]["force"]), float(kept[name]["closing_force"])
    return put_forces(case, found)


def measure_strip(folder: Path) -> tuple[float, float]:
    """Return restraining and closing force per length of a strip that was pulled through a bead [N/mm].

    Half of its 2 mm is modelled: `right.force_x` is of 1 mm, the tools' forces are of the whole.
    """
    history = Result(folder).history
    pull = history["stage"] == "pull"
    time = history["time"][pull]
    part = (time - time[0]) / (time[-1] - time[0])
    steady = (part >= STEADY[0]) & (part <= STEADY[1])
    closing = history["punch.force"] + history["holder.force"]
    return float(np.mean(history["right.force_x"][pull][steady])), 0.5 * float(np.mean(closing[pull][steady]))


def _keep(case: StampingCase, kept: dict[str, dict[str, object]]) -> None:
    """Write the file beside the case, if that can be written: the forces can be found again."""
    from presswork.case.stamping.bead_strip import find_file

    path: Path | None = find_file(case)
    if path is None:
        return
    content = (json.dumps(kept, indent=1) + "\n").encode()
    with suppress(OutputError):
        write_whole(path, content)
