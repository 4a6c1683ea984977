"""Looks at a run through its port, as an app that speaks Foxglove's protocol does, with the published client of
WebSocket and the published schemas' own decoders, and compares what it is sent with a recording of the same run.

Usage: live.py ROVERLAB FILE.mcap, a recording of `roverlab distbug`. Ends with status 0 if all agree.
"""

import importlib
import json
import struct
import subprocess
import sys
from collections import Counter

from mcap.reader import make_reader
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

# Of a binary message: one byte for its kind, the number of its subscription, its time in nanoseconds.
HEADER = struct.Struct("<BIQ")
MESSAGE_DATA = 1


def fail(message):
    sys.exit(f"live: {message}")


def decoder(schema):
    name = schema.split(".")[1]
    return getattr(importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)


def look(address):
    """The messages of all of Foxglove's channels: topic, time and message."""
    seen = []
    with connect(address, subprotocols=["foxglove.websocket.v1"], max_size=None) as port:
        while (told := json.loads(port.recv(timeout=10)))["op"] != "advertise":
            pass
        channels = {c["id"]: c for c in told["channels"] if c["encoding"] == "protobuf"}
        wish = [{"id": number, "channelId": number} for number in channels]
        port.send(json.dumps({"op": "subscribe", "subscriptions": wish}))
        try:
            while True:
                data = port.recv(timeout=60)
                if isinstance(data, bytes) and data[0] == MESSAGE_DATA:
                    _, number, time = HEADER.unpack_from(data)
                    channel = channels[number]
                    message = decoder(channel["schemaName"]).FromString(data[HEADER.size:])
                    seen.append((channel["topic"], time, message))
        except ConnectionClosed:
            return seen


def main():
    roverlab, file = sys.argv[1:]
    with open(file, "rb") as source:
        scans = [decoder(schema.name).FromString(message.data)
                 for schema, _, message in make_reader(source).iter_messages(topics=["/robot1/lidar"])]

    command = [roverlab, "distbug", "--view"]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    address = run.stderr.readline().strip().removeprefix("view: http:")
    seen = look(f"ws:{address}")
    run.stderr.close()
    if run.wait() != 0:
        fail(f"the run ended with status {run.returncode}")

    counts = Counter(topic for topic, _, _ in seen)
    for topic in ("/scene", "/robot1/lidar", "/robot1/odometry", "/robot1/transforms"):
        if counts[topic] == 0:
            fail(f"found nothing on {topic}: {dict(counts)}")
    # The run may begin before all channels are subscribed to; from then on nothing is missing or another one.
    live = [message for topic, _, message in seen if topic == "/robot1/lidar"]
    for number, (found, expected) in enumerate(zip(reversed(live), reversed(scans))):
        same_angles = (found.start_angle, found.end_angle) == (expected.start_angle, expected.end_angle)
        if not same_angles or found.ranges != expected.ranges:
            fail(f"scan {number} from the end: found {found}; expected {expected}")
    if len(live) < len(scans) / 2:
        fail(f"found {len(live)} of {len(scans)} scans")
    print(f"live: {len(seen)} messages on {len(counts)} topics, {len(live)} of {len(scans)} scans as recorded")


main()
