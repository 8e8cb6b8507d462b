# SPDX-License-Identifier: Apache-2.0
"""Material laws from shared libraries with Abaqus's interface UMAT: compile a source file, open a library."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from presswork import _core, model
from presswork.law.allowed import allow_library
from presswork.law.elastic_plastic import make_sheet_law
from presswork.law.history import History, list_history
from presswork.model import FloatArray

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
    """A law that cannot be compiled; the message holds the reason."""


def compile_law(source: Path, library: Path | None = None) -> Path:
    """Compile a UMAT or a law of one C++ file into a shared library; return its path.

    source: .f, .for, .f90 (gfortran), .c (gcc) or .cpp (g++). library: default: beside the source, ending in .so.
    It may run in cases of this user from then on (law/allowed.py). Raises CompileError with the compiler's own words.
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
    with suppress(OSError):  # no home to write to: --run-user-code allows it
        allow_library(library)
    return library


def open_umat(law: model.Umat) -> _core.Umat:
    """Open a UMAT; raises RuntimeError that names what its library lacks."""
    if law.library == model.GTN:
        return _core.Umat.make_gtn(law.props)
    return _core.Umat(
        law.library,
        law.props,
        law.n_state,
        jacobian=_core.UmatJacobian[law.jacobian],
        thread_safe=law.thread_safe,
        plastic_strain=law.plastic_strain,
    )


@dataclass(frozen=True)
class SheetUmat:
    """A UMAT in plane stress, as shells take it, with the elastic constants of its first tangent [MPa]."""

    umat: _core.Umat
    young: float
    poisson: float
    yield_stress: float
    """Yield stress that the case states; 0 where it states none."""


SheetLaw = _core.SheetLaw | SheetUmat


def list_sheet_history(law: SheetLaw) -> History:
    """Return what a layer of a shell keeps for its law behind its stress."""
    return list_history(law.umat if isinstance(law, SheetUmat) else law, 3)


def open_sheet_law(material: model.Material) -> SheetLaw:
    """Make the law of a material in plane stress, or open its UMAT.

    Raises RuntimeError that names what the library lacks.
    """
    if material.umat is None:
        return make_sheet_law(material)
    return SheetUmat(open_umat(material.umat), material.young, material.poisson, material.umat.yield_stress)


def first_yield_stress(law: SheetLaw) -> float:
    """Return the flow stress of a sheet that has not flowed yet, at rest [MPa]."""
    return law.yield_stress if isinstance(law, SheetUmat) else float(law.flow_stress(np.zeros(1))[0][0])


def elastic_constants(tangent: FloatArray) -> tuple[float, float]:
    """Return Young's modulus and Poisson's ratio of an isotropic tangent (3, 3) in plane stress, (4, 4) or (6, 6)."""
    if len(tangent) == 3:
        poisson = float(tangent[0, 1] / tangent[0, 0])
        return float(tangent[0, 0]) * (1.0 - poisson**2), poisson
    shear, bulk = float(tangent[3, 3]), float(tangent[:3, :3].mean())
    young = 9.0 * bulk * shear / (3.0 * bulk + shear)
    return young, young / (2.0 * shear) - 1.0


STATUS_MESSAGES = {
    _core.LawStatus.smaller: "the UMAT asks for a smaller increment (PNEWDT)",
    _core.LawStatus.not_finite: "the UMAT gives a stress or tangent that is not a number",
    _core.LawStatus.overrun: "the UMAT writes beyond its state variables",
    _core.LawStatus.stopped: "the UMAT stops the analysis (XIT)",
    _core.LawStatus.components: "the UMAT writes more stresses than NTENS",
    _core.LawStatus.no_stress: "the law found no stress on the yield surface",
}
"""What is reported of a law that failed."""
_SMALL = 1e-6
"""Strain of the trial, far below yield of any metal."""
_LONGEST = 60.0
"""Seconds that a trial may take; a first call takes microseconds."""


@dataclass(frozen=True)
class Trial:
    """What a library does at its first calls."""

    fault: str = ""
    """Why it cannot be opened, or how it ended its process; empty if it came back."""
    status: str = "done"
    """Name of the LawStatus of its last call."""
    tangent: tuple[tuple[float, ...], ...] = ()
    """DDSDDE at a strain of one millionth, shape (components, components) [MPa]."""


def try_umat(law: model.Umat, components: int) -> Trial:
    """Open a library and call it, in a process of its own: whatever it does there ends neither this one nor waits.

    components: NTENS: 3 of shells, 4 of solids in the plane, 6 of solids in space.
    The library's own constructors and its routine run: try only what may run.
    """
    read, write = os.pipe()
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-m", "presswork.law.umat", str(write)],
            input=json.dumps([asdict(law), components]), text=True, pass_fds=(write,), timeout=_LONGEST,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(write)
        write = -1
        with os.fdopen(read, closefd=False) as answer:
            text = answer.read()
    except subprocess.TimeoutExpired:
        return Trial(f"its first calls do not come back within {_LONGEST:g} s")
    finally:
        os.close(read)
        if write >= 0:
            os.close(write)
    if done.returncode < 0:
        number = -done.returncode
        name = signal.Signals(number).name if number in set(signal.Signals) else str(number)
        return Trial(
            f"opening or calling it ends the process by {name}: the file is cut short, or its code is at fault"
        )
    if done.returncode or not text:
        return Trial(f"its first call ends the process with status {done.returncode}")
    trial = json.loads(text)
    return Trial(trial["fault"], trial["status"], tuple(map(tuple, trial["tangent"])))


def _answer_trial(law: model.Umat, components: int) -> Trial:
    """Open a library and call it twice, in this process."""
    try:
        compiled = open_umat(law)
    except RuntimeError as error:
        return Trial(str(error))
    rest: FloatArray = np.zeros(components)
    status, _, state, tangent = compiled.update(rest, rest, np.zeros(law.n_state), 1.0)
    if status == _core.LawStatus.done:  # once more with a strain: a first call may only set up state variables
        strain = np.zeros(components)
        strain[0] = _SMALL
        status, _, _, tangent = compiled.update(strain, rest, state, 1.0)
    return Trial("", status.name, tuple(map(tuple, tangent.tolist())))


if __name__ == "__main__":
    data, size = json.load(sys.stdin)
    trial = _answer_trial(model.Umat(**{**data, "props": tuple(data["props"])}), size)
    with os.fdopen(int(sys.argv[1]), "w") as answer:
        json.dump(asdict(trial), answer)
