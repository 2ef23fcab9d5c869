#!/bin/sh
# Cuts Source Sans 3 to the signs the figures use and renames it "Maveric Sans".
# Needs npm, Python 3 with fonttools and brotli. Run in this folder.
set -eu
npm pack --silent source-sans@3.52.0
tar xzf source-sans-3.52.0.tgz
signs='U+0020-007E,U+00A0-017F,U+02C6,U+02DC,U+0302,U+0370-03FF,U+2010-2015,U+2018-201E,U+2020-2022,U+2026,U+2030,U+2032,U+2033,U+2070-208E,U+20AC,U+2190-2199,U+2202,U+2206,U+220F,U+2211,U+2212,U+2215,U+221A,U+221E,U+222B,U+2248,U+2260,U+2264,U+2265,U+25A0,U+25A1,U+25B2,U+25B3,U+25BC,U+25BD,U+25C6,U+25C7,U+25CB,U+25CF'
for face in Regular It Semibold; do
  case $face in It) out=Italic ;; *) out=$face ;; esac
  pyftsubset "package/TTF/SourceSans3-$face.ttf" --unicodes="$signs" --no-hinting \
    --layout-features=kern,mark,mkmk,ccmp --name-IDs='*' --output-file="cut-$out.ttf"
  python3 - "$out" <<'PY'
import sys
from fontTools.ttLib import TTFont
face = sys.argv[1]
font = TTFont(f"cut-{face}.ttf")
style = {"Regular": "Regular", "Italic": "Italic", "Semibold": "SemiBold"}[face]
names = {1: "Maveric Sans", 2: style, 3: f"MavericSans-{style}", 4: f"Maveric Sans {style}", 6: f"MavericSans-{style}"}
for record in list(font["name"].names):
    if record.nameID in names:
        record.string = names[record.nameID]
    elif record.nameID not in (0, 13, 14):
        font["name"].names.remove(record)
font["head"].modified = font["head"].created
font.recalcTimestamp = False
font.save(f"MavericSans-{face}.ttf")
font.flavor = "woff2"
font.save(f"MavericSans-{face}.woff2")
PY
  rm "cut-$out.ttf"
done
cp package/LICENSE.md OFL.txt
rm -r package source-sans-3.52.0.tgz
