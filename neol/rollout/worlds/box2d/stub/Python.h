// pybox2d's b2Settings.h asks for Python.h only to name a failed assertion before it throws
// b2AssertException. This is all of Python that Box2D needs; the core catches the exception.
#pragma once

#include <cfloat>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#define PyExc_AssertionError nullptr
inline void PyErr_SetString(const void* /*kind*/, const char* /*condition*/) {}
