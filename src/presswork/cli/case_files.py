# SPDX-License-Identifier: Apache-2.0
"""From a case file to its model, or to a message that says what is wrong."""

from __future__ import annotations

from pathlib import Path

from presswork.case import build_model, read_case
from presswork.case.errors import CaseError
from presswork.case.material.umat import list_libraries
from presswork.cli.terminal import refuse
from presswork.law.allowed import is_allowed
from presswork.model import Model, OneStepModel


def load_model(
    case_file: Path, settings: list[str] | None, folder: Path | None = None, *, only_described: bool = False
) -> Model | OneStepModel:
    """Build the model of a case file. folder: for a picture of what is refused, if that can be drawn.

    only_described: leave libraries that may not run unopened, instead of refusing the case.
    """
    try:
        case = read_case(case_file, overrides=settings or [])
        if case.analysis == "onestep":
            from presswork.case.onestep.schema import OneStepCase, build_onestep_model

            assert isinstance(case, OneStepCase)
            return build_onestep_model(case)
        libraries = list_libraries(case)
        run_user_code = not only_described or (bool(libraries) and all(map(is_allowed, libraries)))
        if case.analysis == "stamping":
            from presswork.bead_forces import find_bead_forces

            case = find_bead_forces(case, may_compute=run_user_code)
        return build_model(case, run_user_code=run_user_code)
    except CaseError as error:
        raise refuse(f"{error}{picture_undercut(error, folder)}") from error


def picture_undercut(error: CaseError, folder: Path | None) -> str:
    """Draw the part that is refused for its undercut; return where, as the end of the message."""
    cause = error.__cause__
    if folder is None or cause is None:
        return ""
    from presswork.mesh.part_file import UndercutError

    if not isinstance(cause, UndercutError):
        return ""
    from presswork.results import OutputError
    from presswork.view.part_plot import draw_undercut

    path = folder / "undercut.png"
    try:
        folder.mkdir(exist_ok=True)
        draw_undercut(cause.points, cause.triangles, cause.over, path)
    except (ImportError, OSError, OutputError) as failure:
        return f"; no picture: {failure}"
    return f"; {path} shows where"
