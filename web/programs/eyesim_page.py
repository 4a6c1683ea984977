"""RoBIOS in a page: what eye.py loads as a library is a module of WebAssembly there, which `eyesim` of the page holds."""

import builtins
import ctypes
import random
import sys
import traceback

import sitecustomize
from pyodide.ffi import JsException

import eyesim

# Exit status of a program that the time limit ends.
_LIMIT = 124
# Functions whose formatted text the module takes without a format.
_PRINTING = {"LCDPrintf": "eyesim_print", "LCDSetPrintf": "eyesim_print_at"}

_timers = []


class _Room:
    """Memory of the module for an object of ctypes, during a call."""

    def __init__(self, target, is_output=True):
        self.target, self.size, self.is_output = target, ctypes.sizeof(target), is_output
        self.start = eyesim.exports.take(self.size)
        self._view().assign(ctypes.string_at(ctypes.addressof(target), self.size))

    def _view(self):
        return eyesim.view(self.start, self.size)

    def close(self):
        if self.is_output:
            ctypes.memmove(ctypes.addressof(self.target), self._view().to_bytes(), self.size)
        eyesim.exports.give_back(self.start, self.size)


class _Function:
    """A function of the module, called as one of ctypes."""

    argtypes, restype = None, ctypes.c_int

    def __init__(self, name):
        self._name, self._run = name, getattr(eyesim.exports, _PRINTING.get(name, name))

    def __call__(self, *arguments):
        if self._name in _PRINTING:
            # Without the format, which is always "%s".
            arguments = arguments[:-2] + arguments[-1:]
        kinds = self.argtypes or [None] * len(arguments)
        rooms = []
        numbers = [self._number(argument, kind, rooms) for argument, kind in zip(arguments, kinds)]
        try:
            result = self._run(*numbers)
        except JsException:
            # Its time is over.
            raise SystemExit(_LIMIT) from None
        for room in rooms:
            room.close()
        return self._result(result)

    def _number(self, argument, kind, rooms):
        """What the module gets for an argument: a number, or a place in its memory."""
        if argument is None:
            return 0
        if kind is ctypes.c_double:
            return float(argument)
        if kind is ctypes.c_char:
            return argument[0] if isinstance(argument, bytes) else ord(argument.value)
        if callable(argument):
            _timers.append(argument)
            return len(_timers) - 1
        if isinstance(argument, bytes):
            rooms.append(_Room(ctypes.create_string_buffer(argument), is_output=False))
            return rooms[-1].start
        if kind is ctypes.c_void_p and isinstance(argument, (int, ctypes.c_void_p)):
            address = argument if isinstance(argument, int) else argument.value
            return self._place((ctypes.c_ubyte * self._length()).from_address(address), rooms) if address else 0
        if hasattr(argument, "_obj"):
            return self._place(argument._obj, rooms)
        if isinstance(argument, ctypes.Array):
            return self._place(argument, rooms)
        return ctypes.c_int(int(getattr(argument, "value", argument))).value

    @staticmethod
    def _place(target, rooms):
        rooms.append(_Room(target))
        return rooms[-1].start

    def _length(self):
        """Bytes at an address that has no length: a channel of a pixel, or an image."""
        return 1 if self._name.startswith("IPP") else max(variable("IP_SIZE"), variable("CAMSIZE"), 1)

    def _result(self, result):
        if self.restype is None or result is None:
            return None
        if self.restype is ctypes.c_char:
            return bytes([result & 0xFF])
        return float(result) if self.restype is ctypes.c_double else int(result)


class _Library:
    """The module, in the place of a library that ctypes has loaded."""

    def __getattr__(self, name):
        function = _Function(name)
        setattr(self, name, function)
        return function


def variable(name):
    """A variable of the library."""
    start = getattr(eyesim.exports, name).value
    return int.from_bytes(eyesim.view(start, 4).to_bytes(), "little", signed=True)


def call_timer(number):
    """Calls a timer function. As in C, an exception does not leave it."""
    try:
        _timers[number]()
    except SystemExit:
        pass
    except BaseException:
        traceback.print_exc()


def _load_eye():
    """Makes `import eye` take the module."""
    load = ctypes.CDLL
    ctypes.CDLL = lambda *_: _Library()
    import eye

    ctypes.CDLL = load
    eye._variable = variable
    # The page calls timer functions as they are.
    eye._TIMER = lambda function: function
    # Some published programs have `from random.eye import *`, which an editor once made of `from eye import *`.
    sys.modules["random.eye"] = eye


def run(text, name, seed):
    """Runs a program as the runner does. Returns its exit status and its last words."""
    _load_eye()
    sitecustomize._answer_for_nobody()
    sitecustomize._seed_random(f"{seed}:0")
    sys.argv = [name]
    sys.modules["__main__"].__dict__.update(__name__="__main__", __file__=name)
    try:
        exec(compile(text, name, "exec"), sys.modules["__main__"].__dict__)
    except SystemExit as end:
        return _status(end.code)
    except BaseException as error:
        inner = error.__traceback__.tb_next
        traceback.print_exception(type(error), error, inner)
        lines = "".join(traceback.format_exception_only(type(error), error)).strip().splitlines()
        return 1, lines[-1].strip() if lines else ""
    return 0, ""


def _status(code):
    """The exit status that a code of `sys.exit` means, and the last words that it may be."""
    if code is None or isinstance(code, int):
        return int(code or 0) & 0xFF, ""
    print(code, file=sys.stderr)
    return 1, (str(code).strip().splitlines() or [""])[-1]
