# SPDX-License-Identifier: Apache-2.0
"""Files of tensile tests as machines write them give the same fit whatever their form, and one clear message if not."""

from __future__ import annotations

import math
import random
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from presswork.case.errors import CaseError
from presswork.material.identify import fit_hardening, fit_r_value
from presswork.material.measured_file import read_measured_file, read_number
from presswork.material.quantities import find_unit, read_column
from presswork.material.specimen_facts import Sizes
from presswork.material.tensile import TensileTests, read_tensile

YOUNG, POISSON = 206e3, 0.3
K, E0, N = 530.0, 0.004, 0.21
R = {0.0: 1.7, 45.0: 1.3, 90.0: 1.9}
THICKNESS, WIDTH, LENGTH = 0.8, 20.0, 80.0


def curve(angle: float) -> dict[str, np.ndarray]:
    """Engineering strain, stress and width strain of a specimen of Swift's law, to beyond the highest force."""
    p = np.concatenate([[0.0], np.geomspace(1e-4, 0.3, 60)])
    stress = K * (E0 + p) ** N * (1.0 + 1e-4 * angle)
    strain, across = p + stress / YOUNG, -R[angle] / (1 + R[angle]) * p - POISSON * stress / YOUNG
    rise = np.linspace(0.0, 0.9, 8) * strain[0]
    strain = np.concatenate([rise, strain])
    across = np.concatenate([-POISSON * rise, across])
    stress = np.concatenate([YOUNG * rise, stress])
    return {"strain": np.expm1(strain), "stress": stress * np.exp(-strain), "width": np.expm1(across)}


NAMES = {
    "force": ["Standardkraft", "Kraft", "Force", "Load", "Charge", "Forza"],
    "stress": ["Spannung", "Tensile stress", "Contrainte", "Engineering stress"],
    "path": ["Traverse", "Standardweg", "Crosshead", "Extension", "D\u00e9placement"],
    "extensometer": ["Extensometer", "L\u00e4ngen\u00e4nderung", "Extens. extensometer"],
    "strain": ["Dehnung", "Tensile strain", "Allongement", "Engineering strain"],
    "change": ["Breiten\u00e4nderung", "Width change", "Querweg Breite"],
    "across": ["Transverse strain", "Querdehnung"],
}
UNITS = {"force": ["N", "kN"], "stress": ["MPa", "N/mm\u00b2", "GPa"], "path": ["mm", "\u00b5m"],
         "extensometer": ["mm"], "strain": ["%", "-"], "change": ["mm", "\u00b5m"], "across": ["%", "-"]}  # fmt: skip
FACTOR = {"N": 1.0, "kN": 1e3, "MPa": 1.0, "N/mm\u00b2": 1.0, "GPa": 1e3, "mm": 1.0, "\u00b5m": 1e-3, "%": 0.01,
          "-": 1.0}  # fmt: skip
OF_SPECIMEN = [
    ("a0", "b0", "L0"),
    ("Thickness", "Width", "Gauge length"),
    ("Probendicke", "Probenbreite", "Messl\u00e4nge"),
]


@dataclass
class Form:
    """A file's form, drawn by a seed."""

    draw: random.Random
    separator: str
    decimal: str

    def number(self, value: float) -> str:
        """Write a number, sometimes with groups of thousands or an exponent."""
        text = f"{value:.9f}"
        if self.draw.random() < 0.1 and abs(value) >= 1000.0 and self.separator != " ":
            text = f"{value:,.9f}".replace(",", "'")
        elif self.draw.random() < 0.1:
            text = f"{value:.12e}"
        return self.cell(text.replace(".", self.decimal))

    def cell(self, text: str) -> str:
        """Write a cell, in quotes where its text needs them."""
        return f'"{text}"' if self.separator in text else text

    def line(self, *cells: str) -> str:
        return self.separator.join(self.cell(cell) if not cell.startswith('"') else cell for cell in cells)


def columns(form: Form, angle: float, chosen: list[tuple[str, str]]) -> list[np.ndarray]:
    """Return the chosen quantities of a specimen in their units."""
    points = curve(angle)
    values = {
        "force": points["stress"] * THICKNESS * WIDTH, "stress": points["stress"], "path": points["strain"] * LENGTH,
        "extensometer": points["strain"] * LENGTH, "strain": points["strain"], "change": points["width"] * WIDTH,
        "across": points["width"], "time": np.arange(len(points["strain"])) / 7.0,
    }  # fmt: skip
    return [values[kind] / FACTOR.get(unit, 1.0) for kind, unit in chosen]


