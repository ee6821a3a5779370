/* What both halves of the test runtime share: the script, the log, and the one instance, session and swapchain. */
#ifndef MIMICS_TEST_STATE_H
#define MIMICS_TEST_STATE_H
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "xr.h"

#define MOST_EVENTS 64
#define EPOCH_NS 7000000000000LL /* XrTime minus CLOCK_MONOTONIC: who forgets to convert is hours off */

typedef struct { double x, y, z, qx, qy, qz, qw; } Pose;
typedef struct { int frame; char what[32]; } Scripted;

typedef struct {
    char log[512], dump[512];
    int width, height, count, no_headset, steals_context, refusals, moves;
    unsigned formats[4];
    int format_count;
    double rate;
    Pose head;
    Scripted events[MOST_EVENTS];
} Script;

enum { CHAIN = 0x51, SESSION = 0x52, INSTANCE = 0x53, ACTION_SET = 0x54, LOCAL = 0x55, ACTIONS = 0x100, SPACES = 0x200 };
enum { ALL_IS_WELL, SESSION_IS_LOST, INSTANCE_IS_LOST };

extern Script script;
extern int instance_open, lost, asked_requirements, head_known, pressed, state, frames_waited, exits;
extern int session_open, session_running;

void read_script(void);
void note(const char *format, ...);
XrResult answer(const char *call, XrResult result);
void enter_state(int next);
int next_state(void);
XrTime xr_now(void);
void free_session(void);
void play_script(void);
void view_poses(XrTime time, XrView *views);
XrVoidFunction frame_function(const char *name);
Pose in_head(Pose head, Pose part);
Pose head_at(XrTime time);
XrPosef to_xr(Pose pose);
#endif
