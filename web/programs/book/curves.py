"""An eight of two circles, and home by odometry."""
from eye import *

VWCurve(1885, 360, 300)
VWWait()
VWCurve(1885, -360, 300)
VWWait()
x, y, phi = VWGetPosition()
LCDPrintf("back at %d %d, heading %d\n", x, y, phi)
