/* What the test runtime needs of OpenXR 1.0, declared from the specification; tests compare every size with pyopenxr's. */
#ifndef MIMICS_TEST_XR_H
#define MIMICS_TEST_XR_H
#include <stddef.h>
#include <stdint.h>
#include <time.h>

typedef int32_t XrResult;
typedef uint32_t XrBool32;
typedef uint64_t XrVersion, XrFlags64, XrSystemId, XrPath, XrHandle;
typedef int64_t XrTime, XrDuration;
typedef void (*XrVoidFunction)(void);

enum {
    XR_SUCCESS = 0, XR_TIMEOUT_EXPIRED = 1, XR_EVENT_UNAVAILABLE = 4, XR_SESSION_NOT_FOCUSED = 8, XR_FRAME_DISCARDED = 9,
    XR_ERROR_VALIDATION_FAILURE = -1, XR_ERROR_RUNTIME_FAILURE = -2, XR_ERROR_FUNCTION_UNSUPPORTED = -7,
    XR_ERROR_EXTENSION_NOT_PRESENT = -9, XR_ERROR_LIMIT_REACHED = -10, XR_ERROR_SIZE_INSUFFICIENT = -11,
    XR_ERROR_HANDLE_INVALID = -12, XR_ERROR_INSTANCE_LOST = -13, XR_ERROR_SESSION_RUNNING = -14,
    XR_ERROR_SESSION_NOT_RUNNING = -16, XR_ERROR_SESSION_LOST = -17, XR_ERROR_SYSTEM_INVALID = -18,
    XR_ERROR_PATH_INVALID = -19, XR_ERROR_LAYER_INVALID = -23, XR_ERROR_SWAPCHAIN_RECT_INVALID = -25,
    XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED = -26, XR_ERROR_SESSION_NOT_READY = -28, XR_ERROR_SESSION_NOT_STOPPING = -29,
    XR_ERROR_TIME_INVALID = -30, XR_ERROR_FORM_FACTOR_UNAVAILABLE = -35, XR_ERROR_CALL_ORDER_INVALID = -37,
    XR_ERROR_GRAPHICS_DEVICE_INVALID = -38, XR_ERROR_POSE_INVALID = -39,
    XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED = -42, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED = -47,
    XR_ERROR_ACTIONSET_NOT_ATTACHED = -46, XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING = -50
};

enum {
    TYPE_EVENT_INSTANCE_LOSS_PENDING = 17, TYPE_EVENT_SESSION_STATE_CHANGED = 18, TYPE_COMPOSITION_LAYER_PROJECTION = 35,
    TYPE_GRAPHICS_BINDING_XLIB = 1000023001, TYPE_SWAPCHAIN_IMAGE_OPENGL = 1000023004,
    TYPE_GRAPHICS_BINDING_EGL = 1000048004
};

enum {
    STATE_IDLE = 1, STATE_READY, STATE_SYNCHRONIZED, STATE_VISIBLE, STATE_FOCUSED, STATE_STOPPING, STATE_LOSS_PENDING,
    STATE_EXITING
};

#define XR_HEAD int32_t type; void *next
typedef struct { float x, y, z, w; } XrQuaternionf;
typedef struct { float x, y, z; } XrVector3f;
typedef struct { XrQuaternionf orientation; XrVector3f position; } XrPosef;
typedef struct { float left, right, up, down; } XrFovf;
typedef struct { int32_t x, y; } XrOffset2Di;
typedef struct { int32_t width, height; } XrExtent2Di;
typedef struct { XrOffset2Di offset; XrExtent2Di extent; } XrRect2Di;

typedef struct { int32_t kind; uint32_t struct_version; size_t struct_size; uint32_t min_interface, max_interface;
                 XrVersion min_api, max_api; } XrNegotiateLoaderInfo;
typedef XrResult (*XrGetProc)(XrHandle, const char *, XrVoidFunction *);
typedef struct { int32_t kind; uint32_t struct_version; size_t struct_size; uint32_t runtime_interface;
                 XrVersion runtime_api; XrGetProc get_proc; } XrNegotiateRuntimeRequest;

typedef struct { XR_HEAD; char name[128]; uint32_t version; } XrExtensionProperties;
typedef struct { char application[128]; uint32_t application_version; char engine[128]; uint32_t engine_version;
                 XrVersion api; } XrApplicationInfo;
typedef struct { XR_HEAD; XrFlags64 flags; XrApplicationInfo application; uint32_t layer_count; const char *const *layers;
                 uint32_t extension_count; const char *const *extensions; } XrInstanceCreateInfo;
