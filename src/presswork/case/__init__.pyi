# SPDX-License-Identifier: Apache-2.0
from .any_case import build_model, json_schema, read_case
from .description import describe
from .errors import CaseError, Problem
from .material.hardening import (
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
from .onestep.schema import OneStepCase
from .plane.contact import Contact
from .plane.schema import (
    Boundary,
    Case,
    Displacement,
    Material,
    NodeForce,
    Pressure,
    Stage,
    ToolMotion,
)
from .plane.tool import ProfilePoint, Tool
from .plane.workpiece import MeshFile, Rectangle, Workpiece, Zone
from .settings import Output, Solver, Terms
from .shell.material import ShellMaterial
from .shell.schema import (
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
from .stamping.schema import StampingCase

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
