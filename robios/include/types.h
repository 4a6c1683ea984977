/* Types, constants and variables of RoBIOS-7, for programs in C and C++.
 *
 * Constants are macros, so that a program that defines one of them alike is none the worse for it. */
#ifndef EYESIM_TYPES_H
#define EYESIM_TYPES_H

/* Programs use what is beyond the C standard: usleep, M_PI, ... */
#if !defined(_DEFAULT_SOURCE) && !defined(_GNU_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _DEFAULT_SOURCE 1
#endif

/* Programs rely on getting these with eyebot.h. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

/* What programs take from the X window system, which this library does not need. */
#ifndef True
#define True 1
#endif
#ifndef False
#define False 0
#endif

typedef int COLOR;
typedef int TIMER;
typedef unsigned char BYTE;

/* Resolutions of camera, image processing and display */
#define QQVGA 0
#define QVGA 1
#define VGA 2
#define CAM1MP 3
#define CAMHD 4
#define CAM5MP 5
#define CUSTOM 10

#define QQVGA_X 160
#define QQVGA_Y 120
#define QVGA_X 320
#define QVGA_Y 240
#define VGA_X 640
#define VGA_Y 480
#define CAM1MP_X 1296
#define CAM1MP_Y 730
#define CAMHD_X 1920
#define CAMHD_Y 1080
#define CAM5MP_X 2592
#define CAM5MP_Y 1944

#define QQVGA_PIXELS (QQVGA_X * QQVGA_Y)
#define QVGA_PIXELS (QVGA_X * QVGA_Y)
#define VGA_PIXELS (VGA_X * VGA_Y)
#define CAM1MP_PIXELS (CAM1MP_X * CAM1MP_Y)
#define CAMHD_PIXELS (CAMHD_X * CAMHD_Y)
#define CAM5MP_PIXELS (CAM5MP_X * CAM5MP_Y)

#define QQVGA_SIZE (3 * QQVGA_PIXELS)
#define QVGA_SIZE (3 * QVGA_PIXELS)
#define VGA_SIZE (3 * VGA_PIXELS)
#define CAM1MP_SIZE (3 * CAM1MP_PIXELS)
#define CAMHD_SIZE (3 * CAMHD_PIXELS)
#define CAM5MP_SIZE (3 * CAM5MP_PIXELS)

typedef BYTE QQVGAcol[QQVGA_SIZE];
typedef BYTE QVGAcol[QVGA_SIZE];
typedef BYTE VGAcol[VGA_SIZE];
typedef BYTE CAM1MPcol[CAM1MP_SIZE];
typedef BYTE CAMHDcol[CAMHD_SIZE];
typedef BYTE CAM5MPcol[CAM5MP_SIZE];
typedef BYTE QQVGAgray[QQVGA_PIXELS];
typedef BYTE QVGAgray[QVGA_PIXELS];
typedef BYTE VGAgray[VGA_PIXELS];
typedef BYTE CAM1MPgray[CAM1MP_PIXELS];
typedef BYTE CAMHDgray[CAMHD_PIXELS];
typedef BYTE CAM5MPgray[CAM5MP_PIXELS];

#define CAM_SUCCESS 0
#define CAM_FAILURE 1

/* Colours */
#define RED 0xFF0000
#define GREEN 0x00FF00
#define BLUE 0x0000FF
#define WHITE 0xFFFFFF
#define GRAY 0x808080
#define BLACK 0x000000
#define SILVER 0xC0C0C0
#define LIGHTGRAY 0xD3D3D3
#define DARKGRAY 0xA9A9A9
#define NAVY 0x000080
#define CYAN 0x00EEEE
#define TEAL 0x008080
#define MAGENTA 0xFF00FF
#define PURPLE 0x800080
#define MAROON 0x800000
#define YELLOW 0xFFFF00
#define OLIVE 0x9ACD32
#define ORANGE 0xFFA500

