# SPDX-License-Identifier: Apache-2.0
"""`presswork material fit` of hot compression tests, from the CSV file to a material that a case takes."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from presswork.case.material.hot_table import read_hot_table
from presswork.case.material.library import find_sheet
from presswork.cli.material import app
from tests.unit.material.test_compression import HENSEL, measure

HEATED = ["--density", "7850 kg/m^3", "--specific-heat", "650 J/(kg*K)"]


@pytest.fixture
def curves(tmp_path: Path) -> Path:
    rows = [
        f"{strain!r},{stress!r},{test.rate},{test.start},15,10,0.2"
        for test in measure("hensel_spittel", HENSEL, m=0.2, heats=True)
        for strain, stress in zip(test.strain.tolist(), test.stress.tolist(), strict=True)
    ]
    path = tmp_path / "steel.csv"
    path.write_text("\n".join(["strain,stress,rate,temperature,height,diameter,m", *rows]))
    return path


def test_material_file_table_and_picture_are_written(curves: Path) -> None:
    result = CliRunner().invoke(app, ["fit", str(curves), "--young", "100 GPa", *HEATED])
    assert result.exit_code == 0, result.output
    assert "friction: m = 0.2 to 0.2" in result.output
    assert "heating in the test: up to 21" in result.output
    hardening = find_sheet(str(curves.with_suffix(".toml"))).material.hardening.model_dump()
    assert hardening["law"] == "hensel_spittel"
    for key, value in HENSEL.items():
        assert hardening[key] == pytest.approx(value, rel=1e-6, abs=1e-12)
    assert len(read_hot_table(curves.with_name("steel_table.csv"))) == 3 + 15 + 4 + 4 + 15 * 4 * 4
    assert curves.with_suffix(".png").stat().st_size > 20_000


def test_a_law_and_a_whole_table_come_of_few_points(tmp_path: Path) -> None:
    path = tmp_path / "few.csv"
    tests = {(0.01, 900): (120, 130), (1, 900): (170, 190), (0.01, 1100): (60, 62)}
    rows = [f"{e},{s},{r},{t}" for (r, t), stress in tests.items() for e, s in zip((0.1, 0.3), stress, strict=True)]
    path.write_text("\n".join(["strain,stress,rate,temperature", "0,0,1,900", *rows]))
    result = CliRunner().invoke(app, ["fit", str(path), "--young", "100 GPa"])
    assert result.exit_code == 0, result.output
    told = " ".join(result.output.split())
    assert "the tests do not determine m4, m7, m8, which are 0" in told
    assert "untested, so of the law: 1 1/s at 1100 degrees C" in told
    assert "left out: sinh_arrhenius: 3 pairs of rate and temperature" in told
    numbers = read_hot_table(path.with_name("few_table.csv"))
    assert len(numbers) == 3 + 15 + 2 + 2 + 15 * 2 * 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--law", "voce"], "unknown law of hot tests"),
        (["--density", "7850 kg/m^3"], "heating needs density and specific heat"),
        (["--density", "7850 kg", "--specific-heat", "650 J/(kg*K)"], "expected a density"),
        (["--density", "-1 kg/m^3", "--specific-heat", "650 J/(kg*K)"], "expected a value > 0"),
    ],
)
def test_wrong_options_are_refused(curves: Path, options: list[str], message: str) -> None:
    result = CliRunner().invoke(app, ["fit", str(curves), "--young", "100 GPa", *options])
    assert result.exit_code == 2
    assert message in " ".join(result.output.split())
