# SPDX-License-Identifier: Apache-2.0
"""From the finished part back to its blank: the run, its files and pictures, and the command line."""

from presswork.onestep.outline import BlankOutline, nest
from presswork.onestep.solve import OneStepResult, solve_one_step

__all__ = ["BlankOutline", "OneStepResult", "nest", "solve_one_step"]
