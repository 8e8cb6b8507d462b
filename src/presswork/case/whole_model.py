# SPDX-License-Identifier: Apache-2.0
"""What is asked of a whole Model, of whatever kind its case is: do tools form it, and do sizes and temperatures fit."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from presswork.case.errors import CaseError
from presswork.case.gravity import check_gravity
from presswork.case.heat_transfer import warn_of_heat_transfer
from presswork.case.rates import warn_of_rates
from presswork.case.resistance import check_resistance
from presswork.case.temperatures import warn_of_temperatures
from presswork.case.tool_sizes import warn_of_sheet
from presswork.case.tools.cavity import check_cavity
from presswork.model import Model

if TYPE_CHECKING:
    from presswork.case.case_file import CaseFile

logger = logging.getLogger(__name__)


def check_whole_model(case: CaseFile, model: Model) -> None:
    """Warn of what looks like a slip. Raises CaseError where nothing can be formed, or tools go through each other.

    limits.stop = false turns these errors into warnings.
    """
    of_sheet = warn_of_sheet(case, model) if model.analysis == "stamping" else ()
    for warning in (*of_sheet, *warn_of_temperatures(model), *warn_of_rates(model), *warn_of_heat_transfer(model)):
        logger.warning("%s", warning)
    impossible = check_gravity(case, model)
    if impossible:
        raise CaseError(impossible, case.source)
    problems = check_resistance(model) or check_cavity(model)
    if problems and model.limits.stop:
        raise CaseError(problems, case.source)
    for problem in problems:
        logger.warning("%s: %s", problem.key, problem.expected)
