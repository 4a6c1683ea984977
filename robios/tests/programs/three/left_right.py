import roam

roam.left_right(roam.duration())
