# SPDX-License-Identifier: Apache-2.0
from .outline import BlankOutline, nest
from .solve import OneStepResult, solve_one_step

__all__ = ["BlankOutline", "OneStepResult", "nest", "solve_one_step"]
