/* An OpenXR runtime for tests: no headset, a script instead, and an error for every call out of order.
 *
 * MIMICS_XR_SCRIPT names the script, a line each:
 *   log FILE | dump FOLDER | size W H | rate HZ | formats HEX ... | head X Y Z QX QY QZ QW | moves | no_headset
 *   steals_context            no context is current after it was called
 *   refusals N                so often no instance can be had after a loss
 *   at FRAME EVENT            hide show stop exit lose_head find_head press release session_lost loss_pending instance_lost
 */
#include <stdarg.h>
#include "state.h"

Script script;
int instance_open, lost, asked_requirements, head_known = 1, pressed, state, frames_waited, exits;
static int states[MOST_EVENTS], first_state, state_count, refused, was_lost, paths;
static char path_names[64][96];

void note(const char *format, ...) {
    FILE *file = script.log[0] ? fopen(script.log, "a") : NULL;
    if (!file) return;
    va_list rest;
    va_start(rest, format);
    vfprintf(file, format, rest);
    va_end(rest);
    fputc('\n', file);
    fclose(file);
}

XrResult answer(const char *call, XrResult result) {
    if (result >= 0 && lost == INSTANCE_IS_LOST) result = XR_ERROR_INSTANCE_LOST;
    note("%s %d", call, result);
    return result;
}

void read_script(void) {
    static char known[512];
    const char *name = getenv("MIMICS_XR_SCRIPT");
    if (name && !strcmp(name, known)) return; /* the loader asks anew for every instance, a script is played once */
    strncpy(known, name ? name : "", sizeof known - 1);
    memset(&script, 0, sizeof script);
    lost = pressed = frames_waited = exits = refused = was_lost = instance_open = 0, head_known = 1;
    script.width = 64, script.height = 48, script.rate = 90.0, script.head.qw = 1.0;
    script.formats[0] = 0x8C43, script.format_count = 1;
    FILE *file = name ? fopen(name, "r") : NULL;
    if (!file) return;
    char line[600];
    while (fgets(line, sizeof line, file)) {
        Scripted *event = &script.events[script.count];
        Pose *head = &script.head;
        sscanf(line, "log %511s", script.log);
        sscanf(line, "dump %511s", script.dump);
        sscanf(line, "size %d %d", &script.width, &script.height);
        sscanf(line, "rate %lf", &script.rate);
        sscanf(line, "refusals %d", &script.refusals);
        sscanf(line, "head %lf %lf %lf %lf %lf %lf %lf", &head->x, &head->y, &head->z, &head->qx, &head->qy, &head->qz,
               &head->qw);
        if (sscanf(line, "formats %x %x", &script.formats[0], &script.formats[1]) >= 1)
            script.format_count = sscanf(line, "formats %x %x", &script.formats[0], &script.formats[1]);
        if (!strncmp(line, "moves", 5)) script.moves = 1;
        if (!strncmp(line, "no_headset", 10)) script.no_headset = 1;
        if (!strncmp(line, "steals_context", 14)) script.steals_context = 1;
        if (script.count < MOST_EVENTS && sscanf(line, "at %d %31s", &event->frame, event->what) == 2) script.count++;
    }
    fclose(file);
}

XrTime xr_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000000000LL + now.tv_nsec + EPOCH_NS;
}

void enter_state(int next) { states[(first_state + state_count++) % MOST_EVENTS] = next; }

int next_state(void) {
    if (!state_count) return 0;
    state_count--;
    return states[first_state++ % MOST_EVENTS];
}

/* ---- poses ---- */

static void turn(const Pose *by, double *v) {
    double x = by->qx, y = by->qy, z = by->qz, w = by->qw;
    double tx = 2 * (y * v[2] - z * v[1]), ty = 2 * (z * v[0] - x * v[2]), tz = 2 * (x * v[1] - y * v[0]);
    double a = v[0] + w * tx + y * tz - z * ty, b = v[1] + w * ty + z * tx - x * tz, c = v[2] + w * tz + x * ty - y * tx;
    v[0] = a, v[1] = b, v[2] = c;
}

