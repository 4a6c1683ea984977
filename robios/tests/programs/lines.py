"""Serial ports, sound, digital and analog lines."""

from eye import *

assert SERInit(0, 9600, NONE) == 0 and SERSend(0, "abc") == 0 and SERCheck(0) == 3
assert SERReceiveChar(0) == "a" and SERReceive(0) == "bc" and SERReceive(0) == ""
buffer = ctypes.create_string_buffer(10)
SERSendChar(0, "z")
assert SERReceive(0, buffer, 10) == "z" and buffer.value == b"z"
assert SERFlush(0) == 0 and SERClose(0) == 0 and SERSend(0, "x") == 1
assert AUBeep() == 0 and AUDone() == 0 and AUPlay("tune.wav") == 0 and AUMicrophone() == 0
OSWait(600)
assert AUDone() == 1
assert DIGITALSetup(9, "o") == 0 and DIGITALWrite(9, 1) == 0 and DIGITALRead(9) == 1
assert DIGITALSetup(1, "I") == 0 and DIGITALRead(1) == 1 and DIGITALReadAll() & 1
assert ANALOGVoltage() == ANALOGRead(0) == 820
assert ANALOGRecord(8, 5) == 0 and len(ANALOGTransfer()) == 5
