"""Reads a bag of ROS 2 that roverlab exports, and has roverlab import one, both by the public package rosbags.

Usage: ros_bag.py ROVERLAB RECORDING.mcap FOLDER

All values are compared with those of the recording, which the public reader of MCAP files decodes. Ends with status 0 if
all agree.
"""

import json
import math
import pathlib
import shutil
import subprocess
import sys
from collections import defaultdict

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)


def fail(message):
    sys.exit(f"interop: {message}")


def expect(found, expected, what):
    if found != expected:
        fail(f"{what}: found {found!r}; expected {expected!r}")


def near(found, expected, what, tolerance):
    same = found == expected or abs(found - expected) <= tolerance * max(1.0, abs(expected))
    if not same:
        fail(f"{what}: found {found!r}; expected {expected!r}")


def heading(quaternion):
    return 2.0 * math.atan2(quaternion.z, quaternion.w)


def recorded(file):
    """Messages of a recording for viewers, by topic: times (ns) and contents."""
    messages = defaultdict(list)
    with open(file, "rb") as source:
        reader = make_reader(source, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            messages[channel.topic].append((message.log_time, decoded))
    return messages


def bagged(file):
    """Messages of a bag by topic; their definitions must be the published ones."""
    messages = defaultdict(list)
    with Reader(file) as reader:
        for connection in reader.connections:
            text = connection.msgdef.data
            for name, (_, fields) in get_types_from_msg(text, connection.msgtype).items():
                published = STORE.fielddefs[name][1]
                expect([(field[0], field[1]) for field in fields], [(field[0], field[1]) for field in published], name)
        for connection, time, data in reader.messages():
            messages[connection.topic].append((time, connection, STORE.deserialize_cdr(data, connection.msgtype)))
    return messages


def compare(ours, theirs):
    """Compares the messages of a bag with those of a recording. Returns how many values agree."""
    values = 0
    for topic, name in (("/robot1/lidar", "/scan"), ("/robot1/odometry", "/odom"), ("/robot1/camera", "/camera/image_raw")):
        expect(len(theirs[name]), len(ours[topic]), name)
        for (time, own), (other_time, _, other) in zip(ours[topic], theirs[name]):
            expect(other_time, time, f"time on {name}")
            expect(other.header.stamp.sec * 10**9 + other.header.stamp.nanosec, time, f"stamp on {name}")
            if name == "/scan":
                expect(len(other.ranges), len(own.ranges), "beams")
                near(other.angle_min, own.start_angle, "first angle", 1e-6)
                near(other.angle_max, own.end_angle, "last angle", 1e-6)
                for one, two in zip(own.ranges, other.ranges):
                    near(float(two), one, "range", 1e-6)
                values += len(own.ranges)
            elif name == "/odom":
                pose, place = other.pose.pose, own.pose.position
                near(pose.position.x, place.x, "x", 0.0)
                near(pose.position.y, place.y, "y", 0.0)
                near(heading(pose.orientation), heading(own.pose.orientation), "heading", 1e-12)
                values += 3
            else:
                expect((other.width, other.height, bytes(other.data)), (own.width, own.height, own.data), "image")
                values += len(own.data)
    return values


def compare_recordings(one, other):
    """Compares what two recordings show of the first robot."""
    for topic in ("/robot1/lidar", "/robot1/odometry", "/robot1/camera"):
        expect(len(other[topic]), len(one[topic]), topic)
        for (time, own), (other_time, imported) in zip(one[topic], other[topic]):
            expect(other_time, time, f"time on {topic}")
            if topic.endswith("lidar"):
                for first, second in zip(own.ranges, imported.ranges, strict=True):
                    near(second, first, "range", 1e-6)
                near(imported.start_angle, own.start_angle, "first angle", 1e-6)
                near(imported.pose.position.x, own.pose.position.x, "mount", 1e-12)
            elif topic.endswith("camera"):
                expect(imported.data, own.data, "image")
            else:
                near(imported.pose.position.x, own.pose.position.x, "x", 0.0)
                near(heading(imported.pose.orientation), heading(own.pose.orientation), "heading", 1e-12)


def rewritten(messages, folder):
    """The same messages in a compressed bag that rosbags writes. Returns its file."""
    shutil.rmtree(folder, ignore_errors=True)
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        ordered = sorted((entry for entries in messages.values() for entry in entries), key=lambda entry: entry[0])
        for time, connection, message in ordered:
            if connection.topic not in connections:
                new = writer.add_connection(connection.topic, connection.msgtype, typestore=STORE)
                connections[connection.topic] = new
            data = STORE.serialize_cdr(message, connection.msgtype)
            writer.write(connections[connection.topic], time, data)
    return next(pathlib.Path(folder).glob("*.mcap"))


def main():
    roverlab, recording, folder = sys.argv[1:]
    name = pathlib.Path(recording).stem
    exported, imported = (f"{folder}/{name}-{kind}.mcap" for kind in ("bag", "imported"))
    subprocess.run([roverlab, "replay", "export", recording, "--ros2", exported], check=True, stdout=subprocess.DEVNULL)
    ours, theirs = recorded(recording), bagged(exported)
    values = compare(ours, theirs)
    for topic in ("/clock", "/tf", "/tf_static", "/map"):
        if not theirs[topic]:
            fail(f"found no {topic}")
    grid = theirs["/map"][0][2]
    expect(len(grid.data), grid.info.width * grid.info.height, "cells")
    if not {0} <= set(grid.data.tolist()) <= {0, 100}:
        fail("found a map without free cells, or with cells that are neither free nor occupied")
    bag = rewritten(theirs, f"{folder}/{name}-rosbags")
    words = [roverlab, "replay", "import", "--ros2", str(bag), "--out", imported, "--json"]
    said = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    expect(said["scans"], len(ours["/robot1/lidar"]), "scans")
    expect(said["late"], 0, "late messages")
    compare_recordings(ours, recorded(imported))
    print(f"{name}: {values} values agree in a bag, and {said['scans']} scans after their import")


main()
