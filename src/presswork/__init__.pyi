# SPDX-License-Identifier: Apache-2.0
from .api import run
from .case import Case, CaseError, ShellCase, StampingCase, build_model
from .recorder import Outcome, run_model
from .results import OutputError, Result

__version__: str

__all__ = [
    "Case",
    "CaseError",
    "Outcome",
    "OutputError",
    "Result",
    "ShellCase",
    "StampingCase",
    "build_model",
    "run",
    "run_model",
]
