/* Session, swapchain, frames, spaces and actions of the test runtime: what the application's context is used for. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include "state.h"

#define IMAGES 3
#define MOST_ACTIONS 16

int session_open, session_running;
static int waited, begun, acquired = -1, ready_image, released = -1, next_image, attached, synced, begun_once;
static uint32_t images[IMAGES];
static int chain_width, chain_height, on_egl;
static XrTime display_time, first_frame;
static XrView located[2];
static int action_count, space_count;
static struct { int kind; char name[64]; } actions[MOST_ACTIONS];
static struct { XrHandle action; XrPath hand; } spaces[MOST_ACTIONS];
static XrPath left_hand;

/* ---- the application's context ---- */

static void *gl_display, *gl_context;
static unsigned long gl_drawable;
static XrVoidFunction (*get_gl)(const char *);
static void *(*current_context)(void);
static void (*make_textures)(int, uint32_t *), (*bind_texture)(uint32_t, uint32_t), (*free_textures)(int, const uint32_t *);
static void (*give_storage)(uint32_t, int, uint32_t, int, int);
static void (*get_texels)(uint32_t, int, uint32_t, uint32_t, int, void *);
static unsigned (*get_error)(void);

static void *library_call(const char *library, const char *name) {
    void *handle = dlopen(library, RTLD_NOW | RTLD_GLOBAL);
    return handle ? dlsym(handle, name) : NULL;
}

static XrResult check_egl(const XrGraphicsBindingEGLMNDX *binding) {
    int (*of_context)(void *, void *, int, int *) = library_call("libEGL.so.1", "eglQueryContext");
    int (*of_config)(void *, void *, int, int *) = library_call("libEGL.so.1", "eglGetConfigAttrib");
    int current = 0, given = -1;
    current_context = library_call("libEGL.so.1", "eglGetCurrentContext");
    gl_display = binding->display, gl_context = binding->context, get_gl = binding->get_proc, on_egl = 1;
    of_context(gl_display, gl_context, 0x3028, &current);
    of_config(gl_display, binding->config, 0x3028, &given);
    note("egl config %d of %d", given, current);
    return current == given ? XR_SUCCESS : XR_ERROR_GRAPHICS_DEVICE_INVALID;
}

static XrResult check_glx(const XrGraphicsBindingOpenGLXlibKHR *binding) {
    int (*of_context)(void *, void *, int, int *) = library_call("libGL.so.1", "glXQueryContext");
    int (*of_config)(void *, void *, int, int *) = library_call("libGL.so.1", "glXGetFBConfigAttrib");
    unsigned long (*drawable)(void) = library_call("libGL.so.1", "glXGetCurrentDrawable");
    int current = 0, given = -1, visual = -1;
    current_context = library_call("libGL.so.1", "glXGetCurrentContext");
    get_gl = library_call("libGL.so.1", "glXGetProcAddressARB");
    gl_display = binding->display, gl_context = binding->context, gl_drawable = binding->drawable, on_egl = 0;
    of_context(gl_display, gl_context, 0x8013, &current);
    of_config(gl_display, binding->config, 0x8013, &given);
    of_config(gl_display, binding->config, 0x800B, &visual);
    note("glx config %d of %d, visual %u of %d, drawable %d", given, current, binding->visual, visual,
         binding->drawable == drawable());
    return current == given && visual == (int)binding->visual && visual && binding->drawable == drawable()
               ? XR_SUCCESS : XR_ERROR_GRAPHICS_DEVICE_INVALID;
}

static XrResult take_context(const int32_t *binding) {
    XrResult result = XR_ERROR_GRAPHICS_DEVICE_INVALID;
    if (binding && *binding == TYPE_GRAPHICS_BINDING_EGL) result = check_egl((const void *)binding);
    if (binding && *binding == TYPE_GRAPHICS_BINDING_XLIB) result = check_glx((const void *)binding);
    if (result || current_context() != gl_context) return XR_ERROR_GRAPHICS_DEVICE_INVALID;
    make_textures = (void *)get_gl("glGenTextures"), bind_texture = (void *)get_gl("glBindTexture");
    free_textures = (void *)get_gl("glDeleteTextures"), give_storage = (void *)get_gl("glTextureStorage2D");
    get_texels = (void *)get_gl("glGetTextureImage"), get_error = (void *)get_gl("glGetError");
    return make_textures && bind_texture && free_textures && give_storage && get_texels ? XR_SUCCESS : XR_ERROR_RUNTIME_FAILURE;
}