Pose in_head(Pose p, Pose q) {
    double v[3] = {q.x, q.y, q.z};
    turn(&p, v);
    Pose r = {p.x + v[0], p.y + v[1], p.z + v[2],
              p.qw * q.qx + p.qx * q.qw + p.qy * q.qz - p.qz * q.qy, p.qw * q.qy - p.qx * q.qz + p.qy * q.qw + p.qz * q.qx,
              p.qw * q.qz + p.qx * q.qy - p.qy * q.qx + p.qz * q.qw, p.qw * q.qw - p.qx * q.qx - p.qy * q.qy - p.qz * q.qz};
    return r;
}

/* Of a head that moves: 0.3 rad to either side once in two seconds, by the time it is asked for. */
Pose head_at(XrTime time) {
    double angle = 0.5 * 0.3 * sin(3.14159265358979 * (double)(time % 2000000000LL) * 1e-9);
    Pose about = {0, 0, 0, 0, sin(angle), 0, cos(angle)};
    return script.moves ? in_head(script.head, about) : script.head;
}

XrPosef to_xr(Pose p) {
    XrPosef pose = {{(float)p.qx, (float)p.qy, (float)p.qz, (float)p.qw}, {(float)p.x, (float)p.y, (float)p.z}};
    return pose;
}

/* Canted panels, each wider to its own side: 5 degrees outwards, 31.5 mm from the middle. */
void view_poses(XrTime time, XrView *views) {
    double half = 0.0436332313;
    Pose head = head_at(time);
    for (int eye = 0; eye < 2; eye++) {
        double side = eye ? 1.0 : -1.0;
        Pose panel = {side * 0.0315, 0, 0, 0, -side * sin(half), 0, cos(half)};
        XrFovf fov = {eye ? -0.70f : -0.85f, eye ? 0.85f : 0.70f, 0.75f, -0.80f};
        views[eye].pose = to_xr(in_head(head, panel));
        views[eye].fov = fov;
    }
}

/* ---- instance and system ---- */

static const char *extensions[] = {"XR_KHR_opengl_enable", "XR_MNDX_egl_enable", "XR_KHR_convert_timespec_time"};

static XrResult enumerate_extensions(const char *layer, uint32_t room, uint32_t *count, XrExtensionProperties *found) {
    (void)layer;
    *count = 3;
    for (uint32_t i = 0; i < room && i < 3; i++) strcpy(found[i].name, extensions[i]), found[i].version = 1;
    return room && room < 3 ? XR_ERROR_SIZE_INSUFFICIENT : XR_SUCCESS;
}

static XrResult create_instance(const XrInstanceCreateInfo *info, XrHandle *instance) {
    if (was_lost && refused++ < script.refusals) return answer("xrCreateInstance", XR_ERROR_RUNTIME_FAILURE);
    if (instance_open) return answer("xrCreateInstance", XR_ERROR_LIMIT_REACHED);
    for (uint32_t i = 0; i < info->extension_count; i++) {
        int known = 0;
        for (int k = 0; k < 3; k++) known |= !strcmp(info->extensions[i], extensions[k]);
        if (!known) return answer("xrCreateInstance", XR_ERROR_EXTENSION_NOT_PRESENT);
    }
    lost = ALL_IS_WELL, instance_open = 1, asked_requirements = 0, state_count = 0;
    *instance = INSTANCE;
    return answer("xrCreateInstance", XR_SUCCESS);
}

static XrResult destroy_instance(XrHandle instance) {
    (void)instance;
    free_session();
    instance_open = 0, lost = ALL_IS_WELL;
    note("xrDestroyInstance 0");
    return XR_SUCCESS;
}

static XrResult instance_properties(XrHandle instance, XrInstanceProperties *found) {
    (void)instance;
    found->version = 1, strcpy(found->name, "mimics test runtime");
    return XR_SUCCESS;
}

static XrResult poll_event(XrHandle instance, XrEventDataBuffer *buffer) {
    (void)instance;
    if (lost == INSTANCE_IS_LOST) return answer("xrPollEvent", XR_ERROR_INSTANCE_LOST);
    int next = next_state();
    if (!next) return XR_EVENT_UNAVAILABLE;
    XrEventDataSessionStateChanged event = {TYPE_EVENT_SESSION_STATE_CHANGED, NULL, SESSION, next, xr_now()};
    state = next;
    memcpy(buffer, &event, sizeof event);
    note("state %d", next);
    return XR_SUCCESS;
}

