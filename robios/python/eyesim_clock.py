"""Makes time in Python follow the robot's clock: the modules time, datetime, threading, queue, select, selectors, on
which asyncio waits, and signal. A wait with a time limit lets the world go on and looks again and again whether it is
over.

What follows the real clock still: Lock.acquire with a time limit, what other processes do (multiprocessing,
subprocess), and waits without a time limit for files and sockets.
"""

import ctypes as _ctypes
import datetime as _datetime
import queue as _queue
import select as _select
import selectors as _selectors
import signal as _signal
import threading as _threading
import time as _time

# Noon of the first day of 2020, in Greenwich: the beginning of every run.
_EPOCH = 1577880000.0
# Seconds between two looks of somebody who waits.
_LOOK = 0.01

_lib = None
_alarm_is_set = False
_real = {}


def _keep(module, name):
    """Remembers what is about to be replaced."""
    _real[name] = getattr(module, name)
    return _real[name]


def _now():
    """Seconds since 1970 by the robot's clock; none if there is no robot."""
    now = _lib.eyesim_time()
    return now if now >= 0 else None


def _sleep(seconds):
    """In the place of `time.sleep`."""
    seconds = float(seconds)
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    end = seconds + (_now() or 0.0)
    while _alarm_is_set and seconds > _LOOK and _lib.eyesim_sleep(_LOOK) == 0:
        # Handlers of signals are called between two pieces.
        seconds = max(end - _now(), 0.0)
    if _lib.eyesim_sleep(seconds) != 0:
        _real["sleep"](seconds)


def _patiently(look, timeout):
    """Looks until there is something to see, or the time is over."""
    end = _time.monotonic() + timeout
    while True:
        found, left = look(), end - _time.monotonic()
        if found or left <= 0:
            return found
        _sleep(min(_LOOK, left))


# --- time ---


def _clock(name, from_start):
    real = _keep(_time, name)

    def clock():
        now = _now()
        if now is None:
            return real()
        return now - _EPOCH if from_start else now

    clock.__name__ = clock.__qualname__ = name
    return clock


def _nanoseconds(clock):
    return lambda *arguments: int(1e9 * clock(*arguments))


def _clock_gettime(clock):
    name = _CLOCKS.get(clock)
    return _real["clock_gettime"](clock) if name is None else getattr(_time, name)()


_CLOCKS = {
    getattr(_time, "CLOCK_" + clock): name
    for clock, name in (
        ("REALTIME", "time"), ("MONOTONIC", "monotonic"), ("MONOTONIC_RAW", "monotonic"), ("BOOTTIME", "monotonic")
    )
    if hasattr(_time, "CLOCK_" + clock)
}


def _of_seconds(name):
    real = _keep(_time, name)
    return lambda seconds=None: real(_time.time() if seconds is None else seconds)


def _of_fields(name, fixed):
    """A function of a time in fields, which come after some other arguments."""
    real = _keep(_time, name)

    def written(*arguments):
        return real(*arguments, *([_time.localtime()] if len(arguments) == fixed else []))

    return written


def _replace_time():
    _keep(_time, "sleep")
    for name in ("time", "monotonic", "perf_counter", "process_time", "thread_time"):
        if not hasattr(_time, name):
            # As in a page, which has no threads.
            continue
        replacement = _clock(name, name != "time")
        setattr(_time, name, replacement)
        setattr(_time, name + "_ns", _nanoseconds(replacement))
    _time.sleep = _sleep
    for name in ("localtime", "gmtime", "ctime"):
        setattr(_time, name, _of_seconds(name))
    _time.strftime, _time.asctime = _of_fields("strftime", 1), _of_fields("asctime", 0)
    if hasattr(_time, "clock_gettime"):
        _keep(_time, "clock_gettime")
        _time.clock_gettime, _time.clock_gettime_ns = _clock_gettime, _nanoseconds(_clock_gettime)


# --- datetime ---


def _replace_datetime():
    """Classes that ask the robot's clock in the place of those that ask the system; objects of one pass for the
    other's."""

    def passes_for(real):
        class Passing(type):
            def __instancecheck__(cls, value):
                return isinstance(value, real) if cls.__base__ is real else type.__instancecheck__(cls, value)

            def __subclasscheck__(cls, other):
                return issubclass(other, real) if cls.__base__ is real else type.__subclasscheck__(cls, other)

        return Passing

    class date(_datetime.date, metaclass=passes_for(_datetime.date)):
        @classmethod
        def today(cls):
            return cls.fromtimestamp(_time.time())

    class datetime(_datetime.datetime, metaclass=passes_for(_datetime.datetime)):
        @classmethod
        def now(cls, tz=None):
            return cls.fromtimestamp(_time.time(), tz)

        @classmethod
        def utcnow(cls):
            return cls.fromtimestamp(_time.time(), _datetime.timezone.utc).replace(tzinfo=None)

        @classmethod
        def today(cls):
            return cls.now()

    for replacement in (date, datetime):
        replacement.__module__, replacement.__qualname__ = "datetime", replacement.__name__
        setattr(_datetime, replacement.__name__, replacement)


