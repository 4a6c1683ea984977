"""RoBIOS-7 for Python: `from eye import *`.

Every function of the C library under its own name, in millimetres and degrees. Functions that return several values in
C through pointers return a list here; functions that fill an image return an array of unsigned bytes of ctypes.
Functions that take an image take whatever holds its values: such an array, bytes, a list, an array of numpy. Any thread
may call.

Importing it makes time virtual; see the module eyesim_clock.
"""

import ctypes
import ctypes as _ctypes
import os as _os
import sys
import sys as _sys

# `ctypes` and `sys` come with `from eye import *`, as programs expect.
from ctypes import *  # noqa: F401,F403  programs use its types
from eyesim_clock import install as _install
from eyesim_memory import as_bytes as _bytes, filled as _filled, pixels as _pixels, store as _store
from eyesim_names import *  # noqa: F401,F403
from eyesim_names import _X, _Y  # noqa: F401

_here = _os.path.dirname(_os.path.abspath(__file__))


def _candidates():
    ending = "dylib" if _sys.platform == "darwin" else "so"
    name = "libeyesim." + ending
    yield _os.environ.get("ROBIOS_LIBRARY", "")
    yield _os.path.join(_here, "..", "lib", name)
    for build in ("release", "debug"):
        yield _os.path.join(_here, "..", "..", "target", build, name)


def _load():
    for path in _candidates():
        if path and _os.path.exists(path):
            return _ctypes.CDLL(_os.path.abspath(path))
    # As the dynamic loader finds it.
    return _ctypes.CDLL("libeyesim.dylib" if _sys.platform == "darwin" else "libeyesim.so")


lib = _load()

# Set by CAMInit.
CAMWIDTH = CAMHEIGHT = CAMPIXELS = CAMSIZE = 0

# --- types of arguments and results ---

_int, _text, _image, _ints = _ctypes.c_int, _ctypes.c_char_p, _ctypes.c_void_p, _ctypes.POINTER(_ctypes.c_int)

_SIGNATURES = {
    # Functions of whole numbers, by how many they take.
    0: """LCDClear LCDRefresh KEYGet KEYRead CAMRelease OSMachineSpeed OSMachineType OSMachineID OSGetCount AUBeep AUDone
        AUMicrophone VWRemain VWDone VWWait VWStalled VWControlOff DIGITALReadAll ANALOGVoltage IRTVGet IRTVRead
        IRTVFlush IRTVGetStatus VWDriveRemain VWDriveDone VWDriveWait LCDInit RADIOInit RADIOGetID RADIOCheck RADIORelease SIMGetRobotCount SIMGetObjectCount""",
    1: """LCDSetFontSize LCDFontSize LCDSetMode LCDImageSize KEYWait CAMInit IPSetSize OSWait OSDetachTimer SERReceiveChar
        SERCheck SERFlush SERClose PSDGet PSDGetRaw MOTORPIDOff MOTORPIDoff ENCODERRead ENCODERReset SERVOGet SERVODone
        SERVOWait SERVOStalled DIGITALRead ANALOGRead""",
    2: """LCDPixelInvert LCDSetPos LCDSetColor LCDSetFont LCDGetPixel SERVOSet SERVOSetRaw SERVOSetAngle SERVOSetExtension MOTORDrive
        MOTORDriveRaw MOTORSpeed VWSetSpeed VWStraight VWTurn DIGITALWrite ANALOGRecord""",
    3: "LCDPixel OSSetTime SERInit SERVORange VWSetPosition VWCurve VWDrive LIDARSet SIMSetPose",
    4: "LCDImageStart MOTORPID VWControl LCDLineInvert LCDAreaInvert",
    5: "LCDLine LCDCircle SIMSetRobot SIMSetObject",
    6: "LCDArea",
}


def _whole(value):
    """A whole number, also of one of ctypes."""
    return int(getattr(value, "value", value))


def _forward(name, function):
    """A Python function that hands whole numbers on to one of the library."""

    def call(*arguments):
        return function(*[_whole(argument) for argument in arguments])

    call.__name__ = call.__qualname__ = name
    return call


