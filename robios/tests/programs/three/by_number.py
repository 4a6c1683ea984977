"""One program for three robots: which one it is tells the robot what to do."""

import roam
from eye import OSMachineID

{1: roam.left_right, 2: roam.middle_line}.get(OSMachineID(), roam.anywhere)(roam.duration())
