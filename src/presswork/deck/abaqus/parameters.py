# SPDX-License-Identifier: Apache-2.0
"""Parameters of keywords of Abaqus: which are read, and which are refused; all others are listed as left out."""

from __future__ import annotations

from presswork.deck.notes import Notes
from presswork.mesh.files.abaqus_blocks import Block

_SECTION = "ELSET MATERIAL ORIENTATION OFFSET COMPOSITE"
_READ = {
    "HEADING": "",
    "NODE": "NSET SYSTEM INPUT",
    "ELEMENT": "TYPE ELSET INPUT",
    "NSET": "NSET GENERATE INSTANCE INTERNAL UNSORTED INPUT",
    "ELSET": "ELSET GENERATE INSTANCE INTERNAL UNSORTED INPUT",
    "SURFACE": "TYPE NAME INTERNAL FILLET_RADIUS",
    "PART": "NAME",
    "INSTANCE": "NAME PART",
    "END PART": "",
    "END INSTANCE": "",
    "END ASSEMBLY": "",
    "END STEP": "",
    "ASSEMBLY": "NAME",
    "SYSTEM": "",
    "SHELL SECTION": _SECTION,
    "SHELL GENERAL SECTION": _SECTION,
    "ORIENTATION": "NAME SYSTEM DEFINITION",
    "RIGID BODY": "REF_NODE ELSET ANALYTICAL_SURFACE",
    "MATERIAL": "NAME",
    "DENSITY": "",
    "ELASTIC": "TYPE",
    "PLASTIC": "HARDENING RATE",
    "POTENTIAL": "",
    "RATE DEPENDENT": "TYPE",
    "STEP": "NAME PERTURBATION AMPLITUDE NLGEOM",
    "STATIC": "",
    "DYNAMIC": "EXPLICIT",
    "AMPLITUDE": "NAME DEFINITION TIME VALUE INPUT",
    "BOUNDARY": "TYPE AMPLITUDE OP",
    "CLOAD": "AMPLITUDE OP FOLLOWER",
    "SURFACE INTERACTION": "NAME",
    "FRICTION": "ROUGH USER EXPONENTIAL_DECAY TAUMAX ANISOTROPIC DEPENDENCIES TEST_DATA",
    "SURFACE BEHAVIOR": "",
    "CONTACT PAIR": "INTERACTION TIED TYPE NO_THICKNESS",
    "CONTACT": "",
    "CONTACT INCLUSIONS": "ALL_EXTERIOR",
    "CONTACT PROPERTY ASSIGNMENT": "",
}
_REFUSED = {
    "NSET": "ELSET",
    "INSTANCE": "LIBRARY INSTANCE",
    "SHELL SECTION": "NODAL_THICKNESS SHELL_THICKNESS THICKNESS_MODULUS",
    "SHELL GENERAL SECTION": "NODAL_THICKNESS SHELL_THICKNESS USER ZERO",
    "RIGID BODY": "PIN_NSET TIE_NSET NODAL_THICKNESS",
    "ELASTIC": "MODULI DEPENDENCIES",
    "PLASTIC": "DEPENDENCIES DATA_TYPE SCALESTRESS",
    "POTENTIAL": "DEPENDENCIES",
    "DENSITY": "DEPENDENCIES",
    "DYNAMIC": "ADIABATIC",
    "STATIC": "ADIABATIC RIKS",
    "BOUNDARY": "USER SUBMODEL FIXED FILE REGION_TYPE",
    "CLOAD": "USER FILE CYCLIC_MODE",
    "SURFACE INTERACTION": "USER",
    "SURFACE BEHAVIOR": "NO_SEPARATION",
    "CONTACT": "OP",
    "CONTACT PAIR": "OP",
}
"""What changes a case, and has no counterpart."""


_WITHOUT_ROWS = (
    "PART",
    "END PART",
    "END INSTANCE",
    "ASSEMBLY",
    "END ASSEMBLY",
    "RIGID BODY",
    "MATERIAL",
    "CONTACT",
    "END STEP",
)
"""Keywords whose rows of data, such as the thickness of rigid elements, are not read."""


def check_parameters(block: Block, notes: Notes) -> None:
    """Note parameters of a keyword that are not read: left out, or refused. A keyword without a row here is skipped."""
    if block.name not in _READ:
        return
    read = {each.replace("_", " ") for each in _READ[block.name].split()}
    refused = {each.replace("_", " ") for each in _REFUSED.get(block.name, "").split()}
    keyword = f"*{block.name}"
    if block.name in _WITHOUT_ROWS:
        leave_columns(block, 0, "a row below it", notes)
    for name, value in block.parameters.items():
        text = f"{name} = {value}" if value else name
        if name in refused:
            notes.refuse(block.place, keyword, f"{text} has no counterpart here")
        elif name not in read:
            notes.leave(block.place, keyword, text)


def leave_columns(block: Block, taken: int, what: str, notes: Notes) -> None:
    """Note fields of rows that are not read: those after the first `taken` ones, and what they are."""
    for row in block.rows():
        more = [word for word in row[taken:] if word]
        if more:
            notes.leave(block.place, f"*{block.name}", f"{what}: {', '.join(more)}")
