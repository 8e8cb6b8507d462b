# SPDX-License-Identifier: Apache-2.0
"""Materials of LS-DYNA: rigid bodies, and the elastic-plastic laws of sheets with numbers 18, 24, 36, 37 and 133."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from presswork.deck.contents import Hardening, MaterialCard
from presswork.deck.dyna.blocks import Block
from presswork.deck.dyna.cards import leave_fields, leave_rows
from presswork.deck.notes import Notes

Cards = list[list[float]]
_NAMES = {
    "RIGID": 20,
    "POWER_LAW_PLASTICITY": 18,
    "PIECEWISE_LINEAR_PLASTICITY": 24,
    "3-PARAMETER_BARLAT": 36,
    "TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC": 37,
    "BARLAT_YLD2000": 133,
}
_HANSEL = 3


def read_material(block: Block, name: str, has_title: bool, notes: Notes) -> tuple[int, MaterialCard] | None:
    """Return the number of a material and the material; None where it has no counterpart, which is noted.

    name: of the keyword without *MAT_ and options. Raises FieldError.
    """
    number = _NAMES.get(name) or (int(name) if name.isdigit() else 0)
    read = _LAWS.get(number)
    if read is None:
        known = ", ".join(sorted(f"{each} ({n})" for each, n in _NAMES.items()))
        notes.refuse(block.place, f"*{block.name}", "no such law of sheets here", f"take one of {known}")
        return None
    rows = block.rows()[has_title:]
    cards = [block.numbers(row) for row in rows]
    cards += [[0.0] * 8 for _ in range(8 - len(cards))]
    material = read(block, cards, notes)
    layouts = _list_layouts(number, cards)
    for row, layout in zip(rows, layouts, strict=False):
        leave_fields(block, row, layout, notes)
    leave_rows(block, rows[len(layouts) :], "a further row", notes)
    return int(cards[0][0]), material


def _list_layouts(number: int, cards: Cards) -> list[str]:
    """Return the fields of each card of a law, those that are not read with a dash (cards.py)."""
    first, second, third = cards[0], cards[1], cards[2]
    axes = ["-xp -yp -zp", "-v1 -v2 -v3 -d1 -d2 -d3 beta -"]
    match number:
        case 18:
            return [f"mid ro e pr k n {_rate_names(first[6:])}", "sigy -vp -epsf"]
        case 24:
            has_rows = any(cards[3])
            straight = "-sigy -etan" if second[2] or has_rows else "sigy etan"
            points = [""] * 2 if has_rows and not second[2] else [_names("-eps", 8), _names("-es", 8)]
            fail = "-fail" if first[6] < 0.0 else "fail"
            return [f"mid ro e pr {straight} {fail} -tdel", f"{_rate_names(second)} lcss lcsr -vp", *points]
        case 36:
            rule = int(first[4])
            p = "-p1 -p2" if rule == 3 else "p1 p2"
            rest = {2: f"-lcid e0 {'-spi' if second[5] else 'spi'} -p3", 3: "lcid -e0 -spi -p3", 4: "-lcid -e0 -spi p3"}
            rolling = f"{axes[0]} {_vector(third[0])} -macf -"
            return [
                f"mid ro e pr hr {p} -iter",
                f"m r00 r45 r90 {rest.get(rule, '-lcid -e0 -spi -p3')}",
                f"aopt {_rate_names(third[1:])} -vlcid - -pb -nlp -",
                rolling,
                axes[1],
            ]
        case 37:
            straight = "-sigy -etan" if first[7] else "sigy etan"
            return [f"mid ro e pr {straight} r hlcid", "idscale -ea -coe -icfld"]
        case 133:
            law = "-k -e0 -n" if second[5] < 0 else "k e0 n"
            rolling = f"{axes[0]} {_vector(cards[3][0])} - -"
            return [
                "mid ro e pr fit beta -iter -iscale",
                f"{law} {_rate_names(second[3:])} hard a",
                _names("alpha", 8),
                "aopt -offang -p4 -htflag -hta -htb -htc -htd",
                rolling,
                axes[1],
            ]
    return ["mid -ro -e -pr -n -couple -m -alias"]


def _names(name: str, n: int) -> str:
    return " ".join(f"{name}{i}" for i in range(1, n + 1))


def _rate_names(values: Sequence[float]) -> str:
    """Return C and P, which are read where both are given."""
    return "c p" if values[0] > 0.0 and values[1] > 0.0 else "-c -p"


def _vector(option: float) -> str:
    return "a1 a2 a3" if round(option) == 2 else "-a1 -a2 -a3"


def _rigid(block: Block, cards: Cards, notes: Notes) -> MaterialCard:
    return replace(_card(block, cards), is_rigid=True)


def _card(block: Block, cards: Cards) -> MaterialCard:
    """Return the part of a material that all laws share: the first numbers of its first card."""
    _, density, young, poisson, *_ = cards[0]
    return MaterialCard(f"*{block.name}", density, young, poisson, block.place)


def _power_law(block: Block, cards: Cards, notes: Notes) -> MaterialCard:
    """18: K (e_yield + e)^n, whose e_yield follows from the elastic line or is given."""
    _, _, young, _, k, n, c, p = cards[0]
    first = _swift_start(young, k, n, cards[1][0])
    hardening = Hardening("swift", {"K": k, "e0": first, "n": n})
    return replace(_card(block, cards), hardening=hardening, cowper_symonds=_rate(c, p))


def _piecewise_linear(block: Block, cards: Cards, notes: Notes) -> MaterialCard:
    """24: a straight line, eight points, or a curve of flow stress; Cowper and Symonds' rate."""
    _, _, young, _, yield_stress, tangent, fail, _ = cards[0]
    c, p, curve, rate_curve, _, *_ = cards[1]
    strains, stresses = np.array(cards[2]), np.array(cards[3])
    if rate_curve:
        notes.refuse(block.place, f"*{block.name}", "LCSR scales the flow stress by a curve of the rate")
    if 0.0 < fail < 1e10:
        notes.change(block.place, f"*{block.name}", f"FAIL = {fail:g} deletes no cells: look at the forming limit")
    if curve:
        hardening = Hardening("table", curve=int(curve))
    elif stresses.any():
        n = int(np.flatnonzero(stresses)[-1]) + 1
        rows = {f"{i}": float(value) for i, value in enumerate(np.column_stack([strains, stresses])[:n].ravel())}
        hardening = Hardening("table", rows)
    else:
        hardening = _straight(young, yield_stress, tangent)
    return replace(_card(block, cards), hardening=hardening, cowper_symonds=_rate(c, p))


