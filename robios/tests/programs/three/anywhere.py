import roam

roam.anywhere(roam.duration())
