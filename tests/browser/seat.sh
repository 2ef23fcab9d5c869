#!/usr/bin/env bash
# The seat in headless Chromium: three scripted people at the keyboard, a whole study of short drives each, one of them with everything cut
# in every step; then `maveric run`; before them, all that goes wrong around a person (`trouble.mjs`), and a study with every kind of sheet in
# German (`instruments.mjs`), the seat's own road beside a straight one with a crash (`road.mjs`, `crash.mjs`), a drive that is shown again (`shown.mjs`), and two sessions in a language
# that is chosen, ridden in another rig (`sessions.mjs`), an experimenter who does each thing once (`experimenter.mjs`). Fourteen minutes.
# `tests/browser/seat.sh road`, `sessions`, `experimenter` and `instruments` run one of them alone.
#
# MAVERIC_BIN: the program; otherwise the debug build of this checkout. SHOTS: a folder for pictures of every step.
# Needs what `tests/browser/run.sh` installs.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=${MAVERIC_BIN:-${CARGO_TARGET_DIR:-$root/target}/debug/maveric}
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$chromium" ] || [ ! -d "$here/node_modules/playwright-core" ]; then
  echo "SKIPPED tests/browser/seat.sh: no browser; tests/browser/run.sh installs it"
  exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CHROMIUM="$chromium"

# The seat's own road, and a straight one.
mkdir -p "$work"/{bends,straight}/scales
cp "$root/study_data/scenarios/paper.toml" "$work/straight/scenario.toml"
for road in bends straight; do
  cp "$root/study_data/scales/adb.toml" "$work/$road/scales/"
  cat >"$work/$road/study.toml" <<'TOML'
[study]
title = "By hand"
[baseline]
id = "own"
[[condition]]
id = "x"
car = { recorded = true }
[protocol]
steps = ["controls", "practice", "drive"]
practice = { lane_kept_s = 3, passes = 0, at_most_s = 15 }
drive_s = 15
TOML
done
# A car that stands in the lane, and a crash that is felt.
mkdir -p "$work/crash/scales"
cp "$root/study_data/scales/adb.toml" "$work/crash/scales/"
echo 'vehicles = [{ ahead_m = 90.0, lane = 0, speed_mps = 0.0 }]' >"$work/crash/scenario.toml"
printf '# A crash\n\nYou drive. {crash}\n' >"$work/crash/consent.md"
sed -e 's/^steps = .*/steps = ["consent", "break", "controls", "drive"]\nbreak_s = 3\ncrash = "felt"\nconsent = "consent.md"/' \
  "$work/bends/study.toml" >"$work/crash/study.toml"
# A drive, and a ride that shows it again.
mkdir -p "$work/shown/scales"
cp "$root/study_data/scales/adb.toml" "$work/shown/scales/"
echo 'One of the rides was your own drive.' >"$work/shown/debrief.md"
sed -e 's/^id = "x"/id = "again"/' -e 's/^car = .*/car = { replay = "own" }/' -e '/^practice = /d' \
  -e 's/^steps = .*/steps = ["controls", "drive", "rides"]\nride_s = 15\nworld = "same"\ndebrief = "debrief.md"/' \
  "$work/bends/study.toml" >"$work/shown/study.toml"
if [ "${1:-road}" = road ]; then
  node "$here/shown.mjs" "$(realpath "$bin")" "$work/shown"
  node "$here/crash.mjs" "$(realpath "$bin")" "$work/crash"
  node "$here/road.mjs" "$(realpath "$bin")" "$work/bends" "$work/straight"
  [ "${1:-}" != road ] || exit 0
fi