/* Some runtimes leave another context current, or none: the application has to take its own back. */
static void steal_context(void) {
    if (!script.steals_context) return;
    if (on_egl) {
        int (*make)(void *, void *, void *, void *) = library_call("libEGL.so.1", "eglMakeCurrent");
        make(gl_display, NULL, NULL, NULL);
    } else {
        int (*make)(void *, unsigned long, void *) = library_call("libGL.so.1", "glXMakeCurrent");
        make(gl_display, 0, NULL);
    }
}

static XrResult fit(const char *call, XrResult wrong) { /* what every call of a session needs */
    if (lost == SESSION_IS_LOST) wrong = XR_ERROR_SESSION_LOST;
    else if (!session_open) wrong = XR_ERROR_HANDLE_INVALID;
    return answer(call, wrong);
}

static XrResult fit_gl(const char *call, XrResult wrong) {
    if (!wrong && session_open && !lost && current_context() != gl_context) {
        note("no context is current");
        wrong = XR_ERROR_GRAPHICS_DEVICE_INVALID;
    }
    return fit(call, wrong);
}

/* ---- session ---- */

static XrResult create_session(XrHandle instance, const XrSessionCreateInfo *info, XrHandle *session) {
    (void)instance;
    if (!asked_requirements) return answer("xrCreateSession", XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING);
    XrResult result = take_context(info->next);
    if (result) return answer("xrCreateSession", result);
    session_open = 1, session_running = waited = begun = attached = synced = action_count = space_count = exits = 0;
    acquired = released = -1, first_frame = 0, begun_once = 0;
    *session = SESSION;
    enter_state(STATE_IDLE), enter_state(STATE_READY);
    return steal_context(), answer("xrCreateSession", XR_SUCCESS);
}

void free_session(void) { session_open = session_running = 0, chain_width = 0; }

static XrResult destroy_session(XrHandle session) {
    (void)session;
    free_session();
    if (lost == SESSION_IS_LOST) lost = ALL_IS_WELL;
    note("xrDestroySession 0");
    return XR_SUCCESS;
}

static XrResult begin_session(XrHandle session, const XrSessionBeginInfo *info) {
    (void)session, (void)info;
    XrResult wrong = session_running ? XR_ERROR_SESSION_RUNNING : state != STATE_READY ? XR_ERROR_SESSION_NOT_READY : 0;
    if (fit("xrBeginSession", wrong)) return lost ? XR_ERROR_SESSION_LOST : wrong;
    session_running = 1, begun_once = 0;
    enter_state(STATE_SYNCHRONIZED);
    return XR_SUCCESS;
}

static XrResult end_session(XrHandle session) {
    (void)session;
    XrResult wrong = !session_running ? XR_ERROR_SESSION_NOT_RUNNING : state != STATE_STOPPING ? XR_ERROR_SESSION_NOT_STOPPING : 0;
    if ((wrong = fit("xrEndSession", wrong))) return wrong;
    session_running = waited = begun = 0;
    enter_state(STATE_IDLE), enter_state(exits ? STATE_EXITING : STATE_READY);
    return XR_SUCCESS;
}

static XrResult request_exit(XrHandle session) {
    (void)session;
    XrResult wrong = fit("xrRequestExitSession", session_running ? 0 : XR_ERROR_SESSION_NOT_RUNNING);
    if (!wrong) exits = 1, enter_state(STATE_SYNCHRONIZED), enter_state(STATE_STOPPING);
    return wrong;
}

/* ---- swapchain ---- */

static XrResult formats(XrHandle session, uint32_t room, uint32_t *count, int64_t *found) {
    (void)session;
    *count = script.format_count;
    for (uint32_t i = 0; i < room && i < *count; i++) found[i] = script.formats[i];
    return XR_SUCCESS;
}

