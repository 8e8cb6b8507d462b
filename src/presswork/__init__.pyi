# SPDX-License-Identifier: Apache-2.0
from .api import check, run
from .case import Case, CaseError, OneStepCase, ShellCase, StampingCase, build_model, read_case
from .law.allowed import allow_library
from .recorder import Outcome, run_model
from .results import OutputError, Result

__version__: str

__all__ = [
    "Case",
    "CaseError",
    "OneStepCase",
    "Outcome",
    "OutputError",
    "Result",
    "ShellCase",
    "StampingCase",
    "allow_library",
    "build_model",
    "check",
    "read_case",
    "run",
    "run_model",
]
