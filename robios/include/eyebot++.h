/* RoBIOS-7 for programs in C++. eyebot.h serves C++ as well. */
#ifndef EYESIM_EYEBOTPP_H
#define EYESIM_EYEBOTPP_H

#include "eyebot.h"

#endif
