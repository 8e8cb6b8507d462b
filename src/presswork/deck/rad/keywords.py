# SPDX-License-Identifier: Apache-2.0
"""Keywords of OpenRadioss that carry nothing of a case, and what becomes of others of which nothing else is noted."""

from presswork.deck.notes import Fate

STARTER = frozenset(
    {
        "ACCEL",
        "AMS",
        "ANALY",
        "ARCH",
        "CHECK",
        "DAMP",
        "DEFAULT",
        "DEF_SHELL",
        "DEF_SOLID",
        "DT",
        "FRAME",
        "GRBEAM",
        "GRNOD",
        "GRSH3N",
        "GRSHEL",
        "GRSPRI",
        "IOFLAG",
        "KEY",
        "MEMORY",
        "PRINT",
        "RANDOM",
        "SECT",
        "SENSOR",
        "SHFRA",
        "SKEW",
        "SPMD",
        "STAMPING",
        "SUBSET",
        "SURF",
        "TABLE",
        "TH",
        "VERS",
    }
)
"""What controls numerics and output, and groups and frames, which matter only where they are named."""
ENGINE = frozenset(
    {
        "ABF",
        "ANIM",
        "CHECK",
        "DEBUG",
        "DT",
        "DTIX",
        "DTSDE",
        "FXINP",
        "H3D",
        "IMPL",
        "INCMP",
        "MON",
        "NEGVOL",
        "OUTP",
        "PARITH",
        "PROC",
        "PRINT",
        "RFILE",
        "SHVER",
        "STATE",
        "STOP",
        "TFILE",
        "TH",
        "THERM",
        "TITLE",
        "VERS",
    }
)
"""What controls numerics and output."""
SEEN: dict[str, tuple[Fate, str]] = {
    "UNIT": ("kept", "units, for keywords that name them"),
    "TITLE": ("kept", "the case's title"),
    "PART": ("dropped", "has no shells, or moves with a part that is a tool"),
    "PROP": ("dropped", "of rigid parts, whose thickness does not count, or of none"),
    "MAT": ("dropped", "of rigid parts, or of none"),
    "FUNCT": ("dropped", "nothing that is imported refers to it"),
    "ADMESH": ("dropped", "shells are split as in /ADMESH/GLOBAL"),
    "RBODY": ("kept", "makes its parts rigid"),
    "IMPVEL": ("dropped", "moves no tool that is imported"),
    "IMPACC": ("dropped", "moves no tool that is imported"),
    "IMPDISP": ("dropped", "moves no tool that is imported"),
    "CLOAD": ("dropped", "pushes no tool that is imported"),
    "BCS": ("dropped", "holds nothing"),
    "INTER": ("dropped", "adds no tool: it joins none with the sheet, or one that has a contact above"),
}
"""What becomes of a block of which nothing else is noted."""
