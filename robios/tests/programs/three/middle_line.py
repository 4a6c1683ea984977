import roam

roam.middle_line(roam.duration())
