"""Reads a recording with the public MCAP reader and Protobuf decoder, and compares it with what roverlab says of it.

Usage: read_recording.py FILE.mcap INFO.json TABLE.csv

INFO is what `replay info --json` prints, TABLE what `replay export --csv` writes. Ends with status 0 if all agree.
"""

import csv
import importlib
import json
import math
import sys
from collections import Counter, defaultdict

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory


def fail(message):
    sys.exit(f"interop: {message}")


def expect(found, expected, what):
    if found != expected:
        fail(f"{what}: found {found!r}; expected {expected!r}")


def check_schema(schema):
    """The description of a Foxglove message, and of all it consists of, is the published one."""
    files = FileDescriptorSet.FromString(schema.data).file
    checked = 0
    for file in files:
        if file.package != "foxglove":
            continue
        for message in file.message_type:
            module = importlib.import_module(f"foxglove_schemas_protobuf.{message.name}_pb2")
            published = module.DESCRIPTOR.message_types_by_name[message.name]
            ours = {(f.name, f.number, f.type, f.label == f.LABEL_REPEATED) for f in message.field}
            theirs = {(f.name, f.number, f.type, f.is_repeated) for f in published.fields}
            expect(ours, theirs, f"fields of {message.name}")
            for enum in message.enum_type:
                values = {value.name: value.number for value in enum.value}
                expect(values, dict((v.name, v.number) for v in published.enum_types_by_name[enum.name].values), enum.name)
            checked += 1
    return checked


def seconds(stamp):
    return stamp.seconds + stamp.nanos * 1e-9


def numbers(text):
    """The numbers of a list in words, in which they come first."""
    return [float(word) for word in text.split(", ")] if text else []


def heading(quaternion):
    return 2.0 * math.atan2(quaternion.z, quaternion.w)


def main():
    file, info_file, table_file = sys.argv[1:]
    with open(info_file, encoding="utf-8") as source:
        info = json.load(source)
    with open(table_file, newline="", encoding="utf-8") as source:
        rows = list(csv.DictReader(source))

    with open(file, "rb") as source:
        # Every record, with all checksums.
        for _ in StreamReader(source, validate_crcs=True).records:
            pass

    counts = Counter()
    messages = defaultdict(list)
    schemas = {}
    with open(file, "rb") as source:
        reader = make_reader(source, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            counts[channel.topic] += 1
            messages[channel.topic].append((message, decoded))
            schemas[schema.name] = schema
        summary = reader.get_summary()
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
        attachments = {record.name: record.data for record in reader.iter_attachments()}

    expect(dict(counts), info["topics"], "messages by topic")
    expect(sum(counts.values()), summary.statistics.message_count, "messages")
    expect(summary.statistics.chunk_count, info["chunks"], "chunks")
    expect(metadata["roverlab"]["program"], info["program"], "program")
    expect({name: len(data) for name, data in attachments.items()},
           {entry["name"]: entry["bytes"] for entry in info["attachments"]}, "attachments")
    checked = sum(check_schema(schema) for schema in schemas.values())
    if checked == 0:
        fail("found no Foxglove schema")

    for robot in range(1, info["robots"] + 1):
        for kind in ("calls", "truth"):
            ours = [row for row in rows if row["robot"] == str(robot) and row["topic"] == kind]
            theirs = messages[f"/robot{robot}/{kind}"]
            expect(len(theirs), len(ours), f"/robot{robot}/{kind}")
            for row, (message, call) in zip(ours, theirs):
                expect(call.method, row["method"], "method")
                expect(message.log_time / 1e9, float(row["time_s"]), "time")
                expect(call.error.message, row["error"], "error")
                for values, text in ((call.arguments, row["arguments"]), (call.result, row["result"])):
                    plain = not values.texts and not values.data
                    if plain:
                        expect(list(values.numbers) + [float(i) for i in values.integers], numbers(text), row["method"])

        calls = [call for _, call in messages[f"/robot{robot}/calls"]]
        good = [call for call in calls if not call.error.kind]
        poses = [call.result.numbers for call in good if call.method == "pose"]
        shown = [decoded for _, decoded in messages[f"/robot{robot}/odometry"]]
        expect([(s.pose.position.x, s.pose.position.y) for s in shown], [(p[0], p[1]) for p in poses], "odometry")
        for s, p in zip(shown, poses):
            if abs(math.remainder(heading(s.pose.orientation) - p[2], math.tau)) > 1e-9:
                fail(f"heading: found {heading(s.pose.orientation)}; expected {p[2]}")
        heads = [call.result.numbers for call in good if call.method == "scan_into"]
        scans = messages[f"/robot{robot}/lidar"]
        expect(len(scans), len(heads), "scans")
        for (message, scan), head in zip(scans, heads):
            expect(scan.start_angle, head[0], "first beam")
            expect(abs(seconds(scan.timestamp) - message.log_time / 1e9) < 1e-9, True, "time of a scan")
            step = (scan.end_angle - scan.start_angle) / max(1, len(scan.ranges) - 1)
            if len(scan.ranges) > 1 and abs(step - head[1]) > 1e-9:
                fail(f"angle between beams: found {step}; expected {head[1]}")
            if not all(r > 0.0 for r in scan.ranges):
                fail("a range that is not positive")

    total = sum(counts.values())
    print(f"interop: {total} messages on {len(counts)} topics, {checked} Foxglove messages as published")


main()
