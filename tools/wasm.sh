#!/usr/bin/env bash
# Compiles for WebAssembly what a web page can use: floors 1 to 4 but `pipeline` (processes, locks), `ingest` and `report` (files, fonts).
#
# usage: tools/wasm.sh
#
# The standard library for the target comes from `rustup target add`. Where it is neither installed nor to be downloaded, the step is
# skipped by its name. A compiler that brings its own (RUSTC, CARGO_UNSTABLE_BUILD_STD) is taken as it is.
set -euo pipefail
cd "$(dirname "$0")/.."
target=wasm32-unknown-unknown
crates=(domain stats laws measures model simulator participants steering following analysis seat-page)

have() { [ -n "${CARGO_UNSTABLE_BUILD_STD:-}" ] || rustup target list --installed | grep -qx "$target"; }
if ! have && ! timeout 120 rustup target add "$target"; then
  echo "SKIPPED tools/wasm.sh: $target is not installed and cannot be downloaded"
  exit 0
fi
cargo build --lib --locked --target "$target" "${crates[@]/#/--package=maveric-}"
