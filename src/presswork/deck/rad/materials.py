# SPDX-License-Identifier: Apache-2.0
"""Laws of sheets of OpenRadioss: 2 (Johnson and Cook), 32 and 43 (Hill), 36 (tables), 57 (Barlat and Lian)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from presswork.deck.contents import Hardening, MaterialCard
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_row
from presswork.deck.rad.cards import leave_fields, leave_rows

_NAMES = {
    "PLAS_JOHNS": "LAW2",
    "PLAS": "LAW2",
    "HILL": "LAW32",
    "PLAS_TAB": "LAW36",
    "HILL_TAB": "LAW43",
    "BARLAT3": "LAW57",
}
_WIDE = (20,) * 5
_WITH_YOUNG = 120
"""The version from which laws 36, 43 and 57 have a row of Young's modulus that falls."""
_WITH_DIRECTION = 140
"""The version from which laws 32 and 43 state the direction that the yield stress belongs to."""


def read_material(block: Block, version: int, notes: Notes) -> MaterialCard | None:
    """Return the material of a sheet; None where it has no counterpart, which is noted. Raises FieldError, IndexError.

    version: of the deck, which determines the rows of a law.
    """
    name = block.words[1] if len(block.words) > 1 else ""
    read = _LAWS.get(_NAMES.get(name, name))
    if read is None:
        known = ", ".join(sorted(f"{number} ({each})" for each, number in _NAMES.items()))
        notes.refuse(block.place, block.keyword, "no such law of sheets here", f"take one of {known}")
        return None
    rows = block.titled()[1]
    if len(rows) < 3:
        raise IndexError
    rows += [b""] * (8 - len(rows))
    density = read_row(rows[0], 20)[0]
    young, poisson = read_row(rows[1], 20, 20)
    card = MaterialCard(block.keyword, density, young, poisson, block.place)
    leave_fields(block, rows[0], "rho:20 -rho0:20", notes)
    layouts = _list_layouts(_NAMES.get(name, name), version)
    for row, layout in zip(rows[1:], layouts, strict=False):
        leave_fields(block, row, layout, notes)
    if layouts[-1].startswith("fct_ID1 -"):  # as many rows of curves as there are, of which one is read
        layouts += [""] * len(rows)
    leave_rows(block, rows[1 + len(layouts) :], "further rows", notes)
    return read(card, rows[1:], version, notes)


def _list_layouts(law: str, version: int) -> list[str]:
    """Return the fields of the rows of a law from that of Young's modulus on; those that are not read have a dash."""
    young = "fct_IDE - Einf:20 CE:20"
    failure = "EPSP_max:20 -EPS_t:20 -EPS_m:20"
    ratios = "r00:20 r45:20 r90:20 C_hard:20"
    match law:
        case "LAW2":
            rate = "c:20 rate:20 -ICC -Fsmooth -Fcut:20 C_hard:20"
            heat = "m:20 T_melt:20 -rhoCp:20 -T_r:20"
            return ["E:20 nu:20 Iflag", "a:20 b:20 n:20 EPSP_max:20 SIG_max:20", rate, heat]
        case "LAW32":
            last = "Iyield0" if version >= _WITH_DIRECTION else "-Iyield0"
            hill = f"r00:20 r45:20 r90:20 -:20 {last}"
            return ["E:20 nu:20", "a:20 e0:20 n:20 EPSP_max:20 SIG_max:20", "-eps0:20 m:20", hill]
        case "LAW36":
            falls = "fct_IDE Einf:20 CE:20" if version >= _WITH_YOUNG else "-fct_IDE -Einf:20 -CE:20"
            head = ["E:20 nu:20 EPSP_max:20 -EPS_t:20 -EPS_m:20", "N -Fsmooth C_hard:20 -Fcut:20 -EPS_f:20"]
            return [*head, f"fct_IDp -Fscale:20 {falls}", "fct_ID1", "Fscale1:20", "-rate1:20"]
    head = ["E:20 nu:20", *([young] if version >= _WITH_YOUNG else [])]
    last = "Iyield0" if version >= _WITH_DIRECTION else "-Iyield0"
    both = f"{ratios} {last}" if law == "LAW43" else f"{ratios} m:20"
    return [*head, both, failure, "fct_ID1 - Fscale1:20 -rate1:20"]