def write_file(path: Path, seed: int) -> None:
    """Write three specimens in a form that a seed draws."""
    draw = random.Random(seed)
    separator, decimal = draw.choice(
        [(";", ","), (";", "."), ("\t", ","), ("\t", "."), (",", "."), (",", ","), (" ", ".")]
    )
    form = Form(draw, separator, decimal)
    kinds = [draw.choice(["force", "stress"]), draw.choice(["path", "extensometer", "strain"])]
    kinds += [draw.choice(["change", "across"])] + ["time"] * draw.randint(0, 1)
    draw.shuffle(kinds)
    chosen = [(kind, "s" if kind == "time" else draw.choice(UNITS[kind])) for kind in kinds]
    titles = ["Zeit" if kind == "time" else draw.choice(NAMES[kind]) for kind in kinds]
    if separator == " ":
        titles = [title.replace(" ", "_") for title in titles]
    in_row = draw.random() < 0.5
    brackets = draw.choice(["[]", "()"])
    heads = titles if in_row else [
        f"{title}{'' if separator == ' ' else ' '}{brackets[0]}{unit}{brackets[1]}"
        for title, (_, unit) in zip(titles, chosen, strict=True)
    ]  # fmt: skip
    units = [[draw.choice([unit, f"[{unit}]"]) for _, unit in chosen]] if in_row else []
    lines = [form.line("Pr\u00fcfnorm", "ISO 6892-1"), form.line("Maschine", "Nr. 3"), ""][: draw.randint(0, 3)]
    for name, value in zip(draw.choice(OF_SPECIMEN), (THICKNESS, WIDTH, LENGTH), strict=True):
        name = name.replace(" ", "_") if separator == " " else name
        lines.append(form.line(name, form.number(value), "mm"))
    layout = draw.choice(["blocks", "beside", "column"])
    angles = [0.0, 45.0, 90.0]
    draw.shuffle(angles)
    tables = {angle: columns(form, angle, chosen) for angle in angles}
    if layout == "blocks":
        for angle in angles:
            lines += ["", form.line(draw.choice(["Probe", "Winkel"]), f"{angle:g}\u00b0"), form.line(*heads)]
            lines += [form.line(*row) for row in units]
            lines += [form.line(*map(form.number, row)) for row in zip(*tables[angle], strict=True)]
    elif layout == "column":
        lines += [form.line("Winkel", *heads)] + [form.line("\u00b0", *row) for row in units]
        for angle in angles:
            lines += [form.line(f"{angle:g}", *map(form.number, row)) for row in zip(*tables[angle], strict=True)]
    else:
        one = 0.0  # specimens side by side are of one direction
        lines += [form.line(*heads, *heads)] + [form.line(*row, *row) for row in units]
        table = columns(form, one, chosen)
        lines += [form.line(*map(form.number, (*row, *row))) for row in zip(*table, strict=True)]
    encoding = draw.choice(["utf-8", "utf-8-sig", "latin-1", "utf-16"])
    path.write_bytes(draw.choice(["\n", "\r\n"]).join(lines).encode(encoding))


