#!/usr/bin/env python3
"""What is left of a damaged recording, by `maveric` and by other readers, and how much of it is true.

    python tests/external/damage_table.py MAVERIC

needs `pip install mcap mcap-ros2-support rosbags`. Writes a recording of five minutes (6,000 nav_msgs/Odometry at 20 Hz,
zstd chunks), damages copies of it, and prints a table of the messages that each reader gives: in Markdown.
"""

import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

from mcap.writer import CompressionType, Writer
from mcap_ros2.reader import read_ros2_messages
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

SCHEMA = pathlib.Path(__file__).parents[2] / "crates/ingest/src/raw/mcap/schemas/odometry.txt"
MESSAGES = 6000
TOPIC = "/carla/hero/odometry"
HEAD = 9
CHUNK = 6


def odometry(i):
    """One message as plain little-endian CDR."""
    t = i / 20
    out = bytearray()

    def align(n):
        out.extend(bytes(-len(out) % n))

    def text(value):
        align(4)
        out.extend(struct.pack("<I", len(value) + 1) + value.encode() + b"\0")

    out += struct.pack("<iI", int(t), round((t % 1) * 1e9))
    text("map")
    text("hero")
    align(8)
    out += struct.pack("<7d", 25 * t + math.sin(t), 0.3 * math.sin(0.1 * t), 0, 0, 0, 0, 1)
    out += bytes(36 * 8)
    out += struct.pack("<6d", 25 + math.cos(t), 0, 0, 0, 0, 0)
    out += bytes(36 * 8)
    return b"\0\1\0\0" + bytes(out)


def record(path):
    with open(path, "wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start(profile="ros2", library="damage_table")
        schema = writer.register_schema("nav_msgs/msg/Odometry", "ros2msg", SCHEMA.read_bytes())
        channel = writer.register_channel(TOPIC, "cdr", schema)
        for i in range(MESSAGES):
            ns = i * 50_000_000
            writer.add_message(channel, log_time=ns, publish_time=ns, data=odometry(i))
        writer.finish()


def records(data):
    """Opcode, start and end of every record."""
    at = 8
    while at + HEAD < len(data) - 8:
        end = at + HEAD + struct.unpack_from("<Q", data, at + 1)[0]
        yield data[at], at, end
        at = end


def damages(data):
    chunks = [(start, end) for opcode, start, end in records(data) if opcode == CHUNK]
    first, second = chunks[0], chunks[1]
    end_of_data = max(end for _, end in chunks)

    def change(at, new):
        copy = bytearray(data)
        copy[at : at + len(new)] = new
        return bytes(copy)

    middle = (second[0] + second[1]) // 2
    account = first[0] + HEAD
    yield "none", data
    yield "end of file missing, data whole", data[:end_of_data]
    yield "cut in a chunk", data[: (chunks[2][0] + chunks[2][1]) // 2]
    yield "16 bytes flipped in a chunk", change(middle, bytes(b ^ 0xFF for b in data[middle : middle + 16]))
    yield "a chunk zeroed", change(second[0], bytes(second[1] - second[0]))
    yield "a record length of 4.6e18", change(second[0] + 1, struct.pack("<Q", 4_600_000_000_000_000_000))
    yield "a chunk's checksum wrong", change(account + 24, bytes([data[account + 24] ^ 1]))
    yield "its first 64 bytes zeroed", change(0, bytes(64))


def counted(values):
    """How many messages (time in ns, x in m) were given, how many of them changed, and what ended it."""
    found = wrong = 0
    end = ""
    try:
        for ns, x in values:
            t = ns / 1e9
            found += 1
            wrong += not abs(x - 25 * t - math.sin(t)) < 1e-6
    except Exception as error:
        end = f", then {type(error).__name__}"
    return f"{found:,}{f', {wrong:,} of them wrong' if wrong else ''}{end}"


def of_mcap_ros2(path):
    return counted((m.log_time_ns, m.ros_msg.pose.pose.position.x) for m in read_ros2_messages(str(path)))


def of_rosbags(path):
    """rosbags opens folders with a metadata file."""
    folder = path.with_suffix("")
    folder.mkdir()
    (folder / path.name).write_bytes(path.read_bytes())
    (folder / "metadata.yaml").write_text(
        f"""rosbag2_bagfile_information:
  version: 5
  storage_identifier: mcap
  duration:
    nanoseconds: 300000000000
  starting_time:
    nanoseconds_since_epoch: 0
  message_count: {MESSAGES}
  topics_with_message_count:
    - topic_metadata:
        name: {TOPIC}
        type: nav_msgs/msg/Odometry
        serialization_format: cdr
        offered_qos_profiles: ""
      message_count: {MESSAGES}
  compression_format: ""
  compression_mode: ""
  relative_file_paths:
    - {path.name}
"""
    )
    store = get_typestore(Stores.ROS2_HUMBLE)

    def values():
        with Reader(folder) as reader:
            for connection, ns, raw in reader.messages():
                yield ns, store.deserialize_cdr(raw, connection.msgtype).pose.pose.position.x

    return counted(values())


def of_maveric(program, path):
    def run(*words):
        return subprocess.run([program, *words], capture_output=True, text=True)

    out = path.with_suffix(".drives")
    strict = run("ingest", str(path), "--out", str(out)).returncode
    recovered = run("ingest", str(path), "--out", str(out), "--recover")
    summary = json.loads(run("inspect", str(path), "--format", "json").stdout)
    (log,) = [v for v in walk(summary) if isinstance(v, dict) and "channels" in v]
    found = sum(c["messages"] for c in log["channels"])
    holes = sum(len(d["spans_s"]) for d in log["damage"])
    warned = len(log["damage"])
    said = f"{found:,}; {warned} warning{'s' * (warned != 1)}, {holes} with times" if warned else f"{found:,}"
    return said, f"{strict} / {recovered.returncode}"


def walk(value):
    yield value
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else []
    for v in inner:
        yield from walk(v)


def main():
    program = sys.argv[1]
    print("| damage | maveric | exit without / with `--recover` | mcap-ros2-support | rosbags |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        whole = pathlib.Path(folder) / "whole.mcap"
        record(whole)
        for number, (name, data) in enumerate(damages(whole.read_bytes())):
            path = pathlib.Path(folder) / f"damaged{number}.mcap"
            path.write_bytes(data)
            ours, status = of_maveric(program, path)
            print(f"| {name} | {ours} | {status} | {of_mcap_ros2(path)} | {of_rosbags(path)} |", flush=True)


if __name__ == "__main__":
    main()
