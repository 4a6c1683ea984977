/* In the place of the X window system's header: what programs for EyeSim take from it. No window is ever opened. */
#ifndef EYESIM_XLIB_H
#define EYESIM_XLIB_H

#ifndef True
#define True 1
#endif
#ifndef False
#define False 0
#endif

#ifndef Bool
#define Bool int
#endif
#ifndef Status
#define Status int
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Types that headers of EyeBot programs name; nothing is behind them. */
typedef unsigned long XID, Window, Drawable, Font, Pixmap, Colormap, Atom;
typedef struct eyesim_Display Display;
typedef struct eyesim_Screen Screen;
typedef struct eyesim_GC *GC;
typedef struct eyesim_XFontStruct XFontStruct;
typedef struct {
    unsigned long pixel;
    unsigned short red, green, blue;
    char flags, pad;
} XColor;

int XInitThreads(void);

#ifdef __cplusplus
}
#endif

#endif
