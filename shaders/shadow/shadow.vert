// Depth from a light, from one eye, or from both eyes.
#ifdef EYES_BY_CLIPPING
#include "common/view.glsl"
#include "common/eyes.glsl"
#else
uniform mat4 clip_from_eye;
#endif

in vec3 in_position;
in vec2 in_uv;
in vec4 eye_row0;
in vec4 eye_row1;
in vec4 eye_row2;
out vec2 uv;

void main() {
    vec4 position = vec4(in_position, 1.0);
    vec3 position_eye = vec3(dot(eye_row0, position), dot(eye_row1, position), dot(eye_row2, position));
    uv = in_uv;
#ifdef EYES_BY_CLIPPING
    put_at(position_eye);
#else
    gl_Position = clip_from_eye * vec4(position_eye, 1.0);
#endif
}
