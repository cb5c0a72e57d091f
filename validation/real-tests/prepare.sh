#!/usr/bin/env bash
# A Python with what the generator needs, in target/python-tests/venv (which the tests of the Python package use as well).
set -euo pipefail
cd "$(dirname "$0")/../.."
venv=target/python-tests/venv
[ -x "$venv"/bin/python ] || python3 -m venv "$venv"
"$venv"/bin/pip install --quiet --disable-pip-version-check numpy scipy pandas openpyxl pyarrow
