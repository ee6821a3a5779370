// Both eyes in one pass: every second instance is for the other eye, in a viewport of its own or in its half of one.
// The same program draws a single eye if the view block selects it, with identical rounding.
#if defined(EYES_BY_VIEWPORT) || defined(EYES_BY_CLIPPING)
#define EYES 2
#define EYE (eye_places[0].w < 0.0 ? gl_InstanceID & 1 : int(eye_places[0].w))
#else
#define EYES 1
#define EYE 0
#endif

// Maps a position in an eye's clip space to that eye's viewport or half.
vec4 put_for_eye(vec4 seen) {
#if defined(EYES_BY_VIEWPORT)
    gl_ViewportIndex = EYE;
#elif defined(EYES_BY_CLIPPING)
    gl_ClipDistance[0] = EYE == 0 ? seen.w - seen.x : seen.w + seen.x;
    seen.x = 0.5 * seen.x + (EYE == 0 ? -0.5 : 0.5) * seen.w;
#endif
    return seen;
}
