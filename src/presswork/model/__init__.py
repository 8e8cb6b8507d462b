# SPDX-License-Identifier: Apache-2.0
"""The Model: everything that is known before the first increment, as frozen data without behaviour.

Units are mm, s, t, N, MPa throughout. The model plane is (x, y); in axisymmetry x is the radius and y the axis. A shell
lies in (x, y, z), and its nodes turn about x, y, z too.
Directions and boundaries have names, never integer tags. All names are imported from here.
"""

from presswork.model.arrays import BoolArray, FloatArray, IndexArray, IntArray, MaskArray
from presswork.model.contact import Body, BodyContact, ContactLaw, SheetBead, SheetTool, Spring, Tool
from presswork.model.elements import (
    ELEMENTS,
    ElementName,
    ExplicitElement,
    ShellElement,
    SolidElement,
    SpaceElement,
    list_names,
)
from presswork.model.limits import Limits
from presswork.model.material import (
    Hardening,
    HardeningLaw,
    Heating,
    Kinematic,
    Material,
    Rate,
    Umat,
    UmatJacobian,
    YieldFunction,
)
from presswork.model.mesh import CellBlock, Mesh, Section, ThicknessRule
from presswork.model.model import Analysis, Model
from presswork.model.settings import (
    Displacements,
    ExplicitSolid,
    FrictionTangent,
    Integrator,
    OutputSettings,
    SolverSettings,
    StrainMeasure,
    TangentTerms,
)
from presswork.model.stage import (
    BodyForce,
    EdgeForce,
    FaceForce,
    FacePressure,
    PointForce,
    PrescribedDisplacement,
    Pressure,
    Push,
    ShellPressure,
    Stage,
    Support,
    ToolMotion,
)

__all__ = [
    "ELEMENTS",
    "Analysis",
    "Body",
    "BodyContact",
    "BodyForce",
    "BoolArray",
    "CellBlock",
    "ContactLaw",
    "Displacements",
    "EdgeForce",
    "ElementName",
    "ExplicitElement",
    "ExplicitSolid",
    "FaceForce",
    "FacePressure",
    "FloatArray",
    "FrictionTangent",
    "Hardening",
    "HardeningLaw",
    "Heating",
    "IndexArray",
    "IntArray",
    "Integrator",
    "Kinematic",
    "Limits",
    "MaskArray",
    "Material",
    "Mesh",
    "Model",
    "OutputSettings",
    "PointForce",
    "PrescribedDisplacement",
    "Pressure",
    "Push",
    "Rate",
    "Section",
    "SheetBead",
    "SheetTool",
    "ShellElement",
    "ShellPressure",
    "SolidElement",
    "SolverSettings",
    "SpaceElement",
    "Spring",
    "Stage",
    "StrainMeasure",
    "Support",
    "TangentTerms",
    "ThicknessRule",
    "Tool",
    "ToolMotion",
    "Umat",
    "UmatJacobian",
    "YieldFunction",
    "list_names",
]