static XrResult create_swapchain(XrHandle session, const XrSwapchainCreateInfo *info, XrHandle *chain) {
    (void)session;
    int offered = 0;
    for (int i = 0; i < script.format_count; i++) offered |= info->format == script.formats[i];
    XrResult wrong = fit_gl("xrCreateSwapchain", offered ? 0 : XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
    if (wrong) return wrong;
    chain_width = info->width, chain_height = info->height;
    note("swapchain %x %dx%d", (unsigned)info->format, chain_width, chain_height);
    make_textures(IMAGES, images);
    for (int i = 0; i < IMAGES; i++) {
        bind_texture(0x0DE1, images[i]); /* a name becomes a texture when it is bound first */
        give_storage(images[i], 1, (uint32_t)info->format, chain_width, chain_height);
    }
    bind_texture(0x0DE1, 0);
    *chain = CHAIN;
    return steal_context(), XR_SUCCESS;
}

static XrResult destroy_swapchain(XrHandle chain) {
    (void)chain;
    if (session_open && !lost && chain_width && current_context() == gl_context) free_textures(IMAGES, images);
    chain_width = 0;
    note("xrDestroySwapchain 0");
    return XR_SUCCESS;
}

static XrResult swapchain_images(XrHandle chain, uint32_t room, uint32_t *count, XrSwapchainImageOpenGLKHR *found) {
    (void)chain;
    *count = IMAGES;
    for (uint32_t i = 0; i < room && i < IMAGES; i++) found[i].image = images[i];
    return XR_SUCCESS;
}

static XrResult acquire_image(XrHandle chain, const void *info, uint32_t *index) {
    (void)chain, (void)info;
    XrResult wrong = fit_gl("xrAcquireSwapchainImage", acquired >= 0 ? XR_ERROR_CALL_ORDER_INVALID : 0);
    if (wrong) return wrong;
    acquired = *index = next_image++ % IMAGES, ready_image = 0;
    return steal_context(), XR_SUCCESS;
}

static XrResult wait_image(XrHandle chain, const XrSwapchainImageWaitInfo *info) {
    (void)chain, (void)info;
    XrResult wrong = fit("xrWaitSwapchainImage", acquired < 0 || ready_image ? XR_ERROR_CALL_ORDER_INVALID : 0);
    if (!wrong) ready_image = 1;
    return wrong;
}

static XrResult release_image(XrHandle chain, const void *info) {
    (void)chain, (void)info;
    XrResult wrong = fit_gl("xrReleaseSwapchainImage", acquired < 0 || !ready_image ? XR_ERROR_CALL_ORDER_INVALID : 0);
    if (!wrong) released = acquired, acquired = -1;
    return wrong;
}

/* ---- frames ---- */

static XrResult wait_frame(XrHandle session, const void *info, XrFrameState *frame) {
    (void)session, (void)info;
    XrResult wrong = !session_running ? XR_ERROR_SESSION_NOT_RUNNING : waited ? XR_ERROR_CALL_ORDER_INVALID : 0;
    frames_waited++;
    play_script();
    if ((wrong = fit("xrWaitFrame", wrong))) return wrong;
    XrDuration period = (XrDuration)(1e9 / script.rate);
    XrTime now = xr_now();
    if (!first_frame) first_frame = now;
    XrTime wake = first_frame + ((now - first_frame) / period + 1) * period;
    struct timespec until = {(wake - EPOCH_NS) / 1000000000LL, (wake - EPOCH_NS) % 1000000000LL};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
    waited = 1, display_time = wake + period;
    frame->display_time = display_time, frame->period = period;
    frame->render = state == STATE_VISIBLE || state == STATE_FOCUSED;
    note("frame %d display %lld render %u", frames_waited, (long long)display_time, frame->render);
    return XR_SUCCESS;
}

static XrResult begin_frame(XrHandle session, const void *info) {
    (void)session, (void)info;
    XrResult wrong = !session_running ? XR_ERROR_SESSION_NOT_RUNNING : !waited ? XR_ERROR_CALL_ORDER_INVALID : 0;
    if ((wrong = fit_gl("xrBeginFrame", wrong))) return wrong;
    waited = 0;
    XrResult discarded = begun ? XR_FRAME_DISCARDED : XR_SUCCESS;
    begun = 1;
    return discarded;
}

static int unit(XrQuaternionf q) { return fabs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) < 0.02; }

