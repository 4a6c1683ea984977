/* What a simulated robot has no counterpart for. */
#include "check.h"

int main(void)
{
    char text[64];
    BYTE samples[100];

    CHECK(SERInit(1, 9600, NONE) == 0 && SERInit(99, 9600, NONE) == 1 && SERInit(1, 3, RTSCTS) == 1);
    CHECK(SERSend(1, "hello") == 0 && SERSend(1, "xyz", 2) == 0 && SERSendChar(1, '!') == 0);
    CHECK(SERCheck(1) == 8 && SERReceiveChar(1) == 'h');
    CHECK(SERReceive(1, text, sizeof text) == 7 && strcmp(text, "elloxy!") == 0);
    CHECK(SERReceive(1, text) == 0 && SERReceiveChar(1) == 0);
    CHECK(SERFlush(1) == 0 && SERClose(1) == 0 && SERClose(1) == 1 && SERSend(1, "x") == 1);
    CHECK(AUBeep() == 0 && AUPlay("sound.wav") == 0 && AUDone() == 0 && AUMicrophone() == 0);
    OSWait(600);
    CHECK(AUDone() == 1);
    CHECK(DIGITALRead(1) == 1 && DIGITALRead(9) == 0);
    CHECK(DIGITALWrite(9, 1) == 0 && DIGITALRead(9) == 1 && DIGITALReadAll() == 0x1FF);
    CHECK(DIGITALWrite(1, 1) == 1 && DIGITALSetup(1, 'o') == 0 && DIGITALWrite(1, 0) == 0 && DIGITALRead(1) == 0);
    CHECK(DIGITALSetup(2, 'J') == 0 && DIGITALRead(2) == 0 && DIGITALSetup(17, 'i') == 1 && DIGITALSetup(1, 'q') == 1);
    CHECK(ANALOGVoltage() == 820 && ANALOGRead(1) == 0 && ANALOGRecord(8, 50) == 0 && ANALOGTransfer(samples) == 50);
    CHECK(SERVOSet(5, 200) == 0 && SERVOGet(5) == 200 && SERVODone(5) == 1 && SERVOWait(5) == 0 && SERVOStalled(5) == 0);
    CHECK(SERVOSet(5, 300) == 0 && SERVOGet(5) == 255 && SERVOSet(0, 1) == 1 && SERVORange(1, 10, 20) == 0 && SERVOSetAngle(6, 9) == 0);
    return 0;
}
