"""DistBug drives to a goal among unknown obstacles; a picture shows its way. Usage: distbug.py [FOLDER]"""

import math
import sys
from pathlib import Path

from roverlab.nav import Bug
from roverlab.sim import Scene, Simulation

scene = Scene.course(seed=7)
scene.add_robot("S4")
assert scene.start is not None and scene.goal is not None

# The robot knows the goal relative to where it starts: ahead and to its left.
x, y, heading = scene.start
dx, dy = scene.goal[0] - x, scene.goal[1] - y
goal = (math.cos(heading) * dx + math.sin(heading) * dy, math.cos(heading) * dy - math.sin(heading) * dx)

simulation = Simulation(scene, seed=1, trail_interval=0.1)
robot, bug = simulation.robot(), Bug(goal, "DistBug")
while bug.outcome is None and simulation.time < 600.0:
    linear, angular = bug.decide(robot)
    robot.set_speed(linear, angular)
    robot.wait(bug.period)
robot.stop()

truth = simulation.truth
print(f"{bug.outcome} after {simulation.time:.1f} s and {truth.path_length():.2f} m, {truth.contacts()} contacts")
assert bug.outcome == "the goal is reached"

folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path()
(folder / "distbug.svg").write_text(simulation.to_svg("DistBug"))