static XrResult check_layer(const XrCompositionLayerProjection *layer) {
    if (layer->type != TYPE_COMPOSITION_LAYER_PROJECTION || layer->count != 2 || layer->space != LOCAL) return XR_ERROR_LAYER_INVALID;
    for (int eye = 0; eye < 2; eye++) {
        const XrCompositionLayerProjectionView *view = &layer->views[eye];
        XrRect2Di rect = view->part.rect;
        if (!unit(view->pose.orientation)) return XR_ERROR_POSE_INVALID;
        if (released < 0 || view->part.swapchain != CHAIN) return XR_ERROR_LAYER_INVALID;
        if (rect.offset.x < 0 || rect.offset.y < 0 || rect.offset.x + rect.extent.width > chain_width ||
            rect.offset.y + rect.extent.height > chain_height) return XR_ERROR_SWAPCHAIN_RECT_INVALID;
        int same = !memcmp(&view->pose, &located[eye].pose, sizeof view->pose) && !memcmp(&view->fov, &located[eye].fov, sizeof view->fov);
        note("view %d rect %d %d %d %d as_located %d", eye, rect.offset.x, rect.offset.y, rect.extent.width, rect.extent.height, same);
    }
    return XR_SUCCESS;
}

static void dump_image(void) {
    char name[640];
    size_t size = (size_t)chain_width * chain_height * 4;
    uint8_t *texels = malloc(size);
    snprintf(name, sizeof name, "%s/frame_%05d.rgba", script.dump, frames_waited);
    FILE *file = script.dump[0] ? fopen(name, "wb") : NULL;
    while (get_error()) {}
    get_texels(images[released], 0, 0x1908, 0x1401, (int)size, texels);
    unsigned error = get_error();
    if (error) note("gl error %x", error);
    if (file) fwrite(texels, 1, size, file), fclose(file);
    free(texels);
}

static XrResult end_frame(XrHandle session, const XrFrameEndInfo *info) {
    (void)session;
    XrResult wrong = !session_running ? XR_ERROR_SESSION_NOT_RUNNING : !begun ? XR_ERROR_CALL_ORDER_INVALID : 0;
    if (!wrong && info->display_time != display_time) wrong = XR_ERROR_TIME_INVALID;
    if (!wrong && info->blend != 1) wrong = XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED;
    for (uint32_t i = 0; !wrong && !lost && i < info->count; i++) wrong = check_layer(info->layers[i]);
    if ((wrong = fit_gl("xrEndFrame", wrong))) return wrong;
    begun = 0;
    note("layers %u", info->count);
    if (info->count) dump_image();
    if (!begun_once++) enter_state(STATE_VISIBLE), enter_state(STATE_FOCUSED);
    steal_context();
    return XR_SUCCESS;
}

static XrResult locate_views(XrHandle session, const XrViewLocateInfo *info, XrViewState *views_state, uint32_t room,
                             uint32_t *count, XrView *views) {
    (void)session;
    *count = 2;
    if (room < 2) return room ? XR_ERROR_SIZE_INSUFFICIENT : XR_SUCCESS;
    XrResult wrong = fit("xrLocateViews", info->time <= 0 ? XR_ERROR_TIME_INVALID : 0);
    if (wrong) return wrong;
    note("located for %lld", (long long)info->time);
    views_state->flags = head_known ? 0xF : 0;
    view_poses(info->time, views);
    for (int eye = 0; eye < 2; eye++) {
        if (!head_known) memset(&views[eye].pose, 0, sizeof views[eye].pose);
        else located[eye] = views[eye];
    }
    return XR_SUCCESS;
}

/* ---- spaces and actions ---- */

static XrResult reference_space(XrHandle session, const XrReferenceSpaceCreateInfo *info, XrHandle *space) {
    (void)session;
    *space = info->kind == 1 ? LOCAL - 0x10 : LOCAL; /* 1 is VIEW: the head */
    return answer("xrCreateReferenceSpace", XR_SUCCESS);
}

static XrResult destroy_thing(XrHandle thing) { return (void)thing, XR_SUCCESS; }
static XrResult create_action_set(XrHandle instance, const void *info, XrHandle *set) {
    (void)instance, (void)info;
    *set = ACTION_SET;
    return answer("xrCreateActionSet", XR_SUCCESS);
}

static XrResult create_action(XrHandle set, const XrActionCreateInfo *info, XrHandle *action) {
    (void)set;
    if (attached) return answer("xrCreateAction", XR_ERROR_ACTIONSETS_ALREADY_ATTACHED);
    if (action_count == MOST_ACTIONS) return answer("xrCreateAction", XR_ERROR_LIMIT_REACHED);
    if (info->count) left_hand = info->subactions[0];
    actions[action_count].kind = info->kind, strcpy(actions[action_count].name, info->name);
    *action = ACTIONS + action_count++;
    return answer("xrCreateAction", XR_SUCCESS);
}

