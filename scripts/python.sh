#!/usr/bin/env bash
# The Python package: lints, builds and installs it into a virtual environment of its own, and runs its tests (pytest, the notebook among them).
# Needs Python 3.10 or later with venv, and the network for what pip installs. Nothing of it is needed for `.ci/run`. Arguments go to pytest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

python="${PYTHON:-python3}"
if ! "$python" -c 'import sys, venv; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
    echo "skipped: $python is not there, older than 3.10, or without venv"
    exit 0
fi
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-target}/python"
environment="$CARGO_TARGET_DIR/venv"
[ -x "$environment/bin/python" ] || "$python" -m venv "$environment"
environment="$(cd "$environment" && pwd)"
export PYO3_PYTHON="$environment/bin/python"

cargo fmt --manifest-path crates/python/Cargo.toml --check
cargo clippy --quiet --locked --manifest-path crates/python/Cargo.toml -- -D warnings
"$environment/bin/pip" install --quiet '.[test]'
"$environment/bin/python" -m pytest --quiet "$@"