for _count, _names in _SIGNATURES.items():
    for _name in _names.split():
        _function = getattr(lib, _name)
        _function.argtypes, _function.restype = [_int] * _count, _int
        globals()[_name] = _forward(_name, _function)

for _name, _arguments in {
    "LCDMenu": [_text] * 4,
    "LCDMenuI": [_int, _text, _int, _int],
    "LCDGetPos": [_ints] * 2,
    "LCDGetSize": [_ints] * 2,
    "LCDImage": [_image],
    "LCDImageGray": [_image],
    "LCDImageBinary": [_image],
    "KEYGetXY": [_ints] * 2,
    "KEYReadXY": [_ints] * 2,
    "CAMGet": [_image],
    "CAMGetGray": [_image],
    "IPReadFile": [_text, _image],
    "IPWriteFile": [_text, _image],
    "IPWriteFileGray": [_text, _image],
    "IPLaplace": [_image] * 2,
    "IPSobel": [_image] * 2,
    "IPCol2Gray": [_image] * 2,
    "IPGray2Col": [_image] * 2,
    "IPRGB2Col": [_image] * 4,
    "IPCol2HSI": [_image] * 4,
    "IPOverlay": [_image] * 3,
    "IPOverlayGray": [_image, _image, _int, _image],
    "IPPRGB2Col": [_ctypes.c_ubyte] * 3,
    "IPPCol2RGB": [_int] + [_image] * 3,
    "IPPCol2HSI": [_int] + [_image] * 3,
    "IPPRGB2Hue": [_ctypes.c_ubyte] * 3,
    "IPPRGB2HSI": [_ctypes.c_ubyte] * 3 + [_image] * 3,
    "OSExecute": [_text, _ctypes.c_char_p],
    "OSVersion": [_ctypes.c_char_p],
    "OSVersionIO": [_ctypes.c_char_p],
    "OSMachineName": [_ctypes.c_char_p],
    "OSGetTime": [_ints] * 4,
    "SERSendChar": [_int, _ctypes.c_char],
    "eyesim_SERSendN": [_int, _ctypes.c_char_p, _ctypes.c_uint],
    "eyesim_SERReceiveN": [_int, _ctypes.c_char_p, _int],
    "AUPlay": [_text],
    "LIDARGet": [_ints],
    "VWGetSpeed": [_ints] * 2,
    "VWGetPosition": [_ints] * 3,
    "DIGITALSetup": [_int, _ctypes.c_char],
    "ANALOGTransfer": [_image],
    "RADIOSend": [_int, _ctypes.c_char_p],
    "RADIOReceive": [_ints, _ctypes.c_char_p, _int],
    "RADIOStatus": [_ints],
    "SIMGetRobot": [_int] + [_ints] * 4,
    "SIMGetObject": [_int] + [_ints] * 4,
    "SIMGetPose": [_ints] * 3,
    "eyesim_sleep": [_ctypes.c_double],
}.items():
    getattr(lib, _name).argtypes = _arguments
    getattr(lib, _name).restype = _int
for _name in "SIMSetRobot SIMSetObject SIMSetPose SIMGetRobot SIMGetObject SIMGetPose".split():
    getattr(lib, _name).restype = None
lib.IPPRGB2Hue.restype = _ctypes.c_ubyte
lib.SERReceiveChar.restype = _ctypes.c_char
lib.LIDARSet.restype = _int
lib.eyesim_time.argtypes, lib.eyesim_time.restype = [], _ctypes.c_double

_TIMER = _ctypes.CFUNCTYPE(None)
lib.OSAttachTimer.argtypes, lib.OSAttachTimer.restype = [_int, _TIMER], _int


class _Number(int):
    """A whole number that programs may also ask for its `value`, as those of ctypes."""

    @property
    def value(self):
        return int(self)


def _variable(name):
    return _ctypes.c_int.in_dll(lib, name).value