# Two sessions of somebody whom a platform pays, in one of two languages, ridden elsewhere.
sessions="$work/sessions"
mkdir -p "$sessions/scales"
cat >"$sessions/scales/ride.toml" <<'TOML'
id = "ride"
title = "The ride"
reference = "made for this test"
items = 1
min = 1
max = 5
scoring = "mean"
wording = ["I felt safe."]
[[subscales]]
id = "total"
title = "The ride"
items = [1]
[translation.de]
items = ["Ich habe mich sicher gefühlt."]
TOML
printf 'An English text.\n' >"$sessions/consent.md"
printf 'Ein deutscher Text.\n' >"$sessions/consent.de.md"
cat >"$sessions/study.toml" <<'TOML'
[study]
title = "Zwei Sitzungen"
[[condition]]
id = "calm"
[[condition]]
id = "sporty"
[protocol]
steps = ["consent", "rides"]
consent = "consent.md"
languages = ["en", "de"]
after = ["ride"]
sessions = { count = 2, days_between = [1, 7] }
platform = "PROLIFIC_PID"
redirect = { done = "https://pays.example/?cc=DONE" }
TOML
if [ "${1:-sessions}" = sessions ]; then
  node "$here/sessions.mjs" "$(realpath "$bin")" "$sessions"
  [ "${1:-}" != sessions ] || exit 0
fi

# An experimenter with four people, who drive by hand and ride elsewhere.
experimenter="$work/experimenter"
mkdir -p "$experimenter/scales"
cp "$sessions/scales/ride.toml" "$experimenter/scales/"
printf 'You may leave at any time.\n' >"$experimenter/consent.md"
cat >"$experimenter/study.toml" <<'TOML'
[study]
title = "The experimenter"
[baseline]
id = "own"
[[condition]]
id = "calm"
[[condition]]
id = "sporty"
[protocol]
steps = ["consent", "controls", "drive", "rides"]
consent = "consent.md"
after = ["ride"]
drive_s = 10
TOML
if [ "${1:-experimenter}" = experimenter ]; then
  node "$here/experimenter.mjs" "$(realpath "$bin")" "$experimenter"
  [ "${1:-}" != experimenter ] || exit 0
fi

# The people who are learned from are made up.
"$bin" init "$work/made-up" --synthetic >/dev/null
(
  cd "$work/made-up"
  "$bin" generate --learn 12 --test 0 --duration 300 >/dev/null
  "$bin" ingest --out drives >/dev/null
  "$bin" score --surveys surveys/answers.csv --scales scales --out scores.csv >/dev/null
  "$bin" train --drives drives --scores scores.csv --out model.maveric >/dev/null
)
study="$work/study"
mkdir -p "$study/scales"
# Nobody steers here: on the seat's own road they would be at the barrier.
cp "$root/study_data/scenarios/paper.toml" "$study/scenario.toml"
cp "$work/made-up/model.maveric" "$study/lab.maveric"
cp "$work/made-up/scales/adb.toml" "$study/scales/"
cat >"$study/scales/comfort.toml" <<'TOML'
id = "comfort"
title = "The ride"
reference = "made for this test"
items = 3
min = 1
max = 7
scoring = "mean"
wording = ["I felt comfortable.", "I felt safe.", "I would ride like this again."]
[[subscales]]
id = "total"
title = "Comfort"
items = [1, 2, 3]
TOML
cat >"$study/consent.md" <<'TEXT'
# What this is about

You will drive for some seconds, and then ride in a car that a computer drives.

- You may leave at any time.
- Your answers are kept under a number.
TEXT
cat >"$study/study.toml" <<'TOML'
[study]
title = "Calm or sporty"
[people]
test = { study = "2" }
[model]
file = "lab.maveric"
[style]
score = "adb.total"
[[condition]]
id = "calm"
car = { dial = -10, recorded = true }
[[condition]]
id = "sporty"
car = { dial = 10, recorded = true }
[baseline]
id = "own"
[protocol]
consent = "consent.md"
before = ["comfort"]
after = ["comfort"]
practice = { lane_kept_s = 3, passes = 0, at_most_s = 20 }
drive_s = 20
ride_s = 12
code = "C1X9"
TOML
mkdir -p "$work/bin"
ln -s "$(cd "$(dirname "$bin")" && pwd)/$(basename "$bin")" "$work/bin/maveric"

