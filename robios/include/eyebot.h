/* The functions of RoBIOS-7, for programs in C and C++: lengths in millimetres, angles in degrees counter-clockwise.
 * Unless said otherwise a function returns 0 when it has succeeded and 1 when it has failed. */
#ifndef EYESIM_EYEBOT_H
#define EYESIM_EYEBOT_H

#include "types.h"

/* Texts are constant for C++ alone: programs in C have prototypes of their own without it. */
#ifdef __cplusplus
#define EYESIM_TEXT const char *
extern "C" {
#else
#define EYESIM_TEXT char *
#endif

/* Display: 480 x 320 pixels */
int LCDPrintf(const char *format, ...);
int LCDSetPrintf(int row, int column, const char *format, ...);
int LCDClear(void);
int LCDSetPos(int row, int column);
int LCDGetPos(int *row, int *column);
int LCDSetColor(COLOR fg, COLOR bg);
int LCDSetFont(int font, int variation);
int LCDSetFontSize(int fontsize);
int LCDFontSize(int fontsize);
int LCDSetMode(int mode);
int LCDMenu(EYESIM_TEXT st1, EYESIM_TEXT st2, EYESIM_TEXT st3, EYESIM_TEXT st4);
int LCDMenuI(int pos, EYESIM_TEXT string, COLOR fg, COLOR bg); /* pos 1 to 4 */
int LCDGetSize(int *x, int *y);
int LCDPixel(int x, int y, COLOR col);
COLOR LCDGetPixel(int x, int y);
int LCDLine(int x1, int y1, int x2, int y2, COLOR col);
int LCDArea(int x1, int y1, int x2, int y2, COLOR col, int fill);
int LCDCircle(int x1, int y1, int size, COLOR col, int fill);
int LCDImageSize(int t);
int LCDImageStart(int x, int y, int xs, int ys);
int LCDImage(BYTE *img);
int LCDImageGray(BYTE *g);
int LCDImageBinary(BYTE *b); /* 0 white, 1 black */
int LCDRefresh(void);

/* Keys */
int KEYGet(void);          /* waits; returns KEY1 to KEY4 */
int KEYRead(void);         /* does not wait; NOKEY if none was pressed */
int KEYWait(int key);      /* waits for one of these; returns it */
int KEYGetXY(int *x, int *y);
int KEYReadXY(int *x, int *y);

/* Camera: images from the upper left, red, green and blue */
int CAMInit(int resolution);
int CAMRelease(void);
int CAMGet(BYTE *buf);
int CAMGetGray(BYTE *buf);

/* Image processing, at the resolution of CAMInit or IPSetSize */
int IPSetSize(int resolution);
int IPReadFile(EYESIM_TEXT filename, BYTE *img); /* 3 colour, 2 gray, 1 binary, -1 failure */
int IPWriteFile(EYESIM_TEXT filename, BYTE *img);
int IPWriteFileGray(EYESIM_TEXT filename, BYTE *gray);
void IPLaplace(BYTE *grayIn, BYTE *grayOut);
void IPSobel(BYTE *grayIn, BYTE *grayOut);
void IPCol2Gray(BYTE *imgIn, BYTE *grayOut);
void IPGray2Col(BYTE *grayIn, BYTE *imgOut);
void IPRGB2Col(BYTE *r, BYTE *g, BYTE *b, BYTE *imgOut);
void IPCol2HSI(BYTE *img, BYTE *h, BYTE *s, BYTE *i);
void IPOverlay(BYTE *c1, BYTE *c2, BYTE *cOut);
void IPOverlayGray(BYTE *g1, BYTE *g2, COLOR col, BYTE *cOut);
COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b);
void IPPCol2RGB(COLOR col, BYTE *r, BYTE *g, BYTE *b);
void IPPCol2HSI(COLOR col, BYTE *h, BYTE *s, BYTE *i);
BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b); /* 0 for grays */
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE *h, BYTE *s, BYTE *i);

/* System */
int OSExecute(EYESIM_TEXT command, char *result); /* at most 128 bytes of what it prints */
int OSVersion(char *buf);
int OSVersionIO(char *buf);
int OSMachineSpeed(void);
int OSMachineType(void);
int OSMachineName(char *buf);
int OSMachineID(void);
int OSError(EYESIM_TEXT msg, int number, int dead);

