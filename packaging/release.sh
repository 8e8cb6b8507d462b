#!/usr/bin/env bash
# Builds a release into dist/, or another folder: the source archive, and from that archive the wheel of build_wheel.sh.
# packaging/release.sh [FOLDER]; PRESSWORK_ARCH=native compiles for this machine alone, to try it in a third of the time.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "${1:-$here/../dist}"
dist=$(cd "${1:-$here/../dist}" && pwd)
python=${PYTHON:-python3}
tools=$(mktemp -d)
trap 'rm -rf "$tools"' EXIT
"$python" -m venv "$tools/venv"
"$tools/venv/bin/pip" install -q build
"$tools/venv/bin/python" -m build --sdist --outdir "$tools/source" "$here/.."
cp "$tools"/source/*.tar.gz "$dist"
"$here/build_wheel.sh" "$tools"/source/*.tar.gz "$dist"
