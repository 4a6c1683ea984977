"""System, time, timers, and threads."""

import queue
import threading
import time
from eye import *

assert OSMachineName() == "EyeBot" and OSVersion().startswith("7") and OSVersionIO()
name = ctypes.create_string_buffer(50)
assert OSMachineName(name) == "EyeBot" and name.value == b"EyeBot"
assert OSMachineType() == 1 and OSMachineID() == 1 and OSMachineSpeed() > 0
assert OSExecute("echo x") == "x\n"
start, count = time.time(), OSGetCount()
time.sleep(2.5)
OSWait(500)
assert abs(time.time() - start - 3) < 0.01 and abs(OSGetCount() - count - 3000) <= 3
assert OSSetTime(10, 20, 30) == 0 and OSGetTime()[:3] == [10, 20, 30]
hours = ctypes.c_int(0)
OSGetTime(hours, ctypes.c_int(0), ctypes.c_int(0), ctypes.c_int(0))
assert hours.value == 10

calls = []
timer = OSAttachTimer(100, lambda: calls.append(1))
OSWait(1050)
assert 9 <= len(calls) <= 11, calls
# Its function is called as well while nothing else is.
while len(calls) < 20:
    pass
assert OSDetachTimer(timer) == 0

numbers, ready = queue.Queue(), threading.Event()


def count_up():
    for number in range(5):
        numbers.put(number)
        time.sleep(0.2)
    ready.set()


thread, start = threading.Thread(target=count_up), time.time()
thread.start()
assert ready.wait(30) and 0.9 < time.time() - start < 3
assert [numbers.get(timeout=1) for _ in range(5)] == [0, 1, 2, 3, 4]
try:
    numbers.get(timeout=1)
    raise SystemExit("nothing was there")
except queue.Empty:
    pass
thread.join()
assert not threading.Event().wait(0.5)
