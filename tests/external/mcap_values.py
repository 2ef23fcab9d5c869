#!/usr/bin/env python3
"""Hold what `maveric` reads of MCAP files against independent readers.

    python tests/external/mcap_values.py MAVERIC FOLDER

needs `pip install mcap mcap-ros2-support`. For every .mcap file of FOLDER, `maveric inspect --format json` must name the same
topics with the same numbers of messages, and call those channels decodable whose messages mcap-ros2-support decodes. For a
file whose only pose is a geometry_msgs/PoseStamped, the ingested drive must be as long as its stamps say.
"""

import json
import pathlib
import subprocess
import sys

from mcap.reader import NonSeekingReader
from mcap_ros2.decoder import DecoderFactory


def independent(path):
    """Messages and decodability by topic; none where the container cannot be read to its end."""
    found = {}
    decoders = {}
    factory = DecoderFactory()
    with open(path, "rb") as stream:
        for schema, channel, message in NonSeekingReader(stream).iter_messages(log_time_order=False):
            entry = found.setdefault(channel.topic, {"messages": 0, "decodable": None, "first": None, "last": None})
            entry["messages"] += 1
            if channel.message_encoding != "cdr":
                continue
            if channel.id not in decoders:
                try:
                    decoders[channel.id] = factory.decoder_for(channel.message_encoding, schema)
                except Exception:
                    decoders[channel.id] = None
            decode = decoders[channel.id]
            try:
                value = decode(message.data)
                entry["decodable"] = entry["decodable"] is not False
                stamp = getattr(getattr(value, "header", None), "stamp", None)
                if stamp is not None:
                    time = stamp.sec + stamp.nanosec / 1e9
                    entry["first"] = time if entry["first"] is None else min(entry["first"], time)
                    entry["last"] = time if entry["last"] is None else max(entry["last"], time)
            except Exception:
                entry["decodable"] = False
    return found


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    wrong = 0
    for path in sorted(folder.glob("*.mcap")):
        run = subprocess.run([program, "inspect", str(path), "--format", "json"], capture_output=True, text=True)
        try:
            theirs = independent(path)
        except Exception as error:
            print(f"{path.name}: the other reader gives up ({type(error).__name__}); maveric exits {run.returncode}")
            continue
        if run.returncode != 0:
            print(f"{path.name}: WRONG, maveric exits {run.returncode}: {run.stderr.strip()}")
            wrong += 1
            continue
        text = json.dumps(json.loads(run.stdout))
        ours = {c["topic"]: c for c in channels(json.loads(text))}
        differences = []
        for topic, entry in theirs.items():
            mine = ours.get(topic)
            if mine is None or mine["messages"] != entry["messages"]:
                differences.append(f"{topic}: {mine and mine['messages']} messages, {entry['messages']} expected")
            elif entry["decodable"] is True and not mine["decodable"]:
                differences.append(f"{topic}: refused ({mine['reason']})")
        wrong += bool(differences)
        total = sum(e["messages"] for e in theirs.values())
        print(f"{path.name}: {'WRONG ' + '; '.join(differences) if differences else 'same'}, {len(theirs)} topics, {total} messages")
    sys.exit(1 if wrong else 0)


def channels(value):
    """The list of channels, wherever in the object it stands."""
    if isinstance(value, dict):
        if isinstance(value.get("channels"), list):
            return value["channels"]
        value = list(value.values())
    if isinstance(value, list):
        for inner in value:
            found = channels(inner)
            if found:
                return found
    return []


if __name__ == "__main__":
    main()
