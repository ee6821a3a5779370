// Depth from a light, from one eye, or from both eyes.
#include "common/instance.glsl"
#ifdef EYES_BY_CLIPPING
#include "common/view.glsl"
#include "common/eyes.glsl"
#else
uniform mat4 clip_from_eye;
#endif

out vec2 uv;

void main() {
    uv = in_uv;
#ifdef EYES_BY_CLIPPING
    put_at(instance_position());
#else
    gl_Position = clip_from_eye * vec4(instance_position(), 1.0);
#endif
}
