#!/bin/sh
# The same pipeline of short stages for three programs: this one, DVC 3 and Snakemake 9.
#
#   python3 -m venv VENV && VENV/bin/pip install 'dvc>=3,<4' 'snakemake>=9,<10'
#   tests/external/compare_with_others.sh PROGRAM VENV [STAGES [FOLDER [NAMES]]]
#
# PROGRAM is the built `maveric`; NAMES are those to run, all when not given. Every stage is `cp` of one small file, in chains of ten. Prints seconds: the
# whole first run, one job at a time and two; a run with nothing to do; one source edited.
set -eu
program=$(realpath "$1")
bin=$(realpath "$2")/bin
stages=${3:-1000}
work=$(realpath "${4:-$(mktemp -d /tmp/compare.XXXXXX)}")
names=${5:-maveric snakemake dvc}
export DVC_NO_ANALYTICS=true PATH="$bin:$PATH"

write() {
  mkdir -p "$work/$1/out" && cd "$work/$1"
  for chain in $(seq 0 $((stages / 10 - 1))); do echo "source $chain" >"source$chain.txt"; done
}
each() { # calls $1 with the number of each stage and the file that it copies
  i=0
  while [ $i -lt "$stages" ]; do
    if [ $((i % 10)) = 0 ]; then from="source$((i / 10)).txt"; else from="out/$((i - 1)).txt"; fi
    $1 $i "$from"
    i=$((i + 1))
  done
}
in_maveric() { printf "[[stage]]\nname = 's%s'\ncmd = ['cp', '%s', 'out/%s.txt']\ninputs = ['%s']\noutputs = ['out/%s.txt']\n" "$1" "$2" "$1" "$2" "$1"; }
in_dvc() { printf "  s%s:\n    cmd: cp %s out/%s.txt\n    deps: [%s]\n    outs: [out/%s.txt]\n" "$1" "$2" "$1" "$2" "$1"; }
in_snakemake() { printf "rule s%s:\n    input: '%s'\n    output: 'out/%s.txt'\n    shell: 'cp {input} {output}'\n" "$1" "$2" "$1"; }

write maveric
{ echo "name = 'p'"; each in_maveric; } >p.toml
write dvc
{ echo "stages:"; each in_dvc; } >dvc.yaml
git init -q . && dvc init -q
write snakemake
{ echo "rule all:"; echo "    input:"; each echo | while read -r i _; do echo "        'out/$i.txt',"; done; each in_snakemake; } >Snakefile

seconds() {
  start=$(date +%s.%N)
  "$@" >"$work/last.log" 2>&1 || { tail -n 5 "$work/last.log"; echo "failed: $*" >&2; }
  echo "$start $(date +%s.%N)" | awk '{printf "%.2f", $2 - $1}'
}
least() { # the least of three
  a=$(seconds "$@"); b=$(seconds "$@"); c=$(seconds "$@")
  printf '%s\n%s\n%s\n' "$a" "$b" "$c" | sort -n | head -n 1
}
fresh() { rm -rf out/* p.lock* .logs .snakemake dvc.lock .dvc/cache .dvc/tmp; mkdir -p out; }

printf '%s stages of cp; seconds\n%-12s %12s %12s %12s %12s\n' "$stages" program "first, -j 1" "first, -j 2" "nothing" "one edited"
row() { # name, then the command for one job; two jobs in $two
  name=$1; shift
  cd "$work/$name"
  fresh; one=$(seconds "$@")
  if [ -n "$two" ]; then fresh; second=$(seconds $two); else second=-; fi
  none=$(least "$@")
  echo "edited $(date +%s%N)" >source0.txt
  edited=$(seconds "$@")
  printf '%-12s %12s %12s %12s %12s\n' "$name" "$one" "$second" "$none" "$edited"
}
for name in $names; do
  case $name in
    maveric) two="$program run p.toml -j 2"; row maveric "$program" run p.toml ;;
    snakemake) two="snakemake -j 2 -q all"; row snakemake snakemake -j 1 -q all ;;
    dvc) two=; row dvc dvc repro -q ;; # it has no -j
  esac
done
