// Which eye a vertex is drawn for and where that puts it. Where both eyes are drawn together, every second instance is
// the other eye's: into its own viewport, or into its half of one picture of both.
#if defined(EYES_BY_VIEWPORT) || defined(EYES_BY_CLIPPING)
#define EYE (gl_InstanceID & 1)
#else
#define EYE 0
#endif

invariant gl_Position;
flat out vec3 eye_place;        // of that eye, frame "eye"

void put_at(vec3 position_eye) {
    eye_place = eye_places[EYE].xyz;
    vec4 seen = clip_from_eyes[EYE] * vec4(position_eye, 1.0);
#if defined(EYES_BY_VIEWPORT)
    gl_ViewportIndex = EYE;
#elif defined(EYES_BY_CLIPPING)
    gl_ClipDistance[0] = EYE == 0 ? seen.w - seen.x : seen.w + seen.x;
    seen.x = 0.5 * seen.x + (EYE == 0 ? -0.5 : 0.5) * seen.w;
#endif
    gl_Position = seen;
}
