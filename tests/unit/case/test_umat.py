# SPDX-License-Identifier: Apache-2.0
"""Bad input of materials with a UMAT is told before anything is computed."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from typer.testing import CliRunner

import presswork
from presswork import build_model
from presswork.case import CaseError, read_case
from presswork.cli import app
from presswork.examples import copy_example
from presswork.law.allowed import VARIABLE, allow_library
from presswork.law.umat import CompileError, compile_law

GOOD = {"props": "[1, 200e3, 0.3, 700, 0.01, 0.2]", "state_variables": "1"}


def build(folder: Path, library: object, settings: tuple[str, ...] = (), **keys: str):
    """Build the upsetting example with a UMAT in place of its material."""
    path = copy_example("upsetting_q4", folder / "case")
    head, rest = path.read_text(encoding="utf-8").split("[materials.steel]")
    table = "".join(f"{key} = {value}\n" for key, value in {**GOOD, **keys}.items())
    path.write_text(f'{head}[materials.steel]\numat = "{library}"\n{table}\n{rest[rest.index("[tools.punch]") :]}')
    return build_model(read_case(path, settings))


def test_the_first_tangent_gives_the_elastic_constants(tmp_path, umat_laws):
    model = build(tmp_path, umat_laws)
    assert model.materials[0].young == pytest.approx(200e3, rel=1e-9)
    assert model.materials[0].poisson == pytest.approx(0.3, rel=1e-9)


BAD = {
    "no such file": ({"library": "nowhere.so"}, ["materials.steel.umat", "nowhere.so", "no such file"]),
    "no library": ({"library": "text.so"}, ["materials.steel.umat", "invalid ELF header"]),
    "too few properties": ({"props": "[1, 200e3, 0.3]"}, ["steel.umat", "not numbers", "than the 3 props"]),
    "too few state variables": ({"state_variables": "0"}, ["steel.umat", "state variables"]),
    "writes too far": ({"props": "[7, 200e3, 0.3]"}, ["steel.umat", "beyond its 1 state variables", "*DEPVAR"]),
    "stops": ({"props": "[6, 200e3, 0.3, -1, 1]"}, ["steel.umat", "stops (XIT) at its first call"]),
    "no stiffness": ({"props": "[4, 0, 0.3, 1, 1]"}, ["steel.umat", "no tangent (DDSDDE) of a solid"]),
    "no such variable": ({"plastic_strain": "2"}, ["steel.plastic_strain = 2", "only 1 state variables"]),
    "variable zero": ({"plastic_strain": "0"}, ["steel.plastic_strain = 0", ">= 1"]),
    "negative number": ({"state_variables": "-1"}, ["steel.state_variables = -1", ">= 0"]),
    "wrong word": ({"jacobian": '"tangent"'}, ["steel.jacobian", "jaumann_kirchhoff, stress_increment"]),
    "both laws": ({"young": "200e3"}, ["materials.steel.young", "unknown key"]),
    "element": ({"settings": ("workpiece.element=quad4_1pt",)}, ["workpiece.element", "flow stress", "quad4_fbar"]),
    "tangent": ({"settings": ("solver.tangent=thesis",)}, ["solver.tangent", "consistent"]),
}


@pytest.mark.parametrize("fault", BAD)
def test_a_umat_that_cannot_be_used_is_refused(tmp_path, umat_laws, fault):
    keys, words = BAD[fault]
    text = tmp_path / "case" / "text.so"
    text.parent.mkdir()
    text.write_text("no library, " * 100)
    allow_library(text)
    with pytest.raises(CaseError) as error:
        build(tmp_path, **{"library": umat_laws, **keys})
    for word in words:
        assert word in str(error.value)


def test_a_library_without_umat_is_refused(tmp_path):
    source = tmp_path / "other.c"
    source.write_text("void vumat_(void) {}\n")
    with pytest.raises(CaseError, match=r"no routine UMAT \(symbol umat_\)"):
        build(tmp_path, compile_law(source))


def test_a_library_that_lacks_a_symbol_says_which(tmp_path):
    source = tmp_path / "lacks.c"
    source.write_text("void sprind_(void);\nvoid umat_(void) { sprind_(); }\n")
    with pytest.raises(CaseError, match="undefined symbol: sprind_"):
        build(tmp_path, compile_law(source))


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5])
def test_a_library_cut_short_is_refused_in_words(tmp_path, umat_laws, part):
    """Opening it may end the process by a signal, which must not be this one."""
    whole = umat_laws.read_bytes()
    short = tmp_path / "short.so"
    short.write_bytes(whole[: int(part * len(whole))])
    allow_library(short)
    with pytest.raises(CaseError, match=r"materials\.steel\.umat.*cannot be used"):
        build(tmp_path, short)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("*(volatile int*)0 = 1;", "ends the process by SIGSEGV"),
        ("abort();", "ends the process by SIGABRT"),
        ("exit(3);", "ends the process with status 3"),
    ],
)
def test_code_that_ends_its_process_is_refused_in_words(tmp_path, body, said):
    source = tmp_path / "bad.c"
    source.write_text(f"#include <stdlib.h>\nvoid umat_(void) {{ {body} }}\n")
    with pytest.raises(CaseError, match=said):
        build(tmp_path, compile_law(source))


@pytest.fixture
def foreign(tmp_path, monkeypatch):
    """A case whose library, not compiled by presswork, writes a file as it is opened; its case and that file."""
    monkeypatch.setenv(VARIABLE, "0")  # --run-user-code sets it
    source, mark, library = tmp_path / "mark.c", tmp_path / "ran", tmp_path / "mark.so"
    source.write_text(
        f'#include <stdio.h>\n__attribute__((constructor)) static void run(void) {{ fclose(fopen("{mark}", "w")); }}\n'
        "void umat_(void) {}\n"
    )
    subprocess.run(["gcc", "-shared", "-fPIC", str(source), "-o", str(library)], check=True)
    with pytest.raises(CaseError, match=r"materials\.steel\.umat = .*not been allowed to run here; .*--run-user-code"):
        build(tmp_path / "a", library)
    assert not mark.exists()
    return tmp_path / "a" / "case" / "upsetting_q4.toml", mark


def test_no_command_runs_the_code_of_a_case_unasked(tmp_path, foreign):
    case, mark = foreign
    study = tmp_path / "study.toml"
    study.write_text(
        f'case = "{case}"\ngoals = [{{ minimise = "last:punch.force" }}]\n'
        'variables = [{ key = "tools.punch.mu", lower = 0.1, upper = 0.2 }]\n'
    )
    measured = tmp_path / "measured.csv"
    measured.write_text("punch.stroke,punch.force\n0.5,1\n1,2\n")
    for command in (
        ["run", str(case)],
        ["sweep", str(case), "--vary", "tools.punch.mu=0.1,0.2"],
        ["optimise", str(study)],
        ["calibrate", "curve", str(measured), "--case", str(case), "--fit", "tools.punch.mu"],
        ["calibrate", "damage", str(case), "--stroke", "1"],
    ):
        told = CliRunner().invoke(app, command)
        assert told.exit_code == 2, told.output
        assert not mark.exists(), command
    with pytest.raises(CaseError, match="--run-user-code"):
        presswork.run(read_case(case), tmp_path / "out")
    assert not mark.exists()


def test_check_describes_a_library_that_may_not_run(foreign):
    case, mark = foreign
    told = CliRunner().invoke(app, ["check", str(case)])
    assert told.exit_code == 0
    assert "not opened" in told.output
    assert "--run-user-code" in told.output
    assert not mark.exists()
    assert CliRunner().invoke(app, ["check", str(case), "--run-user-code"]).exit_code == 2
    assert mark.exists()


def test_a_library_may_run_once_it_is_allowed_until_it_changes(foreign):
    case, mark = foreign
    library = mark.with_name("mark.so")
    told = CliRunner().invoke(app, ["material", "allow", str(library)])
    assert told.exit_code == 0
    with pytest.raises(CaseError, match="its first call"):
        build_model(read_case(case))
    assert mark.exists()
    library.write_bytes(library.read_bytes() + b"x")
    with pytest.raises(CaseError, match="--run-user-code"):
        build_model(read_case(case))


def test_sizes_that_the_library_tells_are_held_against_the_case(tmp_path):
    source = tmp_path / "sizes.c"
    source.write_text("void umat_(void) {}\nvoid umat_sizes_(int* p, int* s) { *p = 6; *s = 2; }\n")
    library = compile_law(source)
    with pytest.raises(CaseError, match="it wants 2 state variables, not 1"):
        build(tmp_path / "a", library)
    with pytest.raises(CaseError, match="it wants 6 properties, not 7"):
        build(tmp_path / "b", library, props="[1, 2, 3, 4, 5, 6, 7]")


def test_a_source_that_cannot_be_compiled_is_refused(tmp_path):
    for name, words in {"law.txt": "ends in .f", "none.cpp": "no such file"}.items():
        with pytest.raises(CompileError, match=words):
            compile_law(tmp_path / name)
    bad = tmp_path / "bad.c"
    bad.write_text("void umat_( {}\n")
    with pytest.raises(CompileError, match="gcc refuses it"):
        compile_law(bad)
