# SPDX-License-Identifier: Apache-2.0
"""The case: schema, units, reading of case files, and the way from a case to the Model."""

from presswork.case.describe import describe
from presswork.case.errors import CaseError, Problem
from presswork.case.kinds import build_model, json_schema, read_case
from presswork.case.material.hardening import (
    HockettSherby,
    Linear,
    LinearVoce,
    Ludwik,
    MonotoneTable,
    Swift,
    SwiftVoce,
    Table,
    Voce,
)
from presswork.case.onestep.schema import OneStepCase
from presswork.case.settings import Output, Solver, Terms
from presswork.case.shell.material import ShellMaterial
from presswork.case.shell.schema import (
    BodyForce,
    EdgeForce,
    Section,
    ShellBoundary,
    ShellCase,
    ShellDisplacement,
    ShellForce,
    ShellPressure,
    ShellRectangle,
    ShellRotation,
    ShellStage,
    ShellWorkpiece,
)
from presswork.case.solid.contact import Contact
from presswork.case.solid.schema import (
    Boundary,
    Case,
    Displacement,
    Material,
    NodeForce,
    Pressure,
    ProfilePoint,
    Stage,
    Tool,
    ToolMotion,
)
from presswork.case.solid.workpiece import MeshFile, Rectangle, Workpiece, Zone
from presswork.case.stamping.schema import StampingCase

__all__ = [
    "BodyForce",
    "Boundary",
    "Case",
    "CaseError",
    "Contact",
    "Displacement",
    "EdgeForce",
    "HockettSherby",
    "Linear",
    "LinearVoce",
    "Ludwik",
    "Material",
    "MeshFile",
    "MonotoneTable",
    "NodeForce",
    "OneStepCase",
    "Output",
    "Pressure",
    "Problem",
    "ProfilePoint",
    "Rectangle",
    "Section",
    "ShellBoundary",
    "ShellCase",
    "ShellDisplacement",
    "ShellForce",
    "ShellMaterial",
    "ShellPressure",
    "ShellRectangle",
    "ShellRotation",
    "ShellStage",
    "ShellWorkpiece",
    "Solver",
    "Stage",
    "StampingCase",
    "Swift",
    "SwiftVoce",
    "Table",
    "Terms",
    "Tool",
    "ToolMotion",
    "Voce",
    "Workpiece",
    "Zone",
    "build_model",
    "describe",
    "json_schema",
    "read_case",
]
