"""The functions of Python's module, one by one."""

import time
from ctypes import byref, c_int
from eye import *

assert LCDPrintf("%d and %s\n", 42, "text") == 0
LCDPrintf("100%%\n")
LCDSetPrintf(5, 3, "%4.1f", 2.5)
assert LCDGetSize() == [480, 320]
x, y = c_int(0), c_int(0)
LCDGetSize(byref(x), byref(y))
assert (x.value, y.value) == (480, 320)
LCDMenu("GO", "", "", "END")
assert KEYGet() == KEY1
assert KEYWait(ANYKEY) == KEY4
start = time.time()
time.sleep(2.5)
assert abs(time.time() - start - 2.5) < 0.01
OSWait(500)
assert PSDGet(PSD_FRONT) > 100
CAMInit(QVGA)
image = CAMGet()
assert len(image) == QVGA_SIZE and CAMWIDTH == 0 or CAMWIDTH == 320
assert LCDImage(image) == 0
gray = CAMGetGray()
edges = IPLaplace(gray)
assert len(edges) == QVGA_PIXELS and LCDImageGray(edges) == 0
assert LCDImageGray(IPSobel(IPCol2Gray(image))) == 0
hue, saturation, intensity = IPCol2HSI(image)
assert LCDImage(IPOverlayGray(gray, edges, RED)) == 0
assert LCDImageBinary([1 if value & 0xFF > 100 else 0 for value in gray]) == 0
assert IPPCol2RGB(0x010203) == [1, 2, 3] and IPPRGB2Hue(255, 0, 0) == 42
scan = LIDARGet()
assert len(scan) == 360 and min(scan) > 0
LIDARSet(180, 0, 5)
assert len(LIDARGet()) == 5
VWStraight(200, 200)
while not VWDone():
    pass
assert abs(VWGetPosition()[0] - 200) <= 2
VWTurn(90, 90)
VWWait()
assert abs(VWGetPosition()[2] - 90) <= 1
assert SIMGetRobot(0)[3].value in (89, 90, 91)
SIMSetRobot(0, 1000, 1000, 0, 45)
assert SIMGetRobot(0)[0] == 1000 and SIMGetRobot(0)[3].value == 45
RADIOInit()
assert RADIOGetID() == 1 and RADIOStatus()[0] == 1
RADIOSend(1, "to myself")
assert RADIOReceive() == [1, "to myself"]
SERInit(0, 9600)
SERSend(0, "abc")
assert SERReceive(0) == "abc"
assert OSMachineName() == "EyeBot" and OSExecute("echo x") == "x\n"
calls = []
timer = OSAttachTimer(100, lambda: calls.append(1))
OSWait(1050)
OSDetachTimer(timer)
assert 9 <= len(calls) <= 11, calls
LCDClear()
LCDPrintf("python is done\n")
