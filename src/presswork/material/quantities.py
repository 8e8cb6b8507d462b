# SPDX-License-Identifier: Apache-2.0
"""What the names and units of a test machine's columns mean, in English, German, French, Italian and Spanish."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

UNITS: dict[str, tuple[str, float]] = {
    "n": ("force", 1.0), "dan": ("force", 10.0), "kn": ("force", 1e3), "mn": ("force", 1e6),
    "kgf": ("force", 9.80665), "kp": ("force", 9.80665), "lbf": ("force", 4.4482216152605),
    "mpa": ("stress", 1.0), "n/mm2": ("stress", 1.0), "kn/mm2": ("stress", 1e3), "gpa": ("stress", 1e3),
    "pa": ("stress", 1e-6), "psi": ("stress", 6.894757293168e-3), "ksi": ("stress", 6.894757293168),
    "bar": ("stress", 0.1),
    "mm": ("length", 1.0), "cm": ("length", 10.0), "m": ("length", 1e3), "um": ("length", 1e-3),
    "in": ("length", 25.4), "inch": ("length", 25.4), '"': ("length", 25.4),
    "%": ("strain", 0.01), "mm/mm": ("strain", 1.0), "m/m": ("strain", 1.0), "in/in": ("strain", 1.0),
    "-": ("strain", 1.0), "1": ("strain", 1.0), "%o": ("strain", 1e-3), "um/m": ("strain", 1e-6),
    "mm2": ("area", 1.0), "cm2": ("area", 100.0), "in2": ("area", 645.16),
    "s": ("time", 1.0), "sec": ("time", 1.0), "min": ("time", 60.0), "h": ("time", 3600.0), "ms": ("time", 1e-3),
    "mm/min": ("speed", 1.0), "mm/s": ("speed", 60.0), "1/s": ("rate", 1.0), "s-1": ("rate", 1.0),
    "deg": ("angle", 1.0), "degc": ("temperature", 1.0), "c": ("temperature", 1.0),
}  # fmt: skip
"""Dimension and factor to N, MPa, mm, mm^2, fractions, by unit."""
ENDINGS = {"percent": "%", "prozent": "%", "pct": "%", "mm": "mm", "kn": "kn", "mpa": "mpa", "n": "n", "um": "um"}
"""Last words of a name that are a unit."""
_WIDTH = r"width|breite|transvers|quer|lateral|largeur|larghezza|anchura|ancho|trasvers"
_STRAIN = r"strain|dehnung|elongation|deformation|deformazione|deformacion|allong|allungamento|alargamiento|epsilon"
_STRESS = r"stress|spannung|contrainte|tensione|esfuerzo|tension mpa|sigma|festigkeit"
_FORCE = r"force|kraft|load|last\b|charge|effort|forza|fuerza|carga|^f$"
_EXTENSOMETER = r"extensomet|dehnungsaufnehmer|langenanderung|feinweg|feindehn|gauge length change|^delta l|^dl$|^l l0"
_PATH = (
    r"crosshead|travers|displacement|extension|\bweg\b|standardweg|maschinenweg|travel|position|stroke|deplacement|"
    r"spostamento|desplazamiento|verschiebung|grip separation|verlangerung|course|hub\b"
)
_NOT = r"time|zeit|temps|tempo|tiempo|speed|geschwindig|vitesse|modul|energy|energie|arbeit|work|index|count"
COLUMNS = (
    ("", _NOT),
    ("angle", r"^angle|^winkel|^direction|^richtung|^orientation|^rolling direction|^lage\b"),
    ("specimen", r"^specimen$|^probe$|^sample$|^test$|^versuch$|^eprouvette$|specimen (no|number|id|name)|"
                 r"^proben?(nummer| nr)|^test (no|number)|^provino$|^probeta$"),
    ("width", _WIDTH),
    ("extensometer", _EXTENSOMETER),
    ("stress", _STRESS),
    ("force", _FORCE),
    ("strain", _STRAIN),
    ("path", _PATH),
)  # fmt: skip
"""Quantity of a column by the first pattern that is found in its name."""
_BY_UNIT = {"force": "force", "stress": "stress", "length": "path", "strain": "strain"}
FACTS = (
    ("thickness", r"^a ?0$|^a$|^t ?0$|^t$|^h ?0$|thickness|dicke|epaisseur|spessore|espesor"),
    ("width", r"^b ?0$|^b$|^w ?0$|^w$|^(specimen |initial |proben?)?(width|breite)\b|largeur|larghezza|ancho|anchura"),
    ("diameter", r"^d ?0$|diameter|durchmesser|diametre|diametro"),
    ("gauge_length", r"^l ?0$|^le$|^l ?e$|gauge length|gage length|messlange|longueur|lunghezza|longitud"),
    ("area", r"^s ?0$|^a ?0 mm2$|cross section|querschnitt|area|section initiale|seccion"),
    ("angle", r"^angle|^winkel|direction|richtung|orientation|^probe$|^specimen$|^sample$|^lage$|^probenlage"),
)
"""Facts of the specimen that a line of the head may hold."""
DIRECTIONS = {"rd": 0.0, "dd": 45.0, "td": 90.0, "langs": 0.0, "quer": 90.0, "diagonal": 45.0, "longitudinal": 0.0,
              "transverse": 90.0, "l": 0.0, "t": 90.0, "d": 45.0}  # fmt: skip


@dataclass(frozen=True)
class Quantity:
    """What a column holds."""

    title: str
    """Title as the file writes it."""
    kind: str
    """One of COLUMNS; empty for what a fit does not need."""
    unit: str
    """Unit as in UNITS; empty where the file has none."""
    true: bool | None
    """Whether the name means true or engineering values; None: it is open."""

    @property
    def dimension(self) -> str:
        """What the unit measures; empty without a unit."""
        return UNITS[self.unit][0] if self.unit else ""

    @property
    def factor(self) -> float:
        """Factor to N, MPa, mm and fractions."""
        return UNITS[self.unit][1] if self.unit else 1.0


def plain(text: str) -> str:
    """Return a name in small letters without accents, its words apart by single spaces."""
    text = text.replace("\u0394", "delta ").replace("\u03b5", "epsilon").replace("\u03c3", "sigma").replace("ß", "ss")
    bare = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c)).lower()
    return re.sub(r"[^a-z0-9]+", " ", bare).strip()


def find_unit(text: str) -> str | None:
    """Return the key of UNITS that a text is, without brackets; None for what is no unit."""
    bare = re.sub(r"^[\[(<{]|[\])>}]$", "", text.strip()).strip()
    bare = bare.replace("\u00b5", "u").replace("\u03bc", "u").replace("\u2030", "%o").replace("\u00b2", "2")
    bare = bare.replace("^", "").replace(" ", "").replace("\u00b0", "deg").replace("degrees", "deg").replace("²", "2")
    if bare in ("MN", "Mn"):
        return "mn"
    return bare.lower() if bare.lower() in UNITS else None


def read_column(title: str, unit_below: str = "") -> Quantity:
    """Return the quantity and unit that a column's name and the cell below it name.

    The unit may stand in brackets, after a slash or "in", or as the name's last word.
    """
    name, unit = title, find_unit(unit_below) if unit_below.strip() else None
    bracket = re.search(r"[\[(<{]([^\])>}]*)[\])>}]\s*$", title) or re.search(r"\s(?:in|/)\s*(\S+)\s*$", title)
    if bracket and find_unit(bracket[1]):
        name, unit = title[: bracket.start()], unit or find_unit(bracket[1])
    words = plain(name).split()
    if unit is None and len(words) > 1 and words[-1] in ENDINGS:
        unit, words = ENDINGS[words[-1]], words[:-1]
    elif unit is None and "%" in name:
        unit = "%"
    bare = " ".join(words)
    kind = next((kind for kind, pattern in COLUMNS if re.search(pattern, bare)), None)
    dimension = UNITS[unit][0] if unit else ""
    if kind is None or (kind not in ("", "width", "angle", "specimen") and not _goes(kind, dimension)):
        kind = _BY_UNIT.get(dimension, "") if kind != "" else ""
    true = True if re.search(r"true|wahr|vrai|\blog|hencky|vera\b", bare) else None
    true = False if re.search(r"engineering|techn|nominal|conventionn?el|\beng\b", bare) else true
    return Quantity(title, kind, unit or "", true)


def read_title(title: str, unit_below: str = "") -> tuple[str, float]:
    """Return a column's name without its unit in brackets, and the unit's factor to MPa, mm and fractions."""
    bracket = re.search(r"\s*[\[(]([^\])]*)[\])]\s*$", title)
    unit = find_unit(bracket[1] if bracket else unit_below)
    return (title[: bracket.start()] if bracket else title).strip(), UNITS[unit][1] if unit else 1.0


def _goes(kind: str, dimension: str) -> bool:
    """Return whether a kind of column can have a dimension."""
    allowed = {"force": ("force",), "stress": ("stress",), "path": ("length",), "strain": ("strain",),
               "extensometer": ("length", "strain")}  # fmt: skip
    return not dimension or dimension in allowed[kind]