def _johnson_cook(card: MaterialCard, rows: list[bytes], version: int, notes: Notes) -> MaterialCard:
    """(a + b e^n) (1 + c ln(rate / rate0)); the first row is that of Young's modulus."""
    if read_row(rows[0], 20, 20, 10)[2]:
        notes.refuse(card.place, card.keyword, "the tensile strength (Iflag = 1)", "give a, b and n, with Iflag = 0")
    a, b, n, fails, largest = read_row(rows[1], *_WIDE)
    c, rate, _, _, _, kinematic = read_row(rows[2], 20, 20, 10, 10, 20, 20)
    m, melting, *_ = read_row(rows[3], 20, 20)
    if kinematic:
        notes.refuse(card.place, card.keyword, f"kinematic hardening (C_hard = {kinematic:g})")
    if m and melting:
        notes.change(card.place, card.keyword, f"the metal stays cold: m = {m:g} and T_melt = {melting:g} are left out")
    if 0.0 < largest < 1e20:
        notes.refuse(card.place, card.keyword, f"a largest stress (SIG_max0 = {largest:g})", "give the curve by LAW36")
    _note_failure(card, fails, notes)
    n = n or 1.0
    if b and n == 1.0:
        hardening = Hardening("linear", {"yield_stress": a, "modulus": b})
    elif b:
        hardening = Hardening("ludwik", {"yield_stress": a, "K": b, "n": n})
    else:
        hardening = Hardening("linear", {"yield_stress": a})
    return replace(card, hardening=hardening, johnson_cook=(c, rate) if c and rate else None)


def _tables(card: MaterialCard, rows: list[bytes], version: int, notes: Notes) -> MaterialCard:
    """36: a curve of flow stress."""
    _note_failure(card, read_row(rows[0], 20, 20, 20)[2], notes)
    n, _, kinematic = read_row(rows[1], 10, 10, 20)
    pressure, _, young, saturated, decrease = read_row(rows[2], 10, 20, 10, 20, 20)
    if pressure:
        notes.refuse(card.place, card.keyword, "a flow stress that depends on pressure (fct_IDp)")
    if version >= _WITH_YOUNG:
        card = _decrease(card, young, saturated, decrease, notes)
    if n > 5:
        notes.refuse(card.place, card.keyword, f"curves of {n:g} rates", "give one curve")
        return card
    curves = [(int(read_row(rows[3], 10)[0]), read_row(rows[4], 20)[0])] * max(1, int(n))
    return replace(card, hardening=_curve(card, curves, kinematic, 1.0, notes))


def _hill(card: MaterialCard, rows: list[bytes], version: int, notes: Notes) -> MaterialCard:
    """32: a (e0 + e)^n."""
    a, e0, n, fails, largest = read_row(rows[1], *_WIDE)
    r00, r45, r90 = (value or 1.0 for value in read_row(rows[3], 20, 20, 20))
    _note_failure(card, fails, notes)
    if read_row(rows[2], 20, 20)[1]:
        notes.refuse(card.place, card.keyword, "a flow stress that is a power of the rate (m)", "give m = 0")
    if 0.0 < largest < 1e20:
        notes.refuse(card.place, card.keyword, f"a largest stress (SIGMA_max = {largest:g})", "give the curve by LAW43")
    is_first = version >= _WITH_DIRECTION and bool(read_row(rows[3][80:], 10)[0])
    scale = 1.0 if is_first else _to_rolling(card, r00, r45, r90, notes)
    hardening = Hardening("swift", {"K": a * scale, "e0": e0, "n": n})
    return replace(card, hardening=hardening, yield_function=_lankford("hill1948", r00, r45, r90))


def _hill_tables(card: MaterialCard, rows: list[bytes], version: int, notes: Notes) -> MaterialCard:
    """43: Hill's yield function with a curve."""
    card, rows = _take_young(card, rows, version, notes)
    r00, r45, r90, kinematic = read_row(rows[1], 20, 20, 20, 20)
    r00, r45, r90 = (value or 1.0 for value in (r00, r45, r90))
    is_first = version >= _WITH_DIRECTION and bool(read_row(rows[1][80:], 10)[0])
    scale = 1.0 if is_first else _to_rolling(card, r00, r45, r90, notes)
    hardening = _curve_rows(card, rows, kinematic, scale, notes)
    return replace(card, hardening=hardening, yield_function=_lankford("hill1948", r00, r45, r90))


