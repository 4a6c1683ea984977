"""Images in whatever holds their values."""

import array
import os
from eye import *

CAMInit(QQVGA)
image = CAMGet()
gray = CAMGetGray()
assert min(image) >= 0 and bytes(list(image)) == bytes(image)
flat = list(image)
same = [image, bytes(image), bytearray(image), flat, tuple(image), memoryview(image), array.array("h", flat),
        [[flat[3 * (160 * y + x):3 * (160 * y + x + 1)] for x in range(160)] for y in range(120)]]
expected = bytes(IPCol2Gray(image))
for form in same:
    assert bytes(IPCol2Gray(form)) == expected, type(form)
    assert LCDImage(form) == 0 and LCDGetPixel(5, 5) == IPPRGB2Col(*image[2415:2418])
assert IPWriteFile("form.ppm", same[-1]) == 0 and bytes(IPReadFile("form.ppm")[1]) == bytes(image)
os.remove("form.ppm")
targets = [bytearray(QQVGA_PIXELS), [0] * QQVGA_PIXELS, (c_byte * QQVGA_PIXELS)(), array.array("B", bytes(QQVGA_PIXELS))]
for target in targets:
    IPCol2Gray(image, target)
    assert bytes(value & 0xFF for value in target) == expected, type(target)
mine, distances = (c_byte * QQVGA_SIZE)(), [0] * 360
assert CAMGet(mine) is mine and bytes(value & 0xFF for value in mine) == bytes(image)
assert LIDARGet(distances) is distances and min(distances) > 0
short = bytearray(7)
assert IPCol2Gray(image, short) == expected[:7], "what is too short is not exceeded"
assert bytes(IPCol2Gray(image[:9]))[3:] == bytes(QQVGA_PIXELS - 3), "what is missing is black"
assert LCDImageGray([-1] * QQVGA_PIXELS) == 0 and LCDGetPixel(9, 9) == WHITE
try:
    import numpy
except ImportError:
    print("numpy was not found")
else:
    shaped = numpy.frombuffer(image, dtype=numpy.uint8).reshape(120, 160, 3)
    assert (numpy.array(image).reshape(120, 160, 3) == shaped).all()
    assert (numpy.array(list(image), dtype=numpy.uint8) == shaped.ravel()).all()
    wide = numpy.repeat(shaped, 2, axis=1)
    for form in (shaped, shaped.astype(float) + 0.5, shaped.astype(numpy.int64), shaped.view(numpy.int8), wide[:, ::2],
                 numpy.asfortranarray(shaped), shaped[::-1][::-1]):
        assert bytes(IPCol2Gray(form)) == expected and LCDImage(form) == 0
    flat, block = numpy.zeros(QQVGA_PIXELS, dtype=numpy.uint8), numpy.zeros((120, 160))
    IPCol2Gray(shaped, flat)
    IPSobel(flat, block)
    assert flat.tobytes() == expected and (block.ravel() == list(IPSobel(gray))).all()
    assert LCDImageBinary(flat > 100) == 0 and LCDImageGray(255 - flat) == 0
    LCDPixel(numpy.int64(3), numpy.float64(4.0), int(numpy.uint32(RED)))
    VWSetSpeed(numpy.int64(0), numpy.float32(0))
LCDPrintf("all forms are good")
