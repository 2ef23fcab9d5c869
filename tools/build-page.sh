#!/usr/bin/env bash
# Builds the seat's page into crates/seat/page/built: simulator and model as WebAssembly, the script bundled.
#
# usage: tools/build-page.sh
#
# Needs Node with npm, `rustup target add wasm32-unknown-unknown`, and `wasm-bindgen` of the version in Cargo.lock
# (`cargo install wasm-bindgen-cli --no-default-features --version …`). What is built is committed: a Rust toolchain alone builds the program.
set -euo pipefail
cd "$(dirname "$0")/.."
page=crates/seat/page
version=$(sed -n '/^name = "wasm-bindgen"$/{n;s/version = "\(.*\)"/\1/p}' Cargo.lock)
if [ "$(wasm-bindgen --version 2>/dev/null)" != "wasm-bindgen $version" ]; then
  echo "needs wasm-bindgen $version: cargo install wasm-bindgen-cli --no-default-features --version $version" >&2
  exit 1
fi
# What is built names no folder of the machine that built it.
export RUSTFLAGS="--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}/registry/src= --remap-path-prefix=$PWD= ${RUSTFLAGS:-}"
cargo build --release --locked --lib --target wasm32-unknown-unknown -p maveric-seat-page
wasm-bindgen --target web --out-dir "$page/built" --out-name seat \
  "${CARGO_TARGET_DIR:-target}/wasm32-unknown-unknown/release/maveric_seat_page.wasm"
mv "$page/built/seat_bg.wasm" "$page/built/seat.wasm"
rm "$page/built/seat_bg.wasm.d.ts"
cd "$page"
[ -d node_modules/three ] || npm ci --no-audit --no-fund --loglevel=error
npx tsc -p .
npx esbuild src/main.ts --bundle --minify --format=esm --target=es2022 --legal-comments=eof --outfile=built/page.js --log-level=warning
npx esbuild src/sheet_page.ts --bundle --minify --format=iife --target=es2022 --legal-comments=eof --outfile=built/sheet.js --log-level=warning
cp src/index.html src/page.css built/
# What it was made from: a test holds this against the sources.
cat $(ls src/* package-lock.json tsconfig.json ../../seat-page/src/*.rs | LC_ALL=C sort) | sha256sum | cut -d' ' -f1 >built/sources.sha256
ls -l built