static XrResult result_to_string(XrHandle instance, XrResult result, char *text) {
    (void)instance;
    snprintf(text, 64, "XR_RESULT_%d", result);
    return XR_SUCCESS;
}

static XrResult get_system(XrHandle instance, const XrSystemGetInfo *info, XrSystemId *system) {
    (void)instance, (void)info;
    *system = 1;
    return answer("xrGetSystem", script.no_headset ? XR_ERROR_FORM_FACTOR_UNAVAILABLE : XR_SUCCESS);
}

static XrResult system_properties(XrHandle instance, XrSystemId system, XrSystemProperties *found) {
    (void)instance;
    found->system = system, found->vendor = 0, found->max_width = found->max_height = 4096, found->max_layers = 16;
    strcpy(found->name, "scripted headset");
    found->orientation_tracking = found->position_tracking = 1;
    return XR_SUCCESS;
}

static XrResult view_views(XrHandle instance, XrSystemId system, int32_t kind, uint32_t room, uint32_t *count,
                           XrViewConfigurationView *views) {
    (void)instance, (void)system, (void)kind;
    *count = 2;
    for (uint32_t i = 0; i < room && i < 2; i++) {
        views[i].width = script.width, views[i].height = script.height;
        views[i].max_width = views[i].max_height = 4096, views[i].samples = 1, views[i].max_samples = 4;
    }
    return XR_SUCCESS;
}

static XrResult blend_modes(XrHandle instance, XrSystemId system, int32_t kind, uint32_t room, uint32_t *count, int32_t *modes) {
    (void)instance, (void)system, (void)kind;
    *count = 1;
    if (room) modes[0] = 1;
    return XR_SUCCESS;
}

static XrResult requirements(XrHandle instance, XrSystemId system, XrGraphicsRequirementsOpenGLKHR *found) {
    (void)instance, (void)system;
    found->least = 4ULL << 48, found->most = (4ULL << 48) | (6ULL << 32);
    asked_requirements = 1;
    return answer("xrGetOpenGLGraphicsRequirementsKHR", XR_SUCCESS);
}

static XrResult from_timespec(XrHandle instance, const struct timespec *moment, XrTime *time) {
    (void)instance;
    *time = moment->tv_sec * 1000000000LL + moment->tv_nsec + EPOCH_NS;
    return answer("xrConvertTimespecTimeToTimeKHR", XR_SUCCESS);
}

static XrResult string_to_path(XrHandle instance, const char *text, XrPath *path) {
    (void)instance;
    for (int i = 0; i < paths; i++)
        if (!strcmp(path_names[i], text)) return *path = i + 1, XR_SUCCESS;
    if (paths == 64 || text[0] != '/') return XR_ERROR_PATH_INVALID;
    strncpy(path_names[paths], text, 95);
    *path = ++paths;
    return XR_SUCCESS;
}

static XrResult path_to_string(XrHandle instance, XrPath path, uint32_t room, uint32_t *count, char *text) {
    (void)instance;
    if (path < 1 || path > (XrPath)paths) return XR_ERROR_PATH_INVALID;
    *count = strlen(path_names[path - 1]) + 1;
    if (room) strncpy(text, path_names[path - 1], room);
    return XR_SUCCESS;
}

/* What the script says of the frame that is waited for now. */
void play_script(void) {
    for (int i = 0; i < script.count; i++) {
        const char *what = script.events[i].what;
        if (script.events[i].frame != frames_waited) continue;
        note("script %s", what);
        if (!strcmp(what, "hide")) enter_state(STATE_SYNCHRONIZED);
        else if (!strcmp(what, "show")) enter_state(STATE_VISIBLE), enter_state(STATE_FOCUSED);
        else if (!strcmp(what, "stop")) enter_state(STATE_SYNCHRONIZED), enter_state(STATE_STOPPING);
        else if (!strcmp(what, "exit")) exits = 1, enter_state(STATE_SYNCHRONIZED), enter_state(STATE_STOPPING);
        else if (!strcmp(what, "lose_head")) head_known = 0;
        else if (!strcmp(what, "find_head")) head_known = 1;
        else if (!strcmp(what, "press")) pressed = 1;
        else if (!strcmp(what, "release")) pressed = 0;
        else if (!strcmp(what, "session_lost")) lost = SESSION_IS_LOST, was_lost = 1;
        else if (!strcmp(what, "loss_pending")) enter_state(STATE_LOSS_PENDING), was_lost = 1;
        else if (!strcmp(what, "instance_lost")) lost = INSTANCE_IS_LOST, was_lost = 1;
    }
}