/* Time */
int OSWait(int n); /* milliseconds */
TIMER OSAttachTimer(int scale, void (*fct)(void)); /* called every `scale` milliseconds; 0 for failure */
int OSDetachTimer(TIMER t);
int OSSetTime(int hrs, int mins, int secs);
int OSGetTime(int *hrs, int *mins, int *secs, int *ticks);
int OSGetCount(void); /* milliseconds since the start */

/* Serial ports, looped back */
int SERInit(int interface_, int baud, int handshake);
int SERSendChar(int interface_, char ch);
int SERSend(int interface_, EYESIM_TEXT buf);
int eyesim_SERSendN(int interface_, EYESIM_TEXT buf, uint32_t size);
char SERReceiveChar(int interface_);
int SERReceive(int interface_, char *buf); /* at most 128 bytes; returns how many */
int eyesim_SERReceiveN(int interface_, char *buf, int size);
int SERCheck(int interface_);
int SERFlush(int interface_);
int SERClose(int interface_);

/* Sound */
int AUBeep(void);
int AUPlay(EYESIM_TEXT sample);
int AUDone(void);
int AUMicrophone(void);

/* Distance sensors: 9999 if there is nothing within range */
int PSDGet(int psd);
int PSDGetRaw(int psd);
int LIDARGet(int distance[]); /* LIDAR_RESOLUTION distances, clockwise from behind */
#ifdef EYESIM_OWN_PROTOTYPES
void LIDARSet(int range, int tilt, int points); /* as in the headers of some years, and in prototypes of programs */
#else
int LIDARSet(int range, int tilt, int points);
#endif

/* Servos and motors */
int SERVOSet(int servo, int angle); /* 0 to 255 */
int SERVOSetRaw(int servo, int angle);
int SERVORange(int servo, int low, int high);
int SERVOGet(int servo);
int SERVODone(int servo);
int SERVOWait(int servo);
int SERVOStalled(int servo);
int SERVOSetAngle(int servo, int angle);
int SERVOSetExtension(int servo, int extension);
int MOTORDrive(int motor, int speed); /* -100 to 100 percent */
int MOTORDriveRaw(int motor, int speed);
int MOTORPID(int motor, int p, int i, int d);
int MOTORPIDOff(int motor);
int MOTORPIDoff(int motor);
int MOTORSpeed(int motor, int ticks); /* ticks in 10 ms */
int ENCODERRead(int quad);
int ENCODERReset(int quad);

/* Driving */
int VWSetSpeed(int linSpeed, int angSpeed);
int VWGetSpeed(int *linSpeed, int *angSpeed);
int VWSetPosition(int x, int y, int phi);
int VWGetPosition(int *x, int *y, int *phi);
int VWStraight(int dist, int lin_speed);
int VWTurn(int angle, int ang_speed);
int VWCurve(int dist, int angle, int lin_speed);
int VWDrive(int dx, int dy, int lin_speed);
int VWRemain(void);
int VWDone(void); /* 1 if no drive is running */
int VWWait(void);
int VWStalled(void); /* 3 if something holds the robot */
int VWControl(int Vv, int Tv, int Vw, int Tw);
int VWControlOff(void);

/* Digital and analog lines */
int DIGITALSetup(int io, char direction); /* i, o, I with pull-up, J with pull-down */
int DIGITALRead(int io);
int DIGITALReadAll(void);
int DIGITALWrite(int io, int state);
int ANALOGRead(int channel);
int ANALOGVoltage(void); /* hundredths of a volt */
int ANALOGRecord(int channel, int iterations);
int ANALOGTransfer(BYTE *buffer);

/* Remote control */
int IRTVGet(void);
int IRTVRead(void);
int IRTVFlush(void);
int IRTVGetStatus(void);

/* Radio */
int RADIOInit(void);
int RADIOGetID(void);
int RADIOSend(int id, EYESIM_TEXT buf); /* 0 for all others */
int RADIOReceive(int *id_no, char *buf, int size); /* waits; returns the length */
#ifdef EYESIM_OWN_PROTOTYPES
int RADIOCheck(int *id_no) __asm__("eyesim_RADIOCheckFrom");
#else
int RADIOCheck(void); /* 1 if a message waits; also with an int *id_no */
#endif
int eyesim_RADIOCheckFrom(int *id_no);
int RADIOStatus(int IDlist[]);
int RADIORelease(void);