typedef struct { XR_HEAD; XrVersion version; char name[128]; } XrInstanceProperties;
typedef struct { XR_HEAD; uint8_t varying[4000]; } XrEventDataBuffer;
typedef struct { XR_HEAD; XrTime loss_time; } XrEventDataInstanceLossPending;
typedef struct { XR_HEAD; XrHandle session; int32_t state; XrTime time; } XrEventDataSessionStateChanged;
typedef struct { XR_HEAD; int32_t form_factor; } XrSystemGetInfo;
typedef struct { XR_HEAD; XrSystemId system; uint32_t vendor; char name[256]; uint32_t max_height, max_width, max_layers;
                 XrBool32 orientation_tracking, position_tracking; } XrSystemProperties;
typedef struct { XR_HEAD; uint32_t width, max_width, height, max_height, samples, max_samples; } XrViewConfigurationView;
typedef struct { XR_HEAD; int32_t kind; XrBool32 fov_mutable; } XrViewConfigurationProperties;
typedef struct { XR_HEAD; XrVersion least, most; } XrGraphicsRequirementsOpenGLKHR;
typedef struct { XR_HEAD; void *display; uint32_t visual; void *config; unsigned long drawable; void *context; }
    XrGraphicsBindingOpenGLXlibKHR;
typedef struct { XR_HEAD; XrVoidFunction (*get_proc)(const char *); void *display, *config, *context; }
    XrGraphicsBindingEGLMNDX;
typedef struct { XR_HEAD; XrFlags64 flags; XrSystemId system; } XrSessionCreateInfo;
typedef struct { XR_HEAD; int32_t kind; } XrSessionBeginInfo;
typedef struct { XR_HEAD; int32_t kind; XrPosef pose; } XrReferenceSpaceCreateInfo;
typedef struct { XR_HEAD; XrHandle action; XrPath subaction; XrPosef pose; } XrActionSpaceCreateInfo;
typedef struct { XR_HEAD; XrFlags64 flags; XrPosef pose; } XrSpaceLocation;
typedef struct { XR_HEAD; XrFlags64 flags, usage; int64_t format; uint32_t samples, width, height, faces, layers, mips; }
    XrSwapchainCreateInfo;
typedef struct { XR_HEAD; uint32_t image; } XrSwapchainImageOpenGLKHR;
typedef struct { XR_HEAD; XrDuration timeout; } XrSwapchainImageWaitInfo;
typedef struct { XR_HEAD; XrTime display_time; XrDuration period; XrBool32 render; } XrFrameState;
typedef struct { XR_HEAD; int32_t kind; XrTime time; XrHandle space; } XrViewLocateInfo;
typedef struct { XR_HEAD; XrFlags64 flags; } XrViewState;
typedef struct { XR_HEAD; XrPosef pose; XrFovf fov; } XrView;
typedef struct { XrHandle swapchain; XrRect2Di rect; uint32_t layer; } XrSwapchainSubImage;
typedef struct { XR_HEAD; XrPosef pose; XrFovf fov; XrSwapchainSubImage part; } XrCompositionLayerProjectionView;
typedef struct { XR_HEAD; XrFlags64 flags; XrHandle space; uint32_t count; const XrCompositionLayerProjectionView *views; }
    XrCompositionLayerProjection;
typedef struct { XR_HEAD; XrTime display_time; int32_t blend; uint32_t count; const XrCompositionLayerProjection *const *layers; }
    XrFrameEndInfo;
typedef struct { XR_HEAD; char name[64], localized[128]; uint32_t priority; } XrActionSetCreateInfo;
typedef struct { XR_HEAD; char name[64]; int32_t kind; uint32_t count; const XrPath *subactions; char localized[128]; }
    XrActionCreateInfo;
typedef struct { XrHandle action; XrPath binding; } XrActionSuggestedBinding;
typedef struct { XR_HEAD; XrPath profile; uint32_t count; const XrActionSuggestedBinding *bindings; }
    XrInteractionProfileSuggestedBinding;
typedef struct { XR_HEAD; uint32_t count; const XrHandle *sets; } XrSessionActionSetsAttachInfo;
typedef struct { XrHandle set; XrPath subaction; } XrActiveActionSet;
typedef struct { XR_HEAD; uint32_t count; const XrActiveActionSet *sets; } XrActionsSyncInfo;
typedef struct { XR_HEAD; XrHandle action; XrPath subaction; } XrActionStateGetInfo;
typedef struct { XR_HEAD; XrBool32 state, changed; XrTime time; XrBool32 active; } XrActionStateBoolean;
#endif
