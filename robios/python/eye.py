"""RoBIOS-7 for Python: `from eye import *`.

Every function of the C library under its own name, in millimetres and degrees. Functions that return several values in
C through pointers return a list here; functions that fill an image return an array of ctypes. Any thread may call.

Importing it makes time virtual: `time.sleep`, `time.time` and the other clocks of the module `time` follow the robot's.
"""

import ctypes
import ctypes as _ctypes
import os as _os
import sys
import sys as _sys
import threading as _threading
import time as _time

# `ctypes` and `sys` come with `from eye import *`, as programs expect. What follows holds on to the real clock before
# it is replaced.
import queue as _queue
from ctypes import *  # noqa: F401,F403  programs use its types

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

# --- constants ---

QQVGA, QVGA, VGA, CAM1MP, CAMHD, CAM5MP, CUSTOM = 0, 1, 2, 3, 4, 5, 10
QQVGA_X, QQVGA_Y = 160, 120
QVGA_X, QVGA_Y = 320, 240
VGA_X, VGA_Y = 640, 480
CAM1MP_X, CAM1MP_Y = 1296, 730
CAMHD_X, CAMHD_Y = 1920, 1080
CAM5MP_X, CAM5MP_Y = 2592, 1944
QQVGA_PIXELS, QVGA_PIXELS, VGA_PIXELS = QQVGA_X * QQVGA_Y, QVGA_X * QVGA_Y, VGA_X * VGA_Y
CAM1MP_PIXELS, CAMHD_PIXELS, CAM5MP_PIXELS = CAM1MP_X * CAM1MP_Y, CAMHD_X * CAMHD_Y, CAM5MP_X * CAM5MP_Y
QQVGA_SIZE, QVGA_SIZE, VGA_SIZE = 3 * QQVGA_PIXELS, 3 * QVGA_PIXELS, 3 * VGA_PIXELS
CAM1MP_SIZE, CAMHD_SIZE, CAM5MP_SIZE = 3 * CAM1MP_PIXELS, 3 * CAMHD_PIXELS, 3 * CAM5MP_PIXELS

_X = [QQVGA_X, QVGA_X, VGA_X, CAM1MP_X, CAMHD_X, CAM5MP_X]
_Y = [QQVGA_Y, QVGA_Y, VGA_Y, CAM1MP_Y, CAMHD_Y, CAM5MP_Y]
CAMWIDTHARR, CAMHEIGHTARR = {**dict(enumerate(_X)), CUSTOM: 0}, {**dict(enumerate(_Y)), CUSTOM: 0}
CAMPIXELSARR = {key: CAMWIDTHARR[key] * CAMHEIGHTARR[key] for key in CAMWIDTHARR}
CAMSIZEARR = {key: 3 * pixels for key, pixels in CAMPIXELSARR.items()}

RED, GREEN, BLUE, WHITE, GRAY, BLACK = 0xFF0000, 0x00FF00, 0x0000FF, 0xFFFFFF, 0x808080, 0x000000
SILVER, LIGHTGRAY, DARKGRAY, NAVY, CYAN, TEAL = 0xC0C0C0, 0xD3D3D3, 0xA9A9A9, 0x000080, 0x00EEEE, 0x008080
MAGENTA, PURPLE, MAROON, YELLOW, OLIVE, ORANGE = 0xFF00FF, 0x800080, 0x800000, 0xFFFF00, 0x9ACD32, 0xFFA500

NOKEY, KEY1, KEY2, KEY3, KEY4, ANYKEY = 0, 1, 2, 4, 8, 0xFFFFFFFF

HELVETICA, TIMES, COURIER = 0, 1, 2
NORMAL, BOLD, ITALICS = 0, 1, 2

LCD_AUTOREFRESH, LCD_NOAUTOREFRESH = 0x000001, 0x000100
LCD_SCROLLING, LCD_NOSCROLLING = 0x000002, 0x000200
LCD_LINEFEED, LCD_NOLINEFEED = 0x000004, 0x000400
LCD_SHOWMENU, LCD_HIDEMENU = 0x000008, 0x000800
LCD_LISTMENU, LCD_CLASSICMENU = 0x000010, 0x001000
LCD_FB_ROTATE, LCD_FB_NOROTATION = 0x000080, 0x008000
LCD_BGCOL_TRANSPARENT, LCD_BGCOL_NOTRANSPARENT = 0x010000, 0x100000
LCD_BGCOL_INVERSE, LCD_BGCOL_NOINVERSE = 0x020000, 0x200000
LCD_FGCOL_INVERSE, LCD_FGCOL_NOINVERSE = 0x040000, 0x400000