static XrResult get_proc(XrHandle instance, const char *name, XrVoidFunction *function) {
    static const struct { const char *name; XrVoidFunction function; } known[] = {
#define HAS(name, function) {name, (XrVoidFunction)function}
        HAS("xrGetInstanceProcAddr", get_proc), HAS("xrEnumerateInstanceExtensionProperties", enumerate_extensions),
        HAS("xrCreateInstance", create_instance), HAS("xrDestroyInstance", destroy_instance),
        HAS("xrGetInstanceProperties", instance_properties), HAS("xrPollEvent", poll_event),
        HAS("xrResultToString", result_to_string), HAS("xrStructureTypeToString", result_to_string),
        HAS("xrGetSystem", get_system), HAS("xrGetSystemProperties", system_properties),
        HAS("xrEnumerateViewConfigurationViews", view_views), HAS("xrEnumerateEnvironmentBlendModes", blend_modes),
        HAS("xrGetOpenGLGraphicsRequirementsKHR", requirements), HAS("xrConvertTimespecTimeToTimeKHR", from_timespec),
        HAS("xrStringToPath", string_to_path), HAS("xrPathToString", path_to_string),
    };
    (void)instance;
    *function = NULL;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcmp(known[i].name, name)) *function = known[i].function;
    if (!*function) *function = frame_function(name);
    return *function ? XR_SUCCESS : XR_ERROR_FUNCTION_UNSUPPORTED;
}

__attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(const XrNegotiateLoaderInfo *loader,
                                                                                  XrNegotiateRuntimeRequest *request) {
    read_script();
    note("negotiate %u..%u", loader->min_interface, loader->max_interface);
    request->runtime_interface = 1, request->runtime_api = 1ULL << 48, request->get_proc = get_proc;
    return XR_SUCCESS;
}

/* Sizes of the structures that are shared with the application, for a test to compare: "Name SIZE" a line. */
__attribute__((visibility("default"))) const char *mimics_sizes(void) {
    static char text[4096];
    int n = 0;
#define SIZE(name) n += snprintf(text + n, sizeof text - n, #name " %zu\n", sizeof(Xr##name))
    SIZE(ExtensionProperties); SIZE(ApplicationInfo); SIZE(InstanceCreateInfo); SIZE(InstanceProperties);
    SIZE(EventDataBuffer); SIZE(EventDataSessionStateChanged); SIZE(SystemGetInfo); SIZE(SystemProperties);
    SIZE(ViewConfigurationView); SIZE(GraphicsRequirementsOpenGLKHR); SIZE(GraphicsBindingOpenGLXlibKHR);
    SIZE(GraphicsBindingEGLMNDX); SIZE(SessionCreateInfo); SIZE(SessionBeginInfo); SIZE(ReferenceSpaceCreateInfo);
    SIZE(ActionSpaceCreateInfo); SIZE(SpaceLocation); SIZE(SwapchainCreateInfo); SIZE(SwapchainImageOpenGLKHR);
    SIZE(SwapchainImageWaitInfo); SIZE(FrameState); SIZE(ViewLocateInfo); SIZE(ViewState); SIZE(View);
    SIZE(CompositionLayerProjectionView); SIZE(CompositionLayerProjection); SIZE(FrameEndInfo); SIZE(ActionSetCreateInfo);
    SIZE(ActionCreateInfo); SIZE(ActionSuggestedBinding); SIZE(InteractionProfileSuggestedBinding);
    SIZE(SessionActionSetsAttachInfo); SIZE(ActiveActionSet); SIZE(ActionsSyncInfo); SIZE(ActionStateGetInfo);
    SIZE(ActionStateBoolean);
    return text;
}
