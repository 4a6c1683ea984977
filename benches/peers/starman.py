#!/usr/bin/env python3
"""The walking robot's physics beside MuJoCo's, with the same sizes, masses and gaits of random servo positions.

    python3 -m venv venv && venv/bin/pip install mujoco
    venv/bin/python benches/peers/starman.py

Both run in one thread, in turn, for ten simulated seconds a gait. The processor's time counts, not the clock's, and of
the rounds the median.
"""

import math
import pathlib
import random
import resource
import statistics
import subprocess
import time

import mujoco

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ["cargo", "build", "--release", "-p", "roverlab-cli"]
PROGRAM = ROOT / "target/release/roverlab"

ROUNDS = 7
GAITS = 50
SECONDS = 10.0
OUR_STEP = 0.010
LIMBS = 5
BODY_RADIUS, LIMB_LENGTH, LIMB_RADIUS = 0.060, 0.090, 0.010
BETWEEN_CONTROL_POINTS = 0.2

MODEL = """
<mujoco>
  <option timestep="{step}" integrator="implicitfast"/>
  <default><geom friction="0.5" contype="2" conaffinity="1"/></default>
  <worldbody>
    <geom type="plane" size="5 5 0.1" contype="1" conaffinity="2"/>
    <body pos="0 0 {height}">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>
      <geom type="sphere" size="{radius}" mass="0.6"/>
      {limbs}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
</mujoco>
"""

LIMB = """
<body pos="{x} 0 {z}">
  <joint name="hinge{i}" type="hinge" axis="0 -1 0" range="-30 30" limited="true" damping="0.01" armature="0.0005"/>
  <geom type="capsule" fromto="0 0 0 {dx} 0 {dz}" size="{radius}" mass="0.08"/>
</body>
"""

SERVO = '<position joint="hinge{i}" kp="5" kv="0.1" forcerange="-2 2"/>'


def limb(i):
    angle = math.pi / 2 - 2 * math.pi * i / LIMBS
    cos, sin = math.cos(angle), math.sin(angle)
    return LIMB.format(i=i, x=BODY_RADIUS * cos, z=BODY_RADIUS * sin, dx=LIMB_LENGTH * cos, dz=LIMB_LENGTH * sin,
                       radius=LIMB_RADIUS)


def model(step):
    height = (BODY_RADIUS + LIMB_LENGTH) * math.cos(math.pi / LIMBS) + LIMB_RADIUS
    text = MODEL.format(step=step, height=height, radius=BODY_RADIUS, limbs="".join(limb(i) for i in range(LIMBS)),
                        servos="".join(SERVO.format(i=i) for i in range(LIMBS)))
    return mujoco.MjModel.from_xml_string(text)


def mujoco_step(step):
    """Microseconds a step."""
    parts, data = model(step), None
    steps = round(BETWEEN_CONTROL_POINTS / step)
    source = random.Random(1)
    begin = time.process_time()
    for _ in range(GAITS):
        data = mujoco.MjData(parts)
        for _ in range(round(SECONDS / BETWEEN_CONTROL_POINTS)):
            data.ctrl[:] = [math.radians(source.uniform(-30, 30)) for _ in range(LIMBS)]
            mujoco.mj_step(parts, data, steps)
    return 1e6 * (time.process_time() - begin) / (GAITS * SECONDS / step)


def our_step():
    """Microseconds a step, with all that a run does besides."""
    command = [PROGRAM, "starman", "--json", "--timing", "--threads", "1", "--population", str(GAITS), "--generations", "1",
               "--init", "uniform", "--seconds", str(SECONDS)]
    begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begin
    return 1e6 * seconds / (GAITS * SECONDS / OUR_STEP)


def main():
    subprocess.run(BUILD, check=True, cwd=ROOT)
    contenders = {
        "roverlab, 10 ms": (OUR_STEP, our_step),
        "MuJoCo, 10 ms": (0.010, lambda: mujoco_step(0.010)),
        "MuJoCo, 5 ms": (0.005, lambda: mujoco_step(0.005)),
    }
    times = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, (_, measure) in contenders.items():
            times[name].append(measure())
    print(f"{'':18} {'us a step':>10} {'ms a simulated second':>22}")
    for name, (step, _) in contenders.items():
        median = statistics.median(times[name])
        print(f"{name:18} {median:10.2f} {1e-3 * median / step:22.3f}")


if __name__ == "__main__":
    main()
