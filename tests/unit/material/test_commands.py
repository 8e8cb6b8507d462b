# SPDX-License-Identifier: Apache-2.0
"""The commands `materials` and `material`: what they print and write, and exit status 2 for bad input."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork.cli import app
from presswork.material import find_sheet
from presswork.material.predict import predict_biaxial, predict_tension

YOUNG = 206e3


def invoke(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture
def tensile(tmp_path: Path) -> Path:
    rows = ["angle,strain,stress,width_strain"]
    for angle, r in ((0, 1.79), (45, 1.51), (90, 2.27)):
        p = np.linspace(0.0, 0.25, 60)
        stress = 565.32 * (0.007117 + p) ** 0.2589
        width = -r / (1 + r) * p - 0.3 * stress / YOUNG
        rows += [f"{angle},{e},{s},{w}" for e, s, w in zip(p + stress / YOUNG, stress, width, strict=True)]
    path = tmp_path / "steel.csv"
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


def test_materials_lists_the_library() -> None:
    output = invoke("materials")
    assert "aa6016_t4" in output
    assert "NUMISHEET'93 mild steel" in output


def test_show_tells_numbers_sources_and_assumptions() -> None:
    output = invoke("material", "show", "aa2090_t3")
    for word in ("AA2090-T3", "1.6 mm", "1.3783", "Barlat et al.", "assumed, young"):
        assert word in output


def test_plot_draws_a_picture(tmp_path: Path) -> None:
    path = tmp_path / "one.png"
    invoke("material", "plot", "numisheet93_mild_steel", "--output", path)
    assert path.read_bytes()[:4] == b"\x89PNG"


def test_flc_writes_points_and_a_picture(tmp_path: Path) -> None:
    path = tmp_path / "limit.png"
    output = invoke("material", "flc", "numisheet93_mild_steel", "--output", path)
    assert "Keeler, t = 0.78 mm, n = 0.2589: lowest at minor 0.000" in output
    assert path.exists()
    table = np.loadtxt(path.with_suffix(".csv"), delimiter=",", skiprows=1)
    assert table[:, 1].min() == pytest.approx(np.log1p((23.3 + 14.13 * 0.78) * 0.2589 / 21), rel=1e-5)


def test_fit_compares_laws_and_leaves_a_material_that_can_be_used(tensile: Path) -> None:
    output = invoke("material", "fit", tensile, "--young", "206 GPa")
    assert "swift is taken" in output
    assert "r at 45 degrees = 1.510" in output
    assert "extrapolated to 0.6" in output
    sheet = find_sheet(str(tensile.with_suffix(".toml")))
    assert sheet.material.hardening.law == "swift"
    assert sheet.material.hardening.parameters() == pytest.approx([565.32, 0.007117, 0.2589], rel=1e-3)
    found = sheet.material.yield_function
    assert (found.law, found.exponent, found.stress_biaxial) == ("yld2000", 6, None)
    assert [found.r00, found.r45, found.r90] == pytest.approx([1.79, 1.51, 2.27], rel=1e-3)
    assert "not measured" in sheet.assumed["yield_function"]
    assert tensile.with_suffix(".png").exists()


def test_fit_takes_hills_function_where_it_is_asked_for(tensile: Path) -> None:
    invoke("material", "fit", tensile, "--young", "206 GPa", "--law", "swift", "--yield-function", "hill1948")
    found = find_sheet(str(tensile.with_suffix(".toml"))).material.yield_function
    assert found.hill_parameters()[0] == pytest.approx(1.79 / 2.79 / 2.27, rel=1e-3)


def test_fit_takes_the_law_the_file_and_poissons_ratio_that_it_is_given(tensile: Path, tmp_path: Path) -> None:
    path = tmp_path / "other.toml"
    invoke("material", "fit", tensile, "--young", "206000", "--law", "voce", "--poisson", "0.28", "--output", path)
    material = find_sheet(str(path)).material
    assert material.hardening.law == "voce"
    assert material.poisson == 0.28


def test_yld2000_prints_the_published_parameters() -> None:
    data = {
        "s00": 1,
        "s45": 0.8110,
        "s90": 0.9100,
        "sb": 1.035,
        "r00": 0.2110,
        "r45": 1.5797,
        "r90": 0.6919,
        "rb": 0.6699,
    }
    output = invoke("material", "yld2000", *(word for key, value in data.items() for word in (f"--{key}", value)))
    alpha = [float(text) for text in output.split("[")[1].split("]")[0].split(",")]
    published = [0.4865, 1.3783, 0.7536, 1.0246, 1.0363, 0.9036, 1.2321, 1.4858]
    assert alpha == pytest.approx(published, abs=1e-3)
    other = invoke("material", "yld2000", "--exponent", "6", *(w for k, v in data.items() for w in (f"--{k}", v)))
    assert other != output


def test_yld2000_takes_all_angles_of_a_file_and_says_what_it_misses(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    rows = ["0,1,0.526", "15,0.944,0.344", "30,0.913,0.301", "45,0.908,0.253", "60,0.898,0.294", "75,0.928,0.393"]
    path.write_text("\n".join(["angle,stress,r", *rows, "90,0.983,0.601", "biaxial,1,1"]), encoding="utf-8")
    output = invoke("material", "yld2000", path)
    alpha = [float(text) for text in output.split("[")[1].split("]")[0].split(",")]
    assert alpha == pytest.approx(find_sheet("aa6016_t4").material.yield_function.alpha, abs=2e-4)
    assert "largest errors: " in output
    assert invoke("material", "yld2000", path, "--r-weight", "5") != output
    result = CliRunner().invoke(app, ["material", "yld2000", str(path), "--s00", "1"])
    assert result.exit_code == 2


def test_fit_finds_yld2000_from_tests_at_all_angles(tmp_path: Path) -> None:
    """From curves made with one function, of the exponent that is asked for, at seven angles."""
    function = find_sheet("aa6022").material.yield_function.build()
    angles = np.arange(0.0, 91.0, 15.0)
    made = predict_tension(function, angles)
    p = np.linspace(0.0, 0.25, 60)
    rows = ["angle,strain,stress,width_strain"]
    for angle, ratio, r in zip(angles, made.stress, made.r, strict=True):
        stress = ratio * 500.0 * (0.01 + ratio * p) ** 0.25
        width = -r / (1 + r) * p - 0.33 * stress / 70e3
        rows += [f"{angle},{e},{s},{w}" for e, s, w in zip(p + stress / 70e3, stress, width, strict=True)]
    path = tmp_path / "aluminium.csv"
    path.write_text("\n".join(rows), encoding="utf-8")
    options = ["--young", "70 GPa", "--poisson", "0.33", "--law", "swift", "--yield-function", "yld2000"]
    biaxial, r_biaxial = predict_biaxial(function)
    invoke("material", "fit", path, *options, "--biaxial-stress", biaxial, "--biaxial-r", r_biaxial)
    found = find_sheet(str(path.with_suffix(".toml"))).material.yield_function
    assert found.law == "yld2000"
    again = predict_tension(found.build(), angles)
    np.testing.assert_allclose(again.stress, made.stress / made.stress[0], rtol=2e-3)
    np.testing.assert_allclose(again.r, made.r, rtol=2e-3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plot", "aa6016"], "did you mean `aa6016_t4`"),
        (["flc", "aa1100_o"], "forming_limit: missing table"),
        (["fit", "nowhere.csv", "--young", "206 GPa"], "no such file"),
        (["fit", "STEEL", "--young", "206"], "206 MPa is outside the range of metals"),
        (["fit", "STEEL", "--young", "steel"], "expected a stress, not `steel`"),
        (["fit", "STEEL", "--young", "206 GPa", "--law", "vose"], "did you mean `voce`"),
    ],
)
def test_bad_input_leaves_with_status_2_and_the_reason(tensile: Path, arguments: list[str], words: str) -> None:
    result = CliRunner().invoke(app, ["material", *(str(tensile) if a == "STEEL" else a for a in arguments)])
    assert result.exit_code == 2
    assert words in result.output