def _several(function, count, *arguments):
    """Calls a function that returns whole numbers through pointers."""
    places = [_ctypes.c_int(0) for _ in range(count)]
    function(*arguments, *[_ctypes.byref(place) for place in places])
    return [place.value for place in places]


# --- display ---


def _formatted(format, arguments):
    if isinstance(format, bytes):
        format = format.decode("utf-8", "replace")
    format = str(format)
    if not arguments:
        return format.replace("%%", "%")
    arguments = tuple(getattr(argument, "value", argument) for argument in arguments)
    try:
        return format % arguments
    except (TypeError, ValueError):
        return " ".join([format, *map(str, arguments)])


def LCDPrintf(format, *arguments):
    return lib.LCDPrintf(b"%s", _bytes(_formatted(format, arguments)))


def LCDSetPrintf(row, column, format, *arguments):
    return lib.LCDSetPrintf(_int(int(row)), _int(int(column)), b"%s", _bytes(_formatted(format, arguments)))


def LCDSetColor(fg, bg=BLACK):
    return lib.LCDSetColor(int(fg), int(bg))


def LCDMenu(st1="", st2="", st3="", st4=""):
    return lib.LCDMenu(_bytes(st1), _bytes(st2), _bytes(st3), _bytes(st4))


def LCDMenuI(pos, string, fg=WHITE, bg=BLACK):
    return lib.LCDMenuI(int(pos), _bytes(string), int(fg), int(bg))


def _pair(function, x, y):
    """Two numbers: to where the program wants them, with the code, or as a list."""
    places = [_ctypes.c_int(0), _ctypes.c_int(0)]
    code = function(*[_ctypes.byref(place) for place in places])
    values = [place.value for place in places]
    if x is None or y is None:
        return values
    _store((x, y), values)
    return code


def LCDGetPos(row=None, column=None):
    return _pair(lib.LCDGetPos, row, column)


def LCDGetSize(x=None, y=None):
    return _pair(lib.LCDGetSize, x, y)


def LCDArea(x1, y1, x2, y2, col, fill=1):
    return lib.LCDArea(int(x1), int(y1), int(x2), int(y2), int(col), int(fill))


def LCDCircle(x1, y1, size, col, fill=1):
    return lib.LCDCircle(int(x1), int(y1), int(size), int(col), int(fill))


_lcd_pixels = 0
_is_custom = False
_window = QVGA_PIXELS


def LCDImageSize(t):
    global _lcd_pixels, _is_custom
    code = lib.LCDImageSize(int(t))
    if code == 0:
        _lcd_pixels, _is_custom = CAMPIXELSARR[int(t)], int(t) == CUSTOM
    return code


def LCDImageStart(x, y, xs, ys):
    global _window
    code = lib.LCDImageStart(int(x), int(y), int(xs), int(ys))
    if code == 0:
        _window = int(xs) * int(ys)
    return code


def _shown():
    """Pixels of the images that the display takes, as the library sees it."""
    if _is_custom:
        return _window
    return _lcd_pixels or _variable("IP_PIXELS") or _window


def LCDImage(img):
    return lib.LCDImage(_pixels(img, 3 * _shown()))


def LCDImageGray(g):
    return lib.LCDImageGray(_pixels(g, _shown()))


def LCDImageBinary(b):
    return lib.LCDImageBinary(_pixels(b, _shown()))


# --- keys ---


def KEYWait(key=ANYKEY):
    return lib.KEYWait(_ctypes.c_int(int(key)))


def KEYGetXY(x=None, y=None):
    return _pair(lib.KEYGetXY, x, y)


def KEYReadXY(x=None, y=None):
    return _pair(lib.KEYReadXY, x, y)


# --- camera and image processing ---


def CAMInit(resolution):
    global CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE
    code = lib.CAMInit(int(resolution))
    CAMWIDTH, CAMHEIGHT = _variable("CAMWIDTH"), _variable("CAMHEIGHT")
    CAMPIXELS, CAMSIZE = _variable("CAMPIXELS"), _variable("CAMSIZE")
    return code


def CAMGet(buf=None):
    return _filled(buf, _variable("CAMSIZE"), lib.CAMGet)


