# SPDX-License-Identifier: Apache-2.0
"""The Model: everything that is known before the first increment, as frozen data without behaviour.

Units are mm, s, t, N, MPa throughout. The model plane is (x, y); in axisymmetry x is the radius and y the axis. A shell
lies in (x, y, z), and its nodes turn about x, y, z too.
Directions and boundaries have names, never integer tags. All names are imported from here.
"""

from presswork.model.arrays import BoolArray, FloatArray, IndexArray, IntArray, MaskArray
from presswork.model.contact import Body, BodyContact
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
from presswork.model.onestep import OneStepModel, PartBead
from presswork.model.settings import (
    Displacements,
    ExplicitSheet,
    ExplicitSolid,
    FrictionTangent,
    Integrator,
    OutputSettings,
    SolverSettings,
    StrainMeasure,
    TangentTerms,
)
from presswork.model.sheet import Refinement, Springback, TrimLine
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
from presswork.model.tool import (
    ContactLaw,
    Drawbead,
    Friction,
    Profile,
    Spring,
    Surface,
    SweptProfile,
    Tool,
    ToolKind,
    Triangulation,
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
    "Drawbead",
    "EdgeForce",
    "ElementName",
    "ExplicitElement",
    "ExplicitSheet",
    "ExplicitSolid",
    "FaceForce",
    "FacePressure",
    "FloatArray",
    "Friction",
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
    "OneStepModel",
    "OutputSettings",
    "PartBead",
    "PointForce",
    "PrescribedDisplacement",
    "Pressure",
    "Profile",
    "Push",
    "Rate",
    "Refinement",
    "Section",
    "ShellElement",
    "ShellPressure",
    "SolidElement",
    "SolverSettings",
    "SpaceElement",
    "Spring",
    "Springback",
    "Stage",
    "StrainMeasure",
    "Support",
    "Surface",
    "SweptProfile",
    "TangentTerms",
    "ThicknessRule",
    "Tool",
    "ToolKind",
    "ToolMotion",
    "Triangulation",
    "TrimLine",
    "Umat",
    "UmatJacobian",
    "YieldFunction",
    "list_names",
]