def _barlat(card: MaterialCard, rows: list[bytes], version: int, notes: Notes) -> MaterialCard:
    """57: Barlat and Lian's yield function with a curve."""
    card, rows = _take_young(card, rows, version, notes)
    r00, r45, r90, kinematic, exponent = read_row(rows[1], *_WIDE)
    r00, r45, r90 = (value or 1.0 for value in (r00, r45, r90))
    function = _lankford("hill1948", r00, r45, r90)
    if round(exponent) in (6, 8):
        function |= {"law": "barlat1989", "exponent": round(exponent)}
    elif round(exponent) != 2:
        notes.refuse(card.place, card.keyword, f"an exponent of {exponent:g}", "take m = 2, 6 or 8")
    return replace(card, hardening=_curve_rows(card, rows, kinematic, 1.0, notes), yield_function=function)


_LAWS: dict[str, Callable[[MaterialCard, list[bytes], int, Notes], MaterialCard]] = {
    "LAW2": _johnson_cook,
    "LAW32": _hill,
    "LAW36": _tables,
    "LAW43": _hill_tables,
    "LAW57": _barlat,
}


def _take_young(card: MaterialCard, rows: list[bytes], version: int, notes: Notes) -> tuple[MaterialCard, list[bytes]]:
    """Return the card, and the rows without that of Young's modulus that falls, where the version has it."""
    if version < _WITH_YOUNG:
        return card, rows
    number, _, saturated, decrease = read_row(rows[1], 10, 10, 20, 20)
    return _decrease(card, number, saturated, decrease, notes), [rows[0], *rows[2:]]


def _decrease(card: MaterialCard, number: float, saturated: float, rate: float, notes: Notes) -> MaterialCard:
    if number:
        notes.refuse(card.place, card.keyword, "a curve of Young's modulus (fct_IDE)", "give Einf and CE")
    if bool(saturated) != bool(rate):
        notes.leave(card.place, card.keyword, f"Einf = {saturated:g}, CE = {rate:g}", "one without the other")
    return replace(card, young_decrease=(saturated, rate)) if saturated and rate else card


def _curve_rows(card: MaterialCard, rows: list[bytes], kinematic: float, scale: float, notes: Notes) -> Hardening:
    """Return the curve of laws 43 and 57: rows of number, factor and rate, below that of failure."""
    _note_failure(card, read_row(rows[2], 20)[0], notes)
    values = [read_row(row, 10, 10, 20) for row in rows[3:] if row.strip()]
    return _curve(card, [(int(number), factor) for number, _, factor in values], kinematic, scale, notes)


def _curve(
    card: MaterialCard, curves: list[tuple[int, float]], kinematic: float, scale: float, notes: Notes
) -> Hardening:
    if kinematic:
        notes.refuse(card.place, card.keyword, f"kinematic hardening (C_hard = {kinematic:g})")
    if len(curves) > 1:
        notes.refuse(card.place, card.keyword, f"curves of {len(curves)} rates", "give one curve")
    if not curves or not curves[0][0]:
        raise IndexError
    number, factor = curves[0]
    return Hardening("table", curve=number, curve_scale=scale * (factor or 1.0))


def _lankford(law: str, r00: float, r45: float, r90: float) -> dict[str, object]:
    return {"law": law, "r00": r00, "r45": r45, "r90": r90}


def _to_rolling(card: MaterialCard, r00: float, r45: float, r90: float, notes: Notes) -> float:
    """Return the yield stress along the rolling direction over the mean one, which the deck gives.

    Hill's function of these laws is A1 s1^2 + ... with A1 = H (1 + 1/r00), H = r/(1 + r), r = (r00 + 2 r45 + r90)/4.
    """
    r = 0.25 * (r00 + 2.0 * r45 + r90)
    scale = float((r / (1.0 + r) * (1.0 + 1.0 / r00)) ** -0.5)
    if abs(scale - 1.0) > 1e-9:
        text = f"mean yield stress (Iyield0 = 0): {scale:.4f} times it along the rolling direction"
        notes.change(card.place, card.keyword, text)
    return scale


def _note_failure(card: MaterialCard, strain: float, notes: Notes) -> None:
    if 0.0 < strain < 1e10:
        notes.change(card.place, card.keyword, f"failure at {strain:g} deletes no cells: look at the forming limit")