def CAMGetGray(buf=None):
    return _filled(buf, _variable("CAMPIXELS"), lib.CAMGetGray)


def _ip():
    """Pixels of the images of image processing."""
    return _variable("IP_PIXELS") or QQVGA_PIXELS


def IPReadFile(filename, img=None):
    codes = []
    image = _filled(img, 3 * _ip(), lambda target: codes.append(lib.IPReadFile(_bytes(filename), target)))
    return [codes[0], image] if img is None else codes[0]


def IPWriteFile(filename, img):
    return lib.IPWriteFile(_bytes(filename), _pixels(img, 3 * _ip()))


def IPWriteFileGray(filename, gray):
    return lib.IPWriteFileGray(_bytes(filename), _pixels(gray, _ip()))


def _map(function, image, channels, result, into=None):
    return _filled(into, result * _ip(), lambda target: function(_pixels(image, channels * _ip()), target))


def IPLaplace(grayIn, grayOut=None):
    return _map(lib.IPLaplace, grayIn, 1, 1, grayOut)


def IPSobel(grayIn, grayOut=None):
    return _map(lib.IPSobel, grayIn, 1, 1, grayOut)


def IPCol2Gray(img, grayOut=None):
    return _map(lib.IPCol2Gray, img, 3, 1, grayOut)


def IPGray2Col(gray, imgOut=None):
    return _map(lib.IPGray2Col, gray, 1, 3, imgOut)


def IPRGB2Col(r, g, b, imgOut=None):
    planes = [_pixels(plane, _ip()) for plane in (r, g, b)]
    return _filled(imgOut, 3 * _ip(), lambda target: lib.IPRGB2Col(*planes, target))


def IPCol2HSI(img, *hsi):
    planes = [(_ctypes.c_ubyte * _ip())() for _ in range(3)]
    lib.IPCol2HSI(_pixels(img, 3 * _ip()), *planes)
    for target, plane in zip(hsi, planes):
        _filled(target, _ip(), lambda room: _ctypes.memmove(room, plane, _ip()))
    return planes


def IPOverlay(c1, c2, cOut=None):
    images = _pixels(c1, 3 * _ip()), _pixels(c2, 3 * _ip())
    return _filled(cOut, 3 * _ip(), lambda target: lib.IPOverlay(*images, target))


def IPOverlayGray(g1, g2, col, cOut=None):
    images = _pixels(g1, _ip()), _pixels(g2, _ip())
    return _filled(cOut, 3 * _ip(), lambda target: lib.IPOverlayGray(*images, int(col), target))


def _channels(*values):
    return [int(value) & 0xFF for value in values]


def _planes(function, arguments, targets=()):
    values = [_ctypes.c_ubyte(0) for _ in range(3)]
    function(*arguments, *[_ctypes.addressof(value) for value in values])
    _store(targets, [value.value for value in values])
    return [value.value for value in values]


def IPPRGB2Col(r, g, b):
    return lib.IPPRGB2Col(*_channels(r, g, b))


def IPPCol2RGB(col, *rgb):
    return _planes(lib.IPPCol2RGB, [int(col)], rgb)


def IPPCol2HSI(c, *hsi):
    return _planes(lib.IPPCol2HSI, [int(c)], hsi)


def IPPRGB2Hue(r, g, b):
    return lib.IPPRGB2Hue(*_channels(r, g, b))


def IPPRGB2HSI(r, g, b, *hsi):
    return _planes(lib.IPPRGB2HSI, _channels(r, g, b), hsi)


# --- system ---


def _answer(function, *arguments):
    buffer = _ctypes.create_string_buffer(256)
    function(*arguments, buffer)
    return buffer.value.decode("utf-8", "replace")


def OSExecute(command):
    return _answer(lib.OSExecute, _bytes(command))


def _told(function, buf):
    """A text, also in the buffer that a program hands over."""
    answer = _answer(function)
    if buf is not None and hasattr(buf, "raw"):
        buf.value = _bytes(answer)[: _ctypes.sizeof(buf) - 1]
    return answer


