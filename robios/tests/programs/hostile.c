/* Whatever a program passes, it gets a code. */
#include "check.h"
#include <sys/wait.h>
#include <limits.h>

#undef SERSend
#undef SERReceive
#undef SIMGetObject
#undef SIMSetObject
#undef RADIOCheck

static volatile sig_atomic_t rings;

/* Interrupts calls, and calls itself. */
static void ring(int number)
{
    (void)number;
    rings++;
    PSDGet(1), LCDPixel(1, 1, RED), PSDGet(2), OSWait(0);
}

static void interrupted(void)
{
    struct itimerval often = {{0, 500}, {0, 500}}, never = {{0, 0}, {0, 0}};

    signal(SIGALRM, ring);
    setitimer(ITIMER_REAL, &often, NULL);
    while (rings < 100)
        PSDGet(PSD_FRONT), LCDPixel(2, 2, GREEN);
    setitimer(ITIMER_REAL, &never, NULL);
}

int main(void)
{
    const int odd[] = {INT_MIN, -1000000, -1, 0, 1, 255, 1000000, INT_MAX};
    char text[256];
    unsigned i, j;
    pid_t child;
    int status;

    CHECK(LCDPrintf(NULL) == 1 && LCDSetPrintf(0, 0, NULL) == 1);
    CHECK(LCDGetPos(NULL, NULL) == 1 && LCDGetSize(NULL, NULL) == 1 && LCDMenu(NULL, NULL, NULL, NULL) == 0);
    CHECK(LCDMenuI(1, NULL, 0, 0) == 0 && LCDImage(NULL) == 1 && LCDImageGray(NULL) == 1 && LCDImageBinary(NULL) == 1);
    CHECK(KEYReadXY(NULL, NULL) == 1 && CAMInit(QQVGA) == 0 && CAMGet(NULL) == 1 && CAMGetGray(NULL) == 1);
    IPLaplace(NULL, NULL), IPSobel(NULL, NULL), IPCol2Gray(NULL, NULL), IPGray2Col(NULL, NULL);
    IPRGB2Col(NULL, NULL, NULL, NULL), IPCol2HSI(NULL, NULL, NULL, NULL), IPOverlay(NULL, NULL, NULL);
    IPOverlayGray(NULL, NULL, 0, NULL), IPPCol2RGB(0, NULL, NULL, NULL), IPPCol2HSI(0, NULL, NULL, NULL);
    IPPRGB2HSI(0, 0, 0, NULL, NULL, NULL);
    CHECK(IPReadFile(NULL, NULL) == -1 && IPWriteFile(NULL, NULL) == 1 && IPWriteFileGray("x", NULL) == 1);
    CHECK(OSExecute(NULL, NULL) == 1 && OSVersion(NULL) == 1 && OSVersionIO(NULL) == 1 && OSMachineName(NULL) == 1);
    CHECK(OSAttachTimer(1, NULL) == 0 && OSGetTime(NULL, NULL, NULL, NULL) == 1);
    CHECK(SERInit(0, 9600, 0) == 0 && SERSend(0, NULL) == 1 && SERReceive(0, NULL) == 0 && AUPlay(NULL) == 1);
    CHECK(eyesim_SERSendN(0, NULL, UINT_MAX) == 1 && eyesim_SERReceiveN(0, text, INT_MIN) == 0);
    CHECK(LIDARGet(NULL) == 1 && VWGetSpeed(NULL, NULL) == 1 && VWGetPosition(NULL, NULL, NULL) == 1);
    CHECK(RADIOSend(1, NULL) == 1 && RADIOReceive(NULL, NULL, 100) == 0 && RADIOReceive(NULL, text, -5) == 0);
    CHECK(RADIOStatus(NULL) == 0 && ANALOGTransfer(NULL) == 0);
    SIMGetRobot(0, NULL, NULL, NULL, NULL), SIMGetObject(1, NULL, NULL, NULL, NULL), SIMGetPose(NULL, NULL, NULL);
    for (i = 0; i < sizeof odd / sizeof *odd; i++)
        for (j = 0; j < sizeof odd / sizeof *odd; j++) {
            int a = odd[i], b = odd[j];
            LCDSetPos(a, b), LCDPrintf("x\n"), LCDSetPrintf(a, b, "%d", a), LCDSetColor(a, b), LCDSetFont(a, b);
            LCDSetFontSize(a), LCDSetMode(a), LCDPixel(a, b, a), LCDGetPixel(a, b), LCDLine(a, b, b, a, a);
            LCDArea(a, b, b, a, a, b), LCDCircle(a, b, a, b, 0), LCDImageStart(a, b, a, b), LCDImageSize(a == 10 ? 0 : a);
            PSDGet(a), LIDARSet(a, b, a), SERVOSet(a, b), SERVOGet(a), MOTORDrive(a, b), MOTORSpeed(a, b);
            ENCODERRead(a), ENCODERReset(a), VWSetSpeed(a, b), VWSetPosition(a, b, a), VWStraight(a, b), VWTurn(a, b);
            VWCurve(a, b, a), VWDrive(a, b, a), VWRemain(), DIGITALRead(a), DIGITALWrite(a, b), ANALOGRead(a);
            ANALOGRecord(a, b > 1000 ? 1000 : b), SIMSetRobot(a, b, a, b, a), SIMSetObject(a, b, a, b, a);
            SERInit(a, b, a), SERCheck(a), OSSetTime(a, b, a), OSDetachTimer(a), OSMachineID();
        }
    VWSetSpeed(0, 0);
    interrupted();
    /* A child has no robot, and does not disturb its parent's. */
    child = fork();
    if (child == 0) {
        int failed = LCDPrintf("child") == 1 && PSDGet(1) == 0 && VWSetSpeed(1, 1) == 1 && OSWait(10) == 1;
        _exit(failed ? 0 : 1);
    }
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CHECK(LCDClear() == 0 && LCDPrintf("survived\n") == 0);
    return 0;
}