def _transversely_isotropic(block: Block, cards: Cards, notes: Notes) -> MaterialCard:
    """37: Hill's yield function of one mean r-value."""
    _, _, _, _, yield_stress, modulus, r, curve = cards[0]  # ETAN is the plastic modulus here, not a tangent modulus
    straight = {"yield_stress": yield_stress, "modulus": abs(modulus)}
    hardening = Hardening("table", curve=int(curve)) if curve else Hardening("linear", straight)
    if modulus < 0:
        text = "ETAN < 0 asks for stress normal to the sheet: that of ironing alone is felt"
        notes.change(block.place, f"*{block.name}", text)
    if r < 0:
        notes.change(block.place, f"*{block.name}", "R < 0 steadies the thickness there: its value is taken")
    if cards[1][0]:
        notes.refuse(block.place, f"*{block.name}", "Young's modulus that falls with plastic strain (IDSCALE)")
    mean = abs(r) or 1.0
    function: dict[str, object] = {"law": "hill1948", "r00": mean, "r45": mean, "r90": mean}
    return replace(_card(block, cards), hardening=hardening, yield_function=function)


def _barlat1989(block: Block, cards: Cards, notes: Notes) -> MaterialCard:
    """36: Barlat and Lian's yield function of three r-values."""
    _, _, young, _, rule, p1, p2, _ = cards[0]
    m, r00, r45, r90, curve, e0, yield_strain, p3 = cards[1]
    c, p = cards[2][1:3]
    match int(rule):
        case 2:
            hardening = Hardening("swift", {"K": p1, "e0": e0 or _swift_start(young, p1, p2, yield_strain), "n": p2})
        case 3:
            hardening = Hardening("table", curve=int(curve))
        case 4:
            hardening = Hardening("voce", {"yield_stress": p1 - p2, "saturation_stress": p1, "rate": p3})
        case 1 | 0:
            hardening = Hardening("linear", {"yield_stress": p2, "modulus": _modulus(young, p1)})
        case other:
            hardening = Hardening("linear", {"yield_stress": p2 or 1.0})
            notes.refuse(block.place, f"*{block.name}", f"no such hardening: HR = {other}", "take HR = 1, 2, 3 or 4")
    if m < 0 or min(r00, r45, r90) <= 0:
        notes.refuse(block.place, f"*{block.name}", "curves of r-values, or A, C, H, P", "give R00, R45, R90")
        r00, r45, r90 = (max(each, 1.0) for each in (r00, r45, r90))
    function: dict[str, object] = {"law": "hill1948", "r00": r00, "r45": r45, "r90": r90}
    if round(m) in (6, 8):
        function |= {"law": "barlat1989", "exponent": round(m)}
    elif round(m) != 2:
        notes.refuse(block.place, f"*{block.name}", f"an exponent of {m:g}", "take M = 2, 6 or 8")
    rolling = _rolling(cards[2][0], cards[3], cards[4], block, notes)
    return replace(
        _card(block, cards), hardening=hardening, yield_function=function, cowper_symonds=_rate(c, p), rolling=rolling
    )