PSD_FRONT, PSD_LEFT, PSD_RIGHT, PSD_BACK = 1, 2, 3, 4

IRTV_0, IRTV_1, IRTV_2, IRTV_3, IRTV_4 = (ord(digit) for digit in "01234")
IRTV_5, IRTV_6, IRTV_7, IRTV_8, IRTV_9 = (ord(digit) for digit in "56789")
IRTV_RED, IRTV_GREEN, IRTV_YELLOW, IRTV_BLUE = (ord(letter) for letter in "RGYB")
IRTV_LEFT, IRTV_RIGHT, IRTV_UP, IRTV_DOWN, IRTV_OK, IRTV_POWER = (ord(letter) for letter in "L>UDOP")

NONE, RTSCTS = 0, 1

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


def _bytes(text):
    """A text as C takes it."""
    if text is None:
        return b""
    if isinstance(text, (bytes, bytearray)):
        return bytes(text)
    if isinstance(text, str):
        return text.encode("utf-8", "replace")
    if hasattr(text, "raw"):
        return text.value
    return str(text).encode("utf-8", "replace")


def _variable(name):
    return _ctypes.c_int.in_dll(lib, name).value


def _pixels(image, count):
    """An image of at least `count` bytes as C takes it, whatever it is: an array of ctypes, bytes, a list, numpy's."""
    if image is None:
        return None
    if isinstance(image, _ctypes.Array) and _ctypes.sizeof(image) >= count:
        return image
    if isinstance(image, _ctypes._Pointer):
        return _ctypes.cast(image, _ctypes.c_void_p)
    try:
        data = bytes(memoryview(image).cast("B")) if not isinstance(image, list) else None
    except (TypeError, ValueError):
        data = None
    if data is None:
        data = bytes(int(value) & 0xFF for value in _flat(image))
    return (_ctypes.c_ubyte * max(count, len(data))).from_buffer_copy(data.ljust(count, b"\0"))


def _flat(values):
    for value in values:
        if isinstance(value, (list, tuple)):
            yield from _flat(value)
        else:
            yield value


def _several(function, count, *arguments):
    """Calls a function that returns whole numbers through pointers."""
    places = [_ctypes.c_int(0) for _ in range(count)]
    function(*arguments, *[_ctypes.byref(place) for place in places])
    return [place.value for place in places]


def _gray(count):
    return (_ctypes.c_byte * count)()


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


def CAMGet():
    image = _gray(_variable("CAMSIZE"))
    lib.CAMGet(image)
    return image


def CAMGetGray():
    image = _gray(_variable("CAMPIXELS"))
    lib.CAMGetGray(image)
    return image


def _ip():
    """Pixels of the images of image processing."""
    return _variable("IP_PIXELS") or QQVGA_PIXELS


def IPReadFile(filename, img=None):
    if img is not None:
        return lib.IPReadFile(_bytes(filename), img)
    image = _gray(3 * _ip())
    return [lib.IPReadFile(_bytes(filename), image), image]


def IPWriteFile(filename, img):
    return lib.IPWriteFile(_bytes(filename), _pixels(img, 3 * _ip()))


def IPWriteFileGray(filename, gray):
    return lib.IPWriteFileGray(_bytes(filename), _pixels(gray, _ip()))


def _map(function, image, channels, result, into=None):
    target = _gray(result * _ip()) if into is None else into
    function(_pixels(image, channels * _ip()), target)
    return target


def IPLaplace(grayIn, grayOut=None):
    return _map(lib.IPLaplace, grayIn, 1, 1, grayOut)


def IPSobel(grayIn, grayOut=None):
    return _map(lib.IPSobel, grayIn, 1, 1, grayOut)


def IPCol2Gray(img, grayOut=None):
    return _map(lib.IPCol2Gray, img, 3, 1, grayOut)


def IPGray2Col(gray, imgOut=None):
    return _map(lib.IPGray2Col, gray, 1, 3, imgOut)