@pytest.mark.parametrize("seed", range(40))
def test_the_same_curve_in_any_form_gives_the_same_fit(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "test.csv"
    write_file(path, seed)
    read = read_tensile(path, young=YOUNG)
    along = next(test for test in read.tests if test.angle == 0.0)
    fit = fit_hardening(along, "swift", YOUNG)
    assert fit.parameters == pytest.approx({"K": K, "e0": E0, "n": N}, rel=2e-4)
    for test in read.tests:
        assert fit_r_value(test, YOUNG, POISSON) == pytest.approx(R[test.angle], rel=1e-4)
    assert len(read.tests) == 3 or any("2 specimens at 0 degrees" in note for note in read.notes)


def read_text(tmp_path: Path, text: str, sizes: Sizes | None = None) -> TensileTests:
    path = tmp_path / "t.csv"
    path.write_bytes(text.encode("latin-1"))
    return read_tensile(path, sizes, YOUNG)


def machine_rows(give: float = 0.0, toe: float = 0.0) -> str:
    """Rows of path [mm] and force [N] on a machine that gives by `give` [mm/N] and takes up `toe` [mm]."""
    points = curve(0.0)
    force = points["stress"] * THICKNESS * WIDTH
    path = points["strain"] * LENGTH + give * force + toe
    return "".join(f"{x:.7f};{f:.6f}\n" for x, f in zip(path, force, strict=True)).replace(".", ",")


def test_the_machines_give_is_taken_off_a_crossheads_path(tmp_path: Path) -> None:
    sizes = Sizes(thickness=THICKNESS, width=WIDTH, gauge_length=LENGTH)
    read = read_text(tmp_path, "Traverse;Kraft\nmm;N\n" + machine_rows(give=5e-5, toe=0.02), sizes)
    assert "the machine's give is taken off" in read.notes[0]
    assert fit_hardening(read.tests[0], "swift", YOUNG).parameters == pytest.approx(
        {"K": K, "e0": E0, "n": N}, rel=2e-3
    )


def test_a_slope_that_is_not_youngs_modulus_is_noted(tmp_path: Path) -> None:
    sizes = Sizes(thickness=2 * THICKNESS, width=WIDTH, gauge_length=LENGTH)
    read = read_text(tmp_path, "L\u00e4ngen\u00e4nderung;Kraft\nmm;N\n" + machine_rows(), sizes)
    assert re.search(r"rises with 10[23]\d{3} MPa", read.notes[0])
    assert "check units and sizes" in read.notes[0]


def test_sizes_that_are_missing_are_named_with_the_option(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"(?s)give --thickness and --width.*give --gauge-length"):
        read_text(tmp_path, "Traverse;Kraft\nmm;N\n" + machine_rows())


def test_sizes_given_count_more_than_those_of_the_file(tmp_path: Path) -> None:
    head = "a0;1,6;mm\nb0;20;mm\nL0;80;mm\nTraverse;Kraft\nmm;N\n"
    half = read_text(tmp_path, head + machine_rows()).tests[0]
    whole = read_text(tmp_path, head + machine_rows(), Sizes(thickness=THICKNESS)).tests[0]
    assert half.stress.max() == pytest.approx(0.5 * whole.stress.max(), rel=0.02)


def test_faults_of_hundreds_of_lines_are_one_message(tmp_path: Path) -> None:
    rows = "".join(f"{0.001 * i},{200 + i},x\n{0.001 * i},?,3\n" for i in range(300))
    with pytest.raises(CaseError) as caught:
        read_text(tmp_path, "engineering_strain,engineering_stress,width_engineering_strain\n0,0,0\n1,1,0\n" + rows)
    assert len(str(caught.value).splitlines()) <= 5
    assert "more cells that are not numbers" in str(caught.value)


@pytest.mark.parametrize(
    "data", [b"\x00\x01\x02", b"PK\x03\x04\x00\x00", b"", b"\n\n", b"no table at all\n", b"1;2\n3;4\n"]
)
def test_what_is_no_table_gets_one_short_message(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(data)
    with pytest.raises(CaseError) as caught:
        read_tensile(path)
    assert len(str(caught.value).splitlines()) == 1


def test_an_extensometer_that_was_taken_off_ends_the_curve(tmp_path: Path) -> None:
    lines = machine_rows().splitlines()
    text = "a0;0,8\nb0;20\nL0;80\nExtensometer [mm];Kraft [N]\n" + "\n".join(lines[:50])
    cut = "\n".join(f";{line.split(';')[1]}" for line in lines[50:55])
    assert len(read_text(tmp_path, f"{text}\n{cut}\n").tests[0].strain) == 50


def test_specimens_of_one_direction_are_averaged(tmp_path: Path) -> None:
    head = "Probe {i}\nDehnung [-];Spannung [MPa]\n"
    points = curve(0.0)
    pairs = list(zip(points["strain"], points["stress"], strict=True))
    blocks = [
        head.format(i=i) + "".join(f"{e:.8f};{scale * s:.6f}\n" for e, s in pairs)
        for i, scale in enumerate((0.98, 1.02))
    ]
    read = read_text(tmp_path, "".join(blocks))
    assert fit_hardening(read.tests[0], "swift", YOUNG).parameters["K"] == pytest.approx(K, rel=3e-3)
    assert "differ by up to 4.0 %" in read.notes[-1]


@pytest.mark.parametrize(
    ("text", "decimal", "value"),
    [("1.234,5", ",", 1234.5), ("1,234.5", ".", 1234.5), ("1'234", ".", 1234.0), ("0,5", ".", None), ("-,5", ",", -0.5),
     ("1e3", ".", 1e3), ("12,5E-1", ",", 1.25), ("1.2.3", ".", None), ("\u22123", ".", -3.0), ("nan", ".", None)],
)  # fmt: skip
def test_numbers_are_read_by_their_decimal_mark(text: str, decimal: str, value: float | None) -> None:
    assert read_number(text, decimal) == value


@pytest.mark.parametrize(
    ("title", "kind", "unit"),
    [("Standardkraft [kN]", "force", "kn"), ("Strain 1 (%)", "strain", "%"), ("Spannung in MPa", "stress", "mpa"),
     ("engineering_strain_percent", "strain", "%"), ("Weg / \u00b5m", "path", "um"), ("Zeit [s]", "", "s"),
     ("R [N/mm\u00b2]", "stress", "n/mm2"), ("Tensile extension (in)", "path", "in"), ("Kraft", "force", ""),
     ("width_strain", "width", ""), ("Dehnung [mm]", "path", "mm"), ("\u0394L [mm]", "extensometer", "mm")],
)  # fmt: skip
def test_titles_of_columns_say_quantity_and_unit(title: str, kind: str, unit: str) -> None:
    column = read_column(title)
    assert (column.kind, column.unit) == (kind, unit)


def test_units_in_other_letters_are_the_same() -> None:
    assert [find_unit(text) for text in ("N/mm\u00b2", "[kN]", "(\u00b5m)", "\u2030", "MPa", "what")] == [
        "n/mm2", "kn", "um", "%o", "mpa", None,
    ]  # fmt: skip


def test_the_encoding_does_not_matter(tmp_path: Path) -> None:
    for encoding in ("latin-1", "utf-8", "utf-8-sig", "utf-16"):
        path = tmp_path / f"{encoding}.csv"
        path.write_bytes("Pr\u00fcfer;M\u00fcller\nDehnung;Spannung\n%;MPa\n0;0\n1;2\n2;3\n".encode(encoding))
        file = read_measured_file(path)
        assert file.lines[0].cells == ("Pr\u00fcfer", "M\u00fcller")
        assert len(file.blocks) == 1
    assert math.isclose(file.number("2") or 0.0, 2.0)
