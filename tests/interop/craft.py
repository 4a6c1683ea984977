"""Holds two craft of the library against Fossen's Python Vehicle Simulator, their originals.

Usage: craft.py PROGRAM SIMULATOR, where PROGRAM is the binary `craft` of `tests/oracles` and SIMULATOR the folder `src` of
that program. It fails unless 5,000 steps under the autopilots, in a current, agree within 1e-6 m and rad where both
integrate alike; and prints how far the library's own integrator and that program's are apart as the step shrinks.
"""

import importlib.util
import math
import subprocess
import sys
import types

import numpy

LIMIT = 1e-6
STEPS = 5000


def load(simulator):
    """The simulator's modules without its plots, which want a display."""
    root = simulator + "/python_vehicle_simulator"
    for name, path in [("", root), (".lib", root + "/lib"), (".vehicles", root + "/vehicles")]:
        package = types.ModuleType("python_vehicle_simulator" + name)
        package.__path__ = [path]
        sys.modules[package.__name__] = package
    names = ["lib.guidance", "lib.gnc", "lib.control", "lib.actuator", "lib.mainLoop", "vehicles.remus100", "vehicles.otter"]
    modules = [importlib.import_module("python_vehicle_simulator." + name) for name in names]
    return modules[-3:]


def own(program, *arguments):
    lines = subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout
    return numpy.array([[float(number) for number in line.split()] for line in lines.splitlines()])


def apart(a, b):
    """The greatest differences of places and of angles."""
    places = numpy.abs(a[:, :3] - b[:, :3]).max()
    turns = (a[:, 3:] - b[:, 3:] + math.pi) % (2 * math.pi) - math.pi
    return places, numpy.abs(turns).max()


def main():
    program, simulator = sys.argv[1:]
    loop, remus100, otter = load(simulator)
    vehicles = {
        "remus100": lambda speed, way: remus100.remus100("depthHeadingAutopilot", 30, 50, 1525, speed, way),
        "otter": lambda speed, way: otter.otter("headingAutopilot", 100, speed, way, 200),
    }
    currents = {"remus100": (0.5, 170), "otter": (0.3, -30)}
    for name, make in vehicles.items():
        speed, way = currents[name]
        _, theirs = loop.simulate(STEPS, 0.02, make(speed, way))
        ours = own(program, name, "euler", 0.02, STEPS, speed, way)
        places, turns = apart(theirs[:, :6], ours)
        print(f"{name}: {STEPS} steps of 20 ms in a current: {places:.1e} m, {turns:.1e} rad apart")
        assert len(ours) == STEPS + 1 and max(places, turns) < LIMIT, f"more than {LIMIT}"
        for step in (0.02, 0.01, 0.005, 0.0025):
            steps = round(60 / step)
            _, theirs = loop.simulate(steps, step, make(0, 0))
            places, turns = apart(theirs[:, :6], own(program, name, "own", step, steps, 0, 0))
            print(f"{name}: our own integrator, 60 s in steps of {1000 * step:4.1f} ms: {places:.5f} m, {turns:.6f} rad apart")


main()