/* Keys */
#define NOKEY 0
#define KEY1 1
#define KEY2 2
#define KEY3 4
#define KEY4 8
#define ANYKEY ((int)0xFFFFFFFF)
#define KEY_ESCAPE 0x80000000
#define KEY_LISTTL 0x40000000
#define KEY_LISTUP 0x20000000
#define KEY_LISTDN 0x10000000
#define KEY_LIST1 0x00000010
#define KEY_LIST2 0x00000020
#define KEY_LIST3 0x00000040
#define KEY_LIST4 0x00000080
#define KEY_LIST5 0x00000100
#define KEY_LIST6 0x00000200
#define KEY_LIST7 0x00000400
#define KEY_LIST8 0x00000800
#define KEY_INVALID 0xFFFFFFFF
#define KEYTM_MAX_REGIONS 32
#define MENU_HEIGHT 38

/* Remote control */
#define IRTV_0 '0'
#define IRTV_1 '1'
#define IRTV_2 '2'
#define IRTV_3 '3'
#define IRTV_4 '4'
#define IRTV_5 '5'
#define IRTV_6 '6'
#define IRTV_7 '7'
#define IRTV_8 '8'
#define IRTV_9 '9'
#define IRTV_RED 'R'
#define IRTV_GREEN 'G'
#define IRTV_YELLOW 'Y'
#define IRTV_BLUE 'B'
#define IRTV_LEFT 'L'
#define IRTV_RIGHT '>'
#define IRTV_UP 'U'
#define IRTV_DOWN 'D'
#define IRTV_OK 'O'
#define IRTV_POWER 'P'

/* Fonts */
#define HELVETICA 0
#define TIMES 1
#define COURIER 2
#define NORMAL 0
#define BOLD 1
#define ITALICS 2

/* Modes of the display */
#define LCD_AUTOREFRESH 0x000001
#define LCD_NOAUTOREFRESH 0x000100
#define LCD_SCROLLING 0x000002
#define LCD_NOSCROLLING 0x000200
#define LCD_LINEFEED 0x000004
#define LCD_NOLINEFEED 0x000400
#define LCD_SHOWMENU 0x000008
#define LCD_HIDEMENU 0x000800
#define LCD_LISTMENU 0x000010
#define LCD_CLASSICMENU 0x001000
#define LCD_FB_ROTATE 0x000080
#define LCD_FB_NOROTATION 0x008000
#define LCD_BGCOL_TRANSPARENT 0x010000
#define LCD_BGCOL_NOTRANSPARENT 0x100000
#define LCD_BGCOL_INVERSE 0x020000
#define LCD_BGCOL_NOINVERSE 0x200000
#define LCD_FGCOL_INVERSE 0x040000
#define LCD_FGCOL_NOINVERSE 0x400000

/* What headers of some years lack, so that programs may have names of their own like these: left out on demand. */
#ifndef EYESIM_NO_PSD_NAMES
/* Distance sensors, by the simulator's numbers */
#define PSD_FRONT 1
#define PSD_LEFT 2
#define PSD_RIGHT 3
#define PSD_BACK 4
#endif

#ifndef EYESIM_FEW_NAMES

/* Serial ports */
#define NONE 0
#define RTSCTS 1

#define PLATFORM 2
#define WALKER 3
#define LIDAR_POINTS LIDAR_RESOLUTION
#define LIDAR_RANGE 360

typedef sem_t SEMA;
typedef struct {
    pthread_t thread;
    int identifier;
} TASK;

#endif

#define VERSION "1.0"
#define VEHICLE 1
#define MACHINE_TYPE VEHICLE
#define MACHINE_NAME "EyeBot"
#define HDT_FILE "/home/pi/eyebot/hdt.txt"

#ifdef __cplusplus
extern "C" {
#endif

/* Set by CAMInit. */
extern int CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE;
/* Set by CAMInit and IPSetSize. */
extern int IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE;
/* How many distances LIDARGet writes; set by LIDARSet. */
extern int LIDAR_RESOLUTION;

int XInitThreads(void);

#ifdef __cplusplus
}
#endif

#endif
