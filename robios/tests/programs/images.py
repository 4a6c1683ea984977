"""Camera and image processing."""

import os
from eye import *

assert CAMInit(QVGA) == 0 and (CAMWIDTH, CAMSIZE) == (0, 0), "as they were when they were imported"
image = CAMGet()
assert len(image) == QVGA_SIZE == CAMSIZEARR[QVGA] and len(CAMGetGray()) == QVGA_PIXELS
gray = IPCol2Gray(image)
assert len(IPLaplace(gray)) == len(IPSobel(gray)) == QVGA_PIXELS
hue, saturation, intensity = IPCol2HSI(image)
assert len(hue) == len(saturation) == len(intensity) == QVGA_PIXELS
assert len(IPGray2Col(gray)) == len(IPOverlayGray(gray, hue, RED)) == len(IPOverlay(image, image)) == QVGA_SIZE
assert IPPRGB2Col(1, 2, 3) == 0x010203 and IPPCol2RGB(0x010203) == [1, 2, 3]
parts = [ctypes.c_ubyte(0) for _ in range(3)]
IPPCol2RGB(0x0A0B0C, *parts)
assert [part.value for part in parts] == [10, 11, 12]
assert IPPRGB2Hue(255, 0, 0) == IPPCol2HSI(RED)[0] == IPPRGB2HSI(255, 0, 0)[0] == 42
IPSetSize(QQVGA)
red, green, blue = [bytes([level] * QQVGA_PIXELS) for level in (200, 100, 0)]
assert IPWriteFile("colours.ppm", IPRGB2Col(red, green, blue)) == 0
kind, copy = IPReadFile("colours.ppm")
assert kind == 3 and [value & 0xFF for value in copy[:3]] == [200, 100, 0]
assert IPWriteFileGray("gray.pgm", red) == 0 and IPReadFile("gray.pgm")[0] == 2
assert IPReadFile("missing.pgm")[0] == -1
os.remove("colours.ppm"), os.remove("gray.pgm")
assert CAMRelease() == 0
