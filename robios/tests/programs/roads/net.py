"""A car that a trained network steers: it sees the road part of the grey image, and says the curvature."""
import json
import struct
from operator import mul

from eye import *

SPEED, LONGEST, PERIOD = 500, 14000, 100
TOP, BOTTOM = 64, 223  # rows of the image with road


def read(name):
    """Rows and columns that the network sees; its layers: size and stride, and each filter's weights and constant."""
    with open(name, "rb") as file:
        head = json.loads(file.read(struct.unpack("<Q", file.read(8))[0]))
        data = file.read()
    sight, *words = head["__metadata__"]["architecture"].split()

    def numbers(layer, name, kind):
        begin, end = head["%d.%s" % (layer, name)]["data_offsets"]
        return struct.unpack("<%d%s" % ((end - begin) // struct.calcsize(kind), kind), data[begin:end])

    layers = []
    for layer, word in enumerate(words, 1):
        units, constants = numbers(layer, "units", "f"), numbers(layer, "constants", "f")
        whole = numbers(layer, "weights", "h")
        taps = len(whole) // len(units)
        filters = [[unit * w for w in whole[n * taps:(n + 1) * taps]] for n, unit in enumerate(units)]
        size, stride = map(int, word.split("/")[1:]) if word.startswith("conv") else (0, 1)
        layers.append((size, stride, filters, constants))
    return [int(n) for n in sight.split("x")[:2]], layers


def see(image, rows, columns):
    """Means of the road part of an image, with mean 0 and deviation 1."""
    values = []
    for y in range(rows):
        top, bottom = (TOP + n * (BOTTOM - TOP) // rows for n in (y, y + 1))
        lines = [bytes(image[row * QVGA_X:(row + 1) * QVGA_X]) for row in range(top, bottom)]
        for x in range(columns):
            left, right = (n * QVGA_X // columns for n in (x, x + 1))
            values.append(sum(sum(line[left:right]) for line in lines) / (len(lines) * (right - left)))
    mean = sum(values) / len(values)
    deviation = max((sum((v - mean) ** 2 for v in values) / len(values)) ** 0.5, 1)
    return [(v - mean) / deviation for v in values]


def run(layers, values, height, width):
    """Results of a network of one channel."""
    channels = 1
    for index, (size, stride, filters, constants) in enumerate(layers):
        if size:
            row, places = size * channels, []
            for y in range(0, height - size + 1, stride):
                for x in range(0, width - size + 1, stride):
                    start = (y * width + x) * channels
                    places.append(sum((values[start + n * width * channels:][:row] for n in range(size)), []))
            height, width = (height - size) // stride + 1, (width - size) // stride + 1
        else:
            places = [values]
        values = [sum(map(mul, weights, place), constant) for place in places for weights, constant in zip(filters, constants)]
        channels = len(filters)
        if index < len(layers) - 1:
            values = [max(v, 0) for v in values]
    return values


(height, width), layers = read("steering.safetensors")
CAMInit(QVGA)
while OSGetCount() < LONGEST:
    part = run(layers, see(CAMGetGray(), height, width), height, width)[0]
    curvature = 2 * max(-1, min(part, 1))
    VWSetSpeed(SPEED, round(SPEED / 1000 * curvature * 57.3))
    OSWait(PERIOD)
VWSetSpeed(0, 0)
