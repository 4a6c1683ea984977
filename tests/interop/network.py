"""Holds networks of the library against onnxruntime: the same weights, the same inputs.

Usage: network.py PROGRAM, where PROGRAM is the binary `network` of `tests/oracles`. It fails unless all results agree within
1e-5 of the largest one, and prints how long a run takes on one thread in both.
"""

import json
import struct
import subprocess
import sys
import tempfile
import time

import numpy
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

LIMIT = 1e-5
INPUTS = 20
NETWORKS = {
    "PilotNet": "66x200x3 conv24/5/2 conv36/5/2 conv48/5/2 conv64/3/1 conv64/3/1 dense100 dense50 dense10 dense1",
    "the one that steers": "32x80x1 conv12/5/2 conv24/5/2 conv32/3/1 dense64 dense1",
    "classes": "32x32x3 conv16/5/1 pool2 conv32/3/1 pool2 dense64 dense43",
}


def layers(text):
    """The input of an architecture, and its layers: kind and numbers."""
    first, *words = text.split()
    split = [(word.rstrip("0123456789/"), word.lstrip("abcdefghijklmnopqrstuvwxyz")) for word in words]
    return [int(n) for n in first.split("x")], [(kind, [int(n) for n in numbers.split("/")]) for kind, numbers in split]


def weights(text, random):
    """Random weights in the library's format, and as the floats that they stand for, rows first."""
    (height, width, channels), steps = layers(text)
    tensors, floats = {}, {}
    for index, (kind, numbers) in enumerate(steps, 1):
        if kind == "pool":
            height, width = height // numbers[0], width // numbers[0]
            continue
        if kind == "conv":
            filters, size, stride = numbers
            shape = (filters, size, size, channels)
            height, width, channels = (height - size) // stride + 1, (width - size) // stride + 1, filters
        else:
            shape = (numbers[0], height * width * channels)
            height, width, channels = 1, 1, numbers[0]
        whole = random.integers(-32767, 32768, shape).astype("<i2")
        units = numpy.full(shape[0], (6 / numpy.prod(shape[1:])) ** 0.5 / 32767, "<f4")
        constants = random.normal(0, 0.1, shape[0]).astype("<f4")
        tensors |= {f"{index}.weights": whole, f"{index}.units": units, f"{index}.constants": constants}
        floats[index] = (whole.astype("f4") * units.reshape(-1, *[1] * (len(shape) - 1)), constants)
    return tensors, floats


def written(text, tensors):
    """A file .safetensors."""
    head, data = {"__metadata__": {"architecture": text}}, b""
    for name, values in tensors.items():
        kind = "I16" if values.dtype == "<i2" else "F32"
        head[name] = {"dtype": kind, "shape": values.shape, "data_offsets": [len(data), len(data) + values.nbytes]}
        data += values.tobytes()
    head = json.dumps(head).encode()
    head += b" " * (-len(head) % 8)
    return struct.pack("<Q", len(head)) + head + data


def session(text, floats):
    """The same network in onnxruntime, on one thread."""
    (height, width, channels), steps = layers(text)
    nodes, constants, at = [helper.make_node("Transpose", ["input"], ["0"], perm=[0, 3, 1, 2])], [], "0"
    flat = False
    for index, (kind, numbers) in enumerate(steps, 1):
        after = f"{index}"
        if kind == "pool":
            size = numbers[0]
            nodes.append(helper.make_node("MaxPool", [at], [after], kernel_shape=[size, size], strides=[size, size]))
            at = after
            continue
        values, biases = floats[index]
        names = [f"w{index}", f"b{index}"]
        if kind == "conv":
            values = values.transpose(0, 3, 1, 2)
            nodes.append(helper.make_node("Conv", [at, *names], [after], strides=[numbers[2]] * 2))
        else:
            if not flat:
                nodes += [helper.make_node("Transpose", [at], ["rows"], perm=[0, 2, 3, 1]), helper.make_node("Flatten", ["rows"], ["flat"])]
                at, flat = "flat", True
            nodes.append(helper.make_node("Gemm", [at, *names], [after], transB=1))
        constants += [numpy_helper.from_array(numpy.ascontiguousarray(v), n) for v, n in zip((values, biases), names)]
        at = after
        if index < len(steps):
            nodes.append(helper.make_node("Relu", [at], [f"{index}r"]))
            at = f"{index}r"
    value = helper.make_tensor_value_info
    seen = value("input", TensorProto.FLOAT, [1, height, width, channels])
    results = value(at, TensorProto.FLOAT, [1, steps[-1][1][0]])
    graph = helper.make_graph(nodes, "network", [seen], [results], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    onnx.checker.check_model(model)
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])


def main(program):
    random, failed = numpy.random.default_rng(1), False
    for name, text in NETWORKS.items():
        tensors, floats = weights(text, random)
        size, _ = layers(text)
        inputs = random.normal(0, 1, (INPUTS, *size)).astype("f4")
        with tempfile.NamedTemporaryFile(suffix=".safetensors") as file:
            file.write(written(text, tensors))
            file.flush()
            ended = subprocess.run([program, file.name], input=inputs.tobytes(), capture_output=True, check=True)
        ours = numpy.array([[float(n) for n in line.split()] for line in ended.stdout.decode().splitlines()])
        peer = session(text, floats)
        theirs, times = [], []
        for picture in inputs:
            theirs.append(peer.run(None, {"input": picture[None]})[0].ravel())
        for _ in range(10):
            for picture in inputs:
                start = time.perf_counter()
                peer.run(None, {"input": picture[None]})
                times.append(time.perf_counter() - start)
        theirs = numpy.array(theirs)
        apart = numpy.abs(ours - theirs).max() / numpy.abs(theirs).max()
        failed |= not apart <= LIMIT
        took = ended.stderr.decode().strip()
        print(f"{name}: {apart:.1e} apart; {took} ms here, {1e3 * numpy.median(times):.3f} ms there")
    sys.exit(failed)


main(sys.argv[1])