static XrResult suggest(XrHandle instance, const XrInteractionProfileSuggestedBinding *info) {
    (void)instance;
    return answer("xrSuggestInteractionProfileBindings", attached ? XR_ERROR_ACTIONSETS_ALREADY_ATTACHED : info->count ? 0 : XR_ERROR_VALIDATION_FAILURE);
}

static XrResult attach(XrHandle session, const XrSessionActionSetsAttachInfo *info) {
    (void)session, (void)info;
    XrResult wrong = fit("xrAttachSessionActionSets", attached ? XR_ERROR_ACTIONSETS_ALREADY_ATTACHED : 0);
    attached |= !wrong;
    return wrong;
}

static XrResult sync_actions(XrHandle session, const XrActionsSyncInfo *info) {
    (void)session, (void)info;
    XrResult wrong = fit("xrSyncActions", attached ? 0 : XR_ERROR_ACTIONSET_NOT_ATTACHED);
    synced = !wrong && state == STATE_FOCUSED;
    return wrong ? wrong : synced ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

static XrResult boolean_state(XrHandle session, const XrActionStateGetInfo *info, XrActionStateBoolean *found) {
    (void)session;
    int right_select = !strcmp(actions[info->action - ACTIONS].name, "select") && info->subaction != left_hand;
    found->active = synced, found->state = synced && pressed && right_select, found->changed = 0, found->time = 0;
    return attached ? XR_SUCCESS : XR_ERROR_ACTIONSET_NOT_ATTACHED;
}

static XrResult action_space(XrHandle session, const XrActionSpaceCreateInfo *info, XrHandle *space) {
    (void)session;
    if (space_count == MOST_ACTIONS) return XR_ERROR_LIMIT_REACHED;
    spaces[space_count].action = info->action, spaces[space_count].hand = info->subaction;
    *space = SPACES + space_count++;
    return answer("xrCreateActionSpace", XR_SUCCESS);
}

static XrResult locate_space(XrHandle space, XrHandle base, XrTime time, XrSpaceLocation *found) {
    int hand = space >= SPACES && space < SPACES + MOST_ACTIONS;
    XrResult wrong = fit("xrLocateSpace", time <= 0 ? XR_ERROR_TIME_INVALID : base != LOCAL ? XR_ERROR_HANDLE_INVALID : 0);
    if (wrong) return wrong;
    Pose grip = {0.25, -0.45, -0.35, 0, 0, 0, 1};
    if (hand && spaces[space - SPACES].hand == left_hand) grip.x = -grip.x;
    found->pose = to_xr(hand ? in_head(script.head, grip) : head_at(time));
    found->flags = (hand ? synced : head_known) ? 0xF : 0;
    return XR_SUCCESS;
}

XrVoidFunction frame_function(const char *name) {
    static const struct { const char *name; XrVoidFunction function; } known[] = {
#define HAS(name, function) {name, (XrVoidFunction)function}
        HAS("xrCreateSession", create_session), HAS("xrDestroySession", destroy_session),
        HAS("xrBeginSession", begin_session), HAS("xrEndSession", end_session),
        HAS("xrRequestExitSession", request_exit), HAS("xrEnumerateSwapchainFormats", formats),
        HAS("xrCreateSwapchain", create_swapchain), HAS("xrDestroySwapchain", destroy_swapchain),
        HAS("xrEnumerateSwapchainImages", swapchain_images), HAS("xrAcquireSwapchainImage", acquire_image),
        HAS("xrWaitSwapchainImage", wait_image), HAS("xrReleaseSwapchainImage", release_image),
        HAS("xrWaitFrame", wait_frame), HAS("xrBeginFrame", begin_frame), HAS("xrEndFrame", end_frame),
        HAS("xrLocateViews", locate_views), HAS("xrCreateReferenceSpace", reference_space),
        HAS("xrDestroySpace", destroy_thing), HAS("xrLocateSpace", locate_space),
        HAS("xrCreateActionSet", create_action_set), HAS("xrDestroyActionSet", destroy_thing),
        HAS("xrCreateAction", create_action), HAS("xrDestroyAction", destroy_thing),
        HAS("xrSuggestInteractionProfileBindings", suggest), HAS("xrAttachSessionActionSets", attach),
        HAS("xrSyncActions", sync_actions), HAS("xrGetActionStateBoolean", boolean_state),
        HAS("xrCreateActionSpace", action_space),
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcmp(known[i].name, name)) return known[i].function;
    return NULL;
}
