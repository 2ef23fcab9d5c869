"""Checks the scene in recordings: that every JSON message is what its schema says, and that nothing is amiss.

Needs `pip install mcap jsonschema pymcap-cli`. Usage: python tests/external/mcap_scene.py LOG.mcap…
Logs come from `maveric simulate … --scene` or `maveric generate … --scene`. Ends with 1 if anything is wrong.
"""

import collections
import json
import shutil
import subprocess
import sys

import jsonschema
from mcap.reader import make_reader

# What a viewer must find to show cars, road, ego's frame and signals.
EXPECTED = {
    "/maveric/scene/road": "foxglove.SceneUpdate",
    "/maveric/scene/cars": "foxglove.SceneUpdate",
    "/maveric/frames": "foxglove.FrameTransform",
    "/maveric/signals": "maveric.Signals",
}


def check(path):
    faults = []
    counts = collections.Counter()
    sizes = collections.Counter()
    validators = {}
    last = {}
    types = {}
    with open(path, "rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            counts[channel.topic] += 1
            sizes[channel.topic] += len(message.data)
            types[channel.topic] = schema.name
            if message.log_time < last.get(channel.topic, 0):
                faults.append(f"{channel.topic}: goes back in time at {message.log_time}")
            last[channel.topic] = message.log_time
            if channel.message_encoding != "json":
                continue
            if schema.encoding != "jsonschema":
                faults.append(f"{channel.topic}: schema encoding {schema.encoding}")
            if schema.id not in validators:
                text = json.loads(schema.data)
                jsonschema.Draft7Validator.check_schema(text)
                validators[schema.id] = jsonschema.Draft7Validator(text)
            value = json.loads(message.data)
            for error in validators[schema.id].iter_errors(value):
                faults.append(f"{channel.topic} at {message.log_time}: {error.json_path}: {error.message}")
            stamp = value.get("timestamp")
            if stamp and stamp["sec"] * 10**9 + stamp["nsec"] != message.log_time:
                faults.append(f"{channel.topic} at {message.log_time}: its timestamp is {stamp}")
    for topic, name in EXPECTED.items():
        if types.get(topic) != name:
            faults.append(f"{topic}: {types.get(topic)}, expected {name}")
    print(path)
    for topic in sorted(counts):
        print(f"  {topic:40} {types[topic]:36} {counts[topic]:6} messages {sizes[topic] / 1e6:8.2f} MB")
    if shutil.which("pymcap-cli"):
        ran = subprocess.run(["pymcap-cli", "doctor", path], capture_output=True, text=True, check=False)
        print("  doctor:", (ran.stdout + ran.stderr).strip().replace("\n", "\n  "))
        if ran.returncode != 0:
            faults.append(f"pymcap-cli doctor ends with {ran.returncode}")
    else:
        faults.append("pymcap-cli is not installed")
    for fault in faults[:20]:
        print("  FAULT:", fault)
    print(f"  {len(faults)} faults")
    return not faults


if __name__ == "__main__":
    paths = sys.argv[1:]
    if not paths:
        sys.exit(__doc__)
    sys.exit(0 if all([check(path) for path in paths]) else 1)
