# SPDX-License-Identifier: Apache-2.0
"""Material laws from shared libraries with Abaqus's interface UMAT: compile a source file, open a library."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from presswork import _core, model

_FORTRAN = ("gfortran", "-shared", "-fPIC", "-O2", "-I", str(Path(__file__).parent / "abaqus"))
_INCLUDE = ("-I", str(Path(_core.__file__).parent / "include"))
_COMPILERS = {
    ".f": (*_FORTRAN, "-ffixed-line-length-none"),
    ".for": (*_FORTRAN, "-ffixed-form", "-ffixed-line-length-none"),
    ".f90": (*_FORTRAN, "-ffree-line-length-none"),
    ".c": ("gcc", "-shared", "-fPIC", "-O2"),
    ".cpp": ("g++", "-std=c++20", "-shared", "-fPIC", "-O2", "-fno-math-errno", "-fno-trapping-math", *_INCLUDE),
}


class CompileError(Exception):
    """A law that cannot be compiled; says why."""


def compile_law(source: Path, library: Path | None = None) -> Path:
    """Compile a UMAT or a law of one C++ file into a shared library; return its path.

    source: .f, .for, .f90 (gfortran), .c (gcc) or .cpp (g++). library: default: beside the source, ending in .so.
    Raises CompileError with the compiler's own words.
    """
    command = _COMPILERS.get(source.suffix.lower())
    if command is None:
        raise CompileError(f"{source}: expected a source that ends in {', '.join(_COMPILERS)}")
    if not source.is_file():
        raise CompileError(f"{source}: no such file")
    if shutil.which(command[0]) is None:
        raise CompileError(f"{source}: the compiler {command[0]} is not installed")
    library = library or source.with_suffix(".so")
    # a new file: a library that a process has open must not change under it
    library.unlink(missing_ok=True)
    done = subprocess.run([*command, str(source), "-o", str(library)], capture_output=True, text=True)
    if done.returncode != 0:
        raise CompileError(f"{source}: {command[0]} refuses it:\n{done.stderr.strip()}")
    return library


def open_umat(law: model.Umat) -> _core.Umat:
    """Open a UMAT; raises RuntimeError that says what its library lacks."""
    return _core.Umat(
        law.library,
        law.props,
        law.n_state,
        jacobian=_core.UmatJacobian[law.jacobian],
        thread_safe=law.thread_safe,
        plastic_strain=law.plastic_strain,
    )