def IPRGB2Col(r, g, b, imgOut=None):
    target = _gray(3 * _ip()) if imgOut is None else imgOut
    lib.IPRGB2Col(*[_pixels(plane, _ip()) for plane in (r, g, b)], target)
    return target


def IPCol2HSI(img):
    planes = [_gray(_ip()) for _ in range(3)]
    lib.IPCol2HSI(_pixels(img, 3 * _ip()), *planes)
    return planes


def IPOverlay(c1, c2):
    target = _gray(3 * _ip())
    lib.IPOverlay(_pixels(c1, 3 * _ip()), _pixels(c2, 3 * _ip()), target)
    return target


def IPOverlayGray(g1, g2, col):
    target = _gray(3 * _ip())
    lib.IPOverlayGray(_pixels(g1, _ip()), _pixels(g2, _ip()), int(col), target)
    return target


def _channels(*values):
    return [int(value) & 0xFF for value in values]


def _planes(function, arguments, targets=()):
    values = [_ctypes.c_ubyte(0) for _ in range(3)]
    function(*arguments, *[_ctypes.addressof(value) for value in values])
    _store(targets, [value.value for value in values])
    return [value.value for value in values]


def _store(targets, values):
    """Values to where a program wants them: numbers of ctypes, or pointers to them."""
    for target, value in zip(targets, values):
        if hasattr(target, "contents"):
            target.contents.value = value
        elif hasattr(target, "_obj"):
            target._obj.value = value
        elif hasattr(target, "value"):
            target.value = value


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


def LIDARGet():
    # A scan has as many points as the library says; a robot's own number is known after the first scan.
    scan = (_ctypes.c_int * 100_000)()
    lib.LIDARGet(scan)
    points = _variable("LIDAR_RESOLUTION")
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


# --- time ---


def _sleep(seconds):
    """In the place of `time.sleep`."""
    seconds = float(seconds)
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    if lib.eyesim_sleep(seconds) != 0:
        _real["sleep"](seconds)


def _clock(name, from_start):
    real = _real[name]

    def clock():
        now = lib.eyesim_time()
        if now < 0:
            return real()
        return now - _EPOCH if from_start else now

    clock.__name__ = clock.__qualname__ = name
    return clock


def _nanoseconds(clock):
    return lambda: int(1e9 * clock())


_LOOK = 0.01


def _wait(self, timeout=None):
    """In the place of `threading.Condition.wait`, on which events and queues are built: with a time limit it waits by
    the program's clock, and looks again and again whether somebody has notified."""
    if timeout is None or timeout <= 0 or lib.eyesim_time() < 0:
        return _wait_really(self, timeout)
    if not self._is_owned():
        raise RuntimeError("cannot wait on un-acquired lock")
    waiter = _threading.Lock()
    waiter.acquire()
    self._waiters.append(waiter)
    state = self._release_save()
    end, notified = _time.monotonic() + timeout, False
    try:
        while not notified and _time.monotonic() < end:
            _time.sleep(min(_LOOK, timeout))
            notified = waiter.acquire(False)
    finally:
        self._acquire_restore(state)
        if not notified and waiter in self._waiters:
            self._waiters.remove(waiter)
    return notified


def _note_thread(self, *arguments, **options):
    lib.eyesim_note_thread()
    return _start(self, *arguments, **options)


_EPOCH = 1577880000.0

# The module may be loaded twice: by the runner for programs that bring an eye.py of their own, and by the program.
if not hasattr(_time, "_eyesim"):
    _time._eyesim = True
    _real = {name: getattr(_time, name) for name in ("sleep", "time", "monotonic", "perf_counter", "process_time")}
    for _name, _from_start in (("time", False), ("monotonic", True), ("perf_counter", True), ("process_time", True)):
        _replacement = _clock(_name, _from_start)
        setattr(_time, _name, _replacement)
        setattr(_time, _name + "_ns", _nanoseconds(_replacement))
    _time.sleep = _sleep
    _start = _threading.Thread.start
    _threading.Thread.start = _note_thread
    _wait_really = _threading.Condition.wait
    _threading.Condition.wait = _wait
    # What these have taken from the module `time` when they were loaded.
    _threading._time = _queue.time = _time.monotonic