def _yld2000(block: Block, cards: Cards, notes: Notes) -> MaterialCard:
    """133: Yld2000-2d by its eight parameters."""
    fit, beta = cards[0][4:6]
    k, e0, n, c, p, rule, exponent, _ = cards[1]
    if fit:
        notes.refuse(block.place, f"*{block.name}", "parameters from tests (FIT = 1)", "give alpha 1 to 8, FIT = 0")
    if beta:
        notes.refuse(block.place, f"*{block.name}", "kinematic hardening (BETA)")
    match int(rule):
        case 1 | 0:
            hardening = Hardening("swift", {"K": k, "e0": e0, "n": n})
        case 2:
            hardening = Hardening("voce", {"yield_stress": k - e0, "saturation_stress": k, "rate": n})
        case negative if negative < 0:
            hardening = Hardening("table", curve=-negative)
        case other:
            hardening = Hardening("linear", {"yield_stress": k or 1.0})
            name = "Hansel's law" if other == _HANSEL else f"HARD = {other}"
            notes.refuse(block.place, f"*{block.name}", f"no such hardening: {name}", "take HARD = 1, 2 or a curve")
    function: dict[str, object] = {"law": "yld2000", "alpha": cards[2], "exponent": round(exponent)}
    if round(exponent) not in (6, 8):
        notes.refuse(block.place, f"*{block.name}", f"an exponent of {exponent:g}", "take A = 6 or 8")
    rolling = _rolling(cards[3][0], cards[4], cards[5], block, notes)
    return replace(
        _card(block, cards), hardening=hardening, yield_function=function, cowper_symonds=_rate(c, p), rolling=rolling
    )


_LAWS: dict[int, Callable[[Block, Cards, Notes], MaterialCard]] = {
    18: _power_law,
    20: _rigid,
    24: _piecewise_linear,
    36: _barlat1989,
    37: _transversely_isotropic,
    133: _yld2000,
}


def _rolling(
    option: float, vectors: list[float], more: list[float], block: Block, notes: Notes
) -> tuple[float, float, float] | Literal["cell"] | None:
    """Return the rolling direction by AOPT: of the cells (0), or a vector (2); turned by BETA."""
    if more[6]:
        notes.refuse(block.place, f"*{block.name}", f"axes of the material turned by BETA = {more[6]:g}")
    if option == 0:
        return "cell"
    if round(option) == 2 and any(vectors[3:6]):
        return (vectors[3], vectors[4], vectors[5])
    notes.refuse(
        block.place,
        f"*{block.name}",
        f"axes of the material by AOPT = {option:g}",
        "take AOPT = 0, or 2 with A1, A2, A3",
    )
    return None


def _straight(young: float, yield_stress: float, tangent: float) -> Hardening:
    return Hardening("linear", {"yield_stress": yield_stress, "modulus": _modulus(young, tangent)})


def _modulus(young: float, tangent: float) -> float:
    """Return the plastic modulus of a tangent modulus."""
    return young * tangent / (young - tangent) if 0.0 < tangent < young else 0.0


def _swift_start(young: float, k: float, n: float, value: float) -> float:
    """Return e0 of Swift's law: where it meets the elastic line; from a yield strain or stress where given."""
    if value > 0.02:  # a stress
        return float((value / k) ** (1.0 / n))
    if value > 0.0:
        return value
    return float((young / k) ** (1.0 / (n - 1.0)))


def _rate(c: float, p: float) -> tuple[float, float] | None:
    return (c, p) if c > 0.0 and p > 0.0 else None
