// Interpolated outputs of common/mesh.vert.
in vec3 position_eye;
flat in vec4 eye_seen;          // position of the eye, frame "eye"; w: its number
in vec3 normal;                 // not normalised
in vec2 uv;
#ifdef COLOURED
in vec4 tint;                   // base colour of the material, times that of the vertex: linear RGBA
#else
flat in vec4 tint;
#endif

// Number of the eye; always 0 where each eye has a pass of its own.
#if defined(EYES_BY_VIEWPORT) || defined(EYES_BY_CLIPPING)
#define EYE_SEEN int(eye_seen.w + 0.5)
#else
#define EYE_SEEN 0
#endif

// Vector from the eye to the surface.
vec3 line_of_sight() {
    return position_eye - eye_seen.xyz;
}
