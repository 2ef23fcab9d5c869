#!/bin/sh
# A study of many made-up people in twelve conditions, drives of a minute, from logs to page.
#
#   tests/external/large_study.sh PROGRAM PEOPLE [FOLDER]
#
# PROGRAM is the built `maveric`; FOLDER is not there yet. Prints what `generate` took, time and peak memory of each stage, and the size of the page.
set -eu
program=$(realpath "$1")
people=$2
folder=${3:-$(mktemp -u /tmp/large_study.XXXXXX)}

conditions=c0
for i in 1 2 3 4 5 6 7 8 9 10; do conditions="$conditions,c$i"; done
"$program" init "$folder" --synthetic --conditions "$conditions,across" >/dev/null
cd "$folder"
# Half a step of the dial from one to the next, the own style in the middle; the last one across.
awk '/^\[\[condition\]\]/ { n++ }
  /^car = / && n == 12 { print "car = { across = true }"; next }
  /^car = / && n == 6 { print "car = { dial = 0 }"; next }
  /^car = / { printf "car = { dial = \"%+.1f\" }\n", (n - 6) / 2; next }
  { print }' study.toml >study.new && mv study.new study.toml
start=$(date +%s)
"$program" generate --study2 "$people" --duration 60 >/dev/null
echo "generate: $(($(date +%s) - start)) s"
"$program" run --set duration=60 2>&1 | grep -E '^\[[0-9]+/|^error|×'
wc -c report/index.html