/* The simulated world: robots and objects from 1, robot 0 for the program's own; headings as in world files */
void SIMGetRobot(int id, int *x, int *y, int *z, int *phi);
void SIMSetRobot(int id, int x, int y, int z, int phi);
void SIMGetObject(int id, int *x, int *y, int *z, int *phi);
void SIMSetObject(int id, int x, int y, int z, int phi);
void eyesim_SIMGetObject4(int id, int *x, int *y, int *phi);
void eyesim_SIMSetObject4(int id, int x, int y, int phi);
int SIMGetRobotCount(void);
int SIMGetObjectCount(void);
void SIMGetPose(int *x, int *y, int *phi);
void SIMSetPose(int x, int y, int phi);
int SIMLaserScan(int *distance);

#ifndef EYESIM_FEW_NAMES
/* Names of the first years */
int VWDriveRemain(void);
int VWDriveDone(void);
int VWDriveWait(void);
int LCDInit(void);
int LCDPixelInvert(int x, int y);
int LCDLineInvert(int x1, int y1, int x2, int y2);
int LCDAreaInvert(int x1, int y1, int x2, int y2);
int LCDCircleInvert(int x1, int y1, int size);
int AUTone(int freq, int time);
int AUCheckTone(void);
int AUCheckPlay(void);
int AURecord(BYTE *buf, int time, long freq);
int AUCheckRecord(void);
int MTInit(void);
int MTSleep(int n); /* hundredths of a second */
TASK MTSpawn(void *(*fct)(void *), int id);
int MTGetUID(TASK t);
int MTKill(TASK t);
int SEMAInit(SEMA *sem, int val);
int SEMALock(SEMA *sem);
int SEMAUnlock(SEMA *sem);
#endif

#ifdef __cplusplus
}

/* The forms in which functions were called in other years; of C++, even where a program includes this as C */
extern "C++" {

static inline int SERSend(int interface_, EYESIM_TEXT buf, uint32_t size)
{
    return eyesim_SERSendN(interface_, buf, size);
}

static inline int SERReceive(int interface_, char *buf, int size)
{
    return eyesim_SERReceiveN(interface_, buf, size);
}

static inline int SERReceive(int interface_, unsigned char *buf)
{
    return SERReceive(interface_, reinterpret_cast<char *>(buf));
}

static inline int RADIOCheck(int *id_no)
{
    return eyesim_RADIOCheckFrom(id_no);
}

static inline void SIMGetObject(int id, int *x, int *y, int *phi)
{
    eyesim_SIMGetObject4(id, x, y, phi);
}

static inline void SIMSetObject(int id, int x, int y, int phi)
{
    eyesim_SIMSetObject4(id, x, y, phi);
}

}

#else

/* The forms in which functions were called in other years: by the number of arguments */
#define EYESIM_FOURTH(a, b, c, d, ...) d
#define EYESIM_SIXTH(a, b, c, d, e, f, ...) f
#define EYESIM_POINTERS(...) ((int *[]){0, __VA_ARGS__})
#define EYESIM_LAST(...) EYESIM_POINTERS(__VA_ARGS__)[sizeof EYESIM_POINTERS(__VA_ARGS__) / sizeof(int *) - 1]

#define SERSend(...) EYESIM_FOURTH(__VA_ARGS__, eyesim_SERSendN, SERSend, 0, 0)(__VA_ARGS__)
#define SERReceive(...) EYESIM_FOURTH(__VA_ARGS__, eyesim_SERReceiveN, SERReceive, 0, 0)(__VA_ARGS__)
#define SIMGetObject(...) EYESIM_SIXTH(__VA_ARGS__, SIMGetObject, eyesim_SIMGetObject4, 0, 0, 0)(__VA_ARGS__)
#define SIMSetObject(...) EYESIM_SIXTH(__VA_ARGS__, SIMSetObject, eyesim_SIMSetObject4, 0, 0, 0)(__VA_ARGS__)
#ifndef EYESIM_OWN_PROTOTYPES
#define RADIOCheck(...) eyesim_RADIOCheckFrom(EYESIM_LAST(__VA_ARGS__))
#endif

#endif

#endif
