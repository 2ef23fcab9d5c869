#!/usr/bin/env bash
# The report's page in headless Chromium. Makes a page by the smoke pipeline, or takes one: `tests/browser/run.sh [index.html]`.
#
# MAVERIC_BIN: the program that makes the page; otherwise the debug build of this checkout.
# Installs what is missing: Debian's chromium (apt-get), playwright-core and axe-core (npm ci; no browser is downloaded).
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)

# A network that fails once usually works a moment later.
retry() {
  local pause
  for pause in 3 15 60; do
    "$@" && return 0
    echo "failed, again in $pause s: $*" >&2
    sleep "$pause"
  done
  "$@"
}

chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$chromium" ]; then
  retry apt-get update -qq
  retry apt-get install -y -qq --no-install-recommends chromium
  chromium=$(command -v chromium)
fi
command -v npm >/dev/null || retry apt-get install -y -qq --no-install-recommends nodejs npm
if [ ! -d "$here/node_modules/axe-core" ] || [ ! -d "$here/node_modules/playwright-core" ]; then
  (cd "$here" && retry npm ci --no-audit --no-fund --loglevel=error)
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
page=${1:-}
if [ -z "$page" ]; then
  bin=${MAVERIC_BIN:-${CARGO_TARGET_DIR:-$root/target}/debug/maveric}
  if [ ! -x "$bin" ]; then
    echo "no program at $bin: \`cargo build\` first, or say where it is: MAVERIC_BIN=PATH $0" >&2
    exit 2
  fi
  bin=$(cd "$(dirname "$bin")" && pwd)/$(basename "$bin")
  mkdir -p "$work/study_data"
  cp -r "$root/pipelines" "$work/pipelines"
  find "$work/pipelines" -name '*.lock*' -delete
  find "$root/study_data" -mindepth 1 -maxdepth 1 ! -name generated -exec cp -r {} "$work/study_data/" \;
  echo "making a page: maveric run pipelines/smoke.toml"
  (cd "$work" && PATH="$(dirname "$bin"):$PATH" "$bin" run pipelines/smoke.toml >"$work/run.log" 2>&1) || {
    cat "$work/run.log" >&2
    exit 1
  }
  page="$work/reports/smoke/index.html"
fi
CHROMIUM="$chromium" node "$here/test.mjs" "$page" "$work"
