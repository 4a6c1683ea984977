/* In the place of the X window system's header: what programs for EyeSim take from it. No window is ever opened. */
#ifndef EYESIM_XLIB_H
#define EYESIM_XLIB_H

#ifndef True
#define True 1
#endif
#ifndef False
#define False 0
#endif

#ifdef __cplusplus
extern "C" {
#endif

int XInitThreads(void);

#ifdef __cplusplus
}
#endif

#endif
