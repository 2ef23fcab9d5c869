#!/usr/bin/env bash
# Builds the wheel and tests it in a fresh virtual environment: pip install of one file, the command, types, every reference case.
#
# usage: tools/wheel.sh [--quick] [OUT]
#   --quick   built in the development profile: for the tests, not to be handed out (the gate)
#   OUT       folder for the wheel, target/wheels when not given
#
# Needs Python 3.10 or newer and the network (or a pip cache) for maturin and the libraries that the tests compare with.
set -euo pipefail
cd "$(dirname "$0")/.."
profile=--release
[ "${1:-}" = --quick ] && { profile=; shift; }
mkdir -p "${1:-target/wheels}"
out=$(cd "${1:-target/wheels}" && pwd)
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "SKIPPED tools/wheel.sh: needs Python 3.10"; exit 0; }
# Debian keeps what makes environments in a package of its own.
python3 -c 'import ensurepip, venv' 2>/dev/null || { apt-get update -qq && apt-get install -y -qq --no-install-recommends python3-venv; }
bin=$(python3 -c 'import os; print("Scripts" if os.name == "nt" else "bin")')
python3 -m venv "$here/build"
"$here/build/$bin/pip" install -q "maturin>=1.9,<2"
rm -f "$out"/maveric-*.whl
"$here/build/$bin/maturin" build $profile --locked -q -m crates/python/Cargo.toml -o "$out"
wheel=$(ls "$out"/maveric-*.whl)
size=$(wc -c < "$wheel")
echo "$wheel: $((size / 1000)) kB"
[ -z "$profile" ] || [ "$size" -lt 25000000 ] || { echo "the wheel is larger than 25 MB"; exit 1; }

python3 -m venv "$here/use"
"$here/use/$bin/pip" install -q "$wheel[test]"
# Away from the checkout, so that what is imported is what was installed.
cases=$PWD/crates/stats/tests/oracle
tests=$PWD/crates/python/tests
cd "$here"
use/$bin/maveric --version
MAVERIC_CASES=$cases use/$bin/python -m pytest -q -p no:cacheprovider --import-mode=importlib "$tests"
use/$bin/python -m pytest -q -p no:cacheprovider --doctest-modules --pyargs maveric
use/$bin/python -m mypy --strict -p maveric
use/$bin/python -m mypy.stubtest maveric._native --ignore-disjoint-bases