# --- threads, queues and files ---


def _wait(self, timeout=None):
    """In the place of `threading.Condition.wait`, on which events and queues are built."""
    if timeout is None or timeout <= 0 or _now() is None:
        return _real["wait"](self, timeout)
    if not self._is_owned():
        raise RuntimeError("cannot wait on un-acquired lock")
    waiter = _threading.Lock()
    waiter.acquire()
    self._waiters.append(waiter)
    state = self._release_save()
    notified = False
    try:
        notified = _patiently(lambda: waiter.acquire(False), timeout)
    finally:
        self._acquire_restore(state)
        if not notified and waiter in self._waiters:
            self._waiters.remove(waiter)
    return notified


def _start(self, *arguments, **options):
    _lib.eyesim_note_thread()
    return _real["start"](self, *arguments, **options)


def _join(self, timeout=None):
    if timeout is None or timeout <= 0 or _now() is None:
        return _real["join"](self, timeout)
    _real["join"](self, 0)
    _patiently(lambda: not self.is_alive(), timeout)


def _replace_threading():
    _keep(_threading.Condition, "wait")
    _keep(_threading.Thread, "start")
    _keep(_threading.Thread, "join")
    _threading.Condition.wait, _threading.Thread.start, _threading.Thread.join = _wait, _start, _join
    # What these have taken from the module `time` when they were loaded.
    _threading._time = _queue.time = _time.monotonic


def _select_files(readable, writable, special, timeout=None):
    select = _real["select"]
    if timeout is None or timeout <= 0 or _now() is None:
        return select(readable, writable, special, timeout)
    if not (readable or writable or special):
        _sleep(timeout)
        return [], [], []
    found = _patiently(lambda: _any(select(readable, writable, special, 0)), timeout)
    return found or ([], [], [])


def _any(lists):
    return lists if any(lists) else None


def _replace_select():
    _keep(_select, "select")
    _select.select = _select_files
    waiting = _selectors.DefaultSelector
    waiting.select = _selecting(waiting.select)
    for other in {_selectors.SelectSelector, getattr(_selectors, "PollSelector", waiting)} - {waiting}:
        other.select = _selecting_really(other.select)


def _selecting_really(real):
    """For who waits for another process, as subprocess does: it gets the real time, and then the robot's passes."""

    def select(self, timeout=None):
        found = real(self, timeout)
        if not found and timeout is not None and timeout > 0 and _now() is not None:
            _sleep(timeout)
        return found

    return select


def _selecting(real):
    """For who waits for others in this process, as asyncio does."""

    def select(self, timeout=None):
        if timeout is None or timeout <= 0 or _now() is None:
            return real(self, timeout)
        return _patiently(lambda: real(self, 0), timeout)

    return select


# --- alarms ---


def _alarm(seconds):
    global _alarm_is_set
    _alarm_is_set = True
    return _lib.alarm(max(int(seconds), 0))


def _fields(seconds, interval):
    """A timer as C has it: the period first, each in seconds and microseconds."""
    halves = [(int(value), int(round(1e6 * (value - int(value))))) for value in (interval, seconds)]
    return (_ctypes.c_long * 4)(*[field for half in halves for field in half])


def _setitimer(which, seconds, interval=0.0):
    global _alarm_is_set
    if which != _signal.ITIMER_REAL:
        return _real["setitimer"](which, seconds, interval)
    earlier = _fields(0.0, 0.0)
    _alarm_is_set = True
    if _lib.setitimer(which, _fields(seconds, interval), earlier) != 0:
        raise ValueError("%r, %r; expected seconds and a period of 0 or more" % (seconds, interval))
    return earlier[2] + earlier[3] / 1e6, earlier[0] + earlier[1] / 1e6


def _replace_signal():
    # The library has them where it takes the place of the C library's.
    if hasattr(_lib, "alarm") and hasattr(_lib, "setitimer"):
        _keep(_signal, "setitimer")
        _signal.alarm, _signal.setitimer = _alarm, _setitimer


def install(lib):
    """Replaces everything, once: eye.py may be loaded twice, by the runner for programs that bring one of their own,
    and by the program."""
    global _lib
    if _lib is not None:
        return
    _lib = lib
    _replace_time()
    _replace_datetime()
    _replace_threading()
    _replace_select()
    _replace_signal()
