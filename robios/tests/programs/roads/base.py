"""The base station: draws the cars that it hears, stops them for some seconds once it has heard all of them, sees that
they obey, and ends their programs, as base.c does.
"""
import sys

from eye import *

STOP, GO, END, LONGEST, PERIOD = 6000, 10000, 14000, 100000, 200
COLOURS = (RED, GREEN, BLUE, YELLOW, CYAN, MAGENTA, ORANGE, WHITE)

RADIOInit()
others = RADIOStatus()[0] - 1
LCDMenu("STOP", "GO", "", "")
heard, stood, went_on, due, begin, now = {}, set(), set(), 0, 0, 0
while now < END and OSGetCount() < LONGEST:
    while RADIOCheck():
        number, text = RADIOReceive(80)[:2]
        words = text.split()
        if len(words) != 8 or words[0] != "car":
            continue
        x, y, _, speed, _ = (float(word) for word in words[1:6])
        if number not in heard:
            begin = OSGetCount()
        heard[number] = heard.get(number, 0) + 1
        if speed == 0:
            stood.add(number)
        elif number in stood:
            went_on.add(number)
        # A metre is 60 pixels; cars begin in the middle.
        LCDPixel(240 + int(60 * x), 180 - int(60 * y), COLOURS[number % len(COLOURS)])
        row = sorted(heard).index(number)
        LCDSetPrintf(row, 0, "car %d  %4.2f m/s  %d reports  " % (number, speed, heard[number]))
    now = OSGetCount() - begin if len(heard) == others else 0
    if OSGetCount() >= due:
        RADIOSend(0, "stop" if STOP < now < GO else "go")
        due = OSGetCount() + PERIOD
    OSWait(50)
RADIOSend(0, "end")
RADIORelease()
if len(heard) != others or set(heard) != went_on or min(heard.values()) <= 2 * END / 1000:
    sys.exit("heard %s, stood %s, went on %s" % (heard, stood, went_on))
