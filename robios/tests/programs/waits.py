"""Every way to wait and to ask for the time follows the robot's clock."""

import asyncio
import datetime
import queue
import select
import signal
import subprocess
import threading
import time
from datetime import date, datetime as moment, timedelta

import eyebot
from eye import *

assert eyebot.VWStraight is VWStraight


def takes(seconds, function, *arguments, **options):
    start = time.time()
    result = function(*arguments, **options)
    assert abs(time.time() - start - seconds) < 0.1, (function, time.time() - start)
    return result


assert takes(10, threading.Event().wait, 10) is False
assert takes(10, select.select, [], [], [], 10) == ([], [], [])
try:
    takes(10, queue.Queue().get, timeout=10)
    assert False
except queue.Empty:
    pass
sleeper = threading.Thread(target=time.sleep, args=(5,))
sleeper.start()
takes(2, sleeper.join, 2)
takes(3, sleeper.join)


async def both():
    async def drive():
        await asyncio.sleep(10)
        return 1

    assert await asyncio.gather(drive(), drive()) == [1, 1]
    try:
        await asyncio.wait_for(asyncio.Event().wait(), 10)
        assert False
    except asyncio.TimeoutError:
        pass


takes(20, asyncio.run, both())

assert subprocess.run(["sh", "-c", "sleep 0.3; echo out"], capture_output=True, timeout=5).stdout == b"out\n"

now = moment.now()
assert now.year == 2020 and date.today() == now.date() and isinstance(now, datetime.datetime)
assert isinstance(now + timedelta(1), moment) and moment.utcnow().hour >= 12
time.sleep(60)
assert abs((moment.now() - now).total_seconds() - 60) < 0.1
assert time.localtime().tm_year == time.gmtime().tm_year == 2020 and "2020" in time.ctime()
assert time.strftime("%Y") == "2020" and time.asctime().endswith("2020")
for clock in (time.clock_gettime, time.clock_gettime_ns):
    assert clock(time.CLOCK_MONOTONIC) > 60
assert abs(time.monotonic() - time.perf_counter()) < 0.1

rings = []
signal.signal(signal.SIGALRM, lambda *_: rings.append(time.time()))
signal.alarm(10)
time.sleep(20)
signal.setitimer(signal.ITIMER_REAL, 1.0, 0.5)
time.sleep(3.2)
rest, period = signal.setitimer(signal.ITIMER_REAL, 0)
assert 0 < rest <= 0.5 and period == 0.5
assert len(rings) == 6, rings
LCDPrintf("all waits are over")