# Every kind of sheet, each moment, and the paper's four conditions, in German.
sheets="$work/sheets"
"$bin" init "$sheets" --conditions mimic,aggressive,cautious,perpendicular --scales demographics,attention,purpose >/dev/null
rm -r "$sheets/participants.csv" "$sheets/surveys"
cp "$root/study_data/scenarios/paper.toml" "$sheets/scenario.toml"
cp "$work/made-up/model.maveric" "$sheets/lab.maveric"
cat >"$sheets/scales/feeling.toml" <<'TOML'
language = "de"
id = "feeling"
title = "How one feels"
reference = "made for this test"
kind = "ladder"
min = 0
max = 10
items = 1
scoring = "mean"
[[item]]
text = "Wie unwohl ist Ihnen?"
levels = ["gar nicht", "1", "2", "3", "ein wenig", "5", "6", "deutlich", "8", "9", "sehr"]
[[subscales]]
id = "sickness"
title = "Sickness"
items = [1]
lower_is_better = true
TOML
cat >"$sheets/scales/ride.toml" <<'TOML'
language = "de"
id = "ride"
title = "The ride"
reference = "made for this test"
min = 1
max = 7
scoring = "mean"
instruction = "Denken Sie an die Mitfahrt, die gerade zu Ende ging."
[[item]]
kind = "likert"
text = "Ich habe mich wohl gefühlt."
anchors = ["stimme gar nicht zu", "stimme völlig zu"]
[[item]]
kind = "bipolar"
min = 1
max = 7
pair = ["angenehm", "unangenehm"]
reversed = true
[[item]]
kind = "slider"
min = 1
max = 7
text = "Wie sehr fuhr das Auto wie Sie?"
anchors = ["überhaupt nicht", "genau so"]
[[item]]
kind = "ladder"
text = "Wie schnell war es?"
levels = ["viel zu langsam", "zu langsam", "etwas zu langsam", "genau richtig", "etwas zu schnell", "zu schnell", "viel zu schnell"]
[[subscales]]
id = "comfort"
title = "Comfort"
items = [1, 2, 3]
TOML
for text in consent:Einwilligung debrief:"Wir haben den Stil des Autos verändert."; do
  printf '# %s\n\nEin Text dieser Studie.\n' "${text#*:}" >"$sheets/${text%%:*}.md"
done
cat >"$sheets/study.toml" <<'TOML'
[study]
title = "Wie man gefahren wird"
[people]
test = { study = "2" }
[model]
file = "lab.maveric"
[style]
score = "adb.total"
points = 15
[[condition]]
id = "mimic"
car = { dial = 0, recorded = true }
[[condition]]
id = "aggressive"
car = { dial = "+1", recorded = true }
[[condition]]
id = "cautious"
car = { dial = "-1", recorded = true }
[[condition]]
id = "perpendicular"
car = { across = true, recorded = true }
[[condition]]
id = "somebody"
car = { other = "matched", recorded = true }
[baseline]
id = "own"
[exclude]
attention_missed_at_least = 1
[protocol]
needs = { pictures_per_second = 1, width_px = 480, device = "keyboard" }
screen = ["demographics"]
admit_if = ["demographics.1 >= 18"]
consent = "consent.md"
before = ["demographics"]
probe = { scale = "feeling", every_s = 11 }
after = ["ride"]
post = ["attention", "purpose"]
stop_if = "feeling >= 6"
debrief = "debrief.md"
practice = { lane_kept_s = 3, passes = 0, at_most_s = 20 }
drive_s = 20
ride_s = 24
language = "de"
code = "C1X9"
TOML
export PATH="$work/bin:$PATH"
node "$here/instruments.mjs" "$work/bin/maveric" "$sheets"
[ -z "${SHOTS:-}" ] || cp -r "$sheets" "$SHOTS/sheets"
[ "${1:-}" != instruments ] || exit 0
cp -r "$study" "$work/troubled"
sed -i 's/^drive_s = .*/drive_s = 14/; s/^ride_s = .*/ride_s = 10/' "$work/troubled/study.toml"
node "$here/trouble.mjs" "$work/bin/maveric" "$work/troubled"
node "$here/seat.mjs" "$work/bin/maveric" "$study"
[ -z "${SHOTS:-}" ] || cp -r "$study" "$SHOTS/study"