def OSVersion(buf=None):
    return _told(lib.OSVersion, buf)


def OSVersionIO(buf=None):
    return _told(lib.OSVersionIO, buf)


def OSMachineName(buf=None):
    return _told(lib.OSMachineName, buf)


_timers = {}


def OSAttachTimer(scale, fct):
    function = _TIMER(fct)
    timer = lib.OSAttachTimer(int(scale), function)
    # The library calls it as long as it is attached.
    _timers[timer] = function
    return timer


def OSDetachTimer(t):
    return lib.OSDetachTimer(int(t))


def OSGetTime(*targets):
    time = _several(lib.OSGetTime, 4)
    _store(targets, time)
    return time


# --- serial ports, sound, lines ---


def SERInit(interface, baud, handshake=0):
    return lib.SERInit(int(interface), int(baud), int(handshake))


def SERSendChar(interface, ch):
    return lib.SERSendChar(int(interface), _bytes(chr(ch) if isinstance(ch, int) else ch)[:1])


def SERSend(interface, buf):
    data = _bytes(buf)
    return lib.eyesim_SERSendN(int(interface), data, len(data))


def SERReceiveChar(interface):
    return lib.SERReceiveChar(int(interface)).decode("latin-1")


def SERReceive(interface, buf=None, size=1024):
    if isinstance(buf, int):
        buf, size = None, buf
    buffer = _ctypes.create_string_buffer(int(size) + 1)
    count = lib.eyesim_SERReceiveN(int(interface), buffer, int(size) + 1)
    if hasattr(buf, "raw"):
        buf.value = buffer.raw[: min(count, _ctypes.sizeof(buf) - 1)]
    return buffer.raw[:count].decode("utf-8", "replace")


def AUPlay(sample):
    return lib.AUPlay(_bytes(sample))


def DIGITALSetup(io, direction):
    return lib.DIGITALSetup(int(io), _bytes(direction)[:1] or b"i")


def ANALOGTransfer(_buffer=None):
    buffer = (_ctypes.c_ubyte * 65536)()
    count = lib.ANALOGTransfer(buffer)
    return list(buffer[:count])


# --- distance sensors and driving ---


LIDAR_POINTS = LIDAR_RANGE = 360


def LIDARGet(distance=None):
    # A scan has as many points as the library says; a robot's own number is known after the first scan.
    scan = (_ctypes.c_int * 100_000)()
    lib.LIDARGet(scan)
    points = _variable("LIDAR_RESOLUTION")
    if distance is not None:
        count = min(points, len(distance))
        distance[:count] = scan[:count]
        return distance
    return (_ctypes.c_int * points)(*scan[:points])


def LIDARSet(range, tilt, points):
    return lib.LIDARSet(int(range), int(tilt), int(points))


def SIMLaserScan():
    return LIDARGet()


def VWGetSpeed(*targets):
    speed = _several(lib.VWGetSpeed, 2)
    _store(targets, speed)
    return speed


def VWGetPosition(*targets):
    pose = _several(lib.VWGetPosition, 3)
    _store(targets, pose)
    return pose


# --- radio ---


def RADIOSend(id, buf):
    return lib.RADIOSend(int(id), _bytes(buf))


def RADIOReceive(size=1024):
    sender, buffer = _ctypes.c_int(0), _ctypes.create_string_buffer(int(size) + 1)
    count = lib.RADIOReceive(_ctypes.byref(sender), buffer, int(size))
    return [sender.value, buffer.raw[:count].decode("utf-8", "replace")]


def RADIOStatus():
    ids = (_ctypes.c_int * 256)()
    return [lib.RADIOStatus(ids), ids]


# --- simulation ---


def SIMGetRobot(id=0):
    return [_Number(value) for value in _several(lib.SIMGetRobot, 4, int(id))]


def SIMGetObject(id):
    return [_Number(value) for value in _several(lib.SIMGetObject, 4, int(id))]


def SIMGetPose():
    return [_Number(value) for value in _several(lib.SIMGetPose, 3)]


_install(lib)
