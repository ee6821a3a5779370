// A mesh instance, from the object frame to the frame "eye"; shared by all techniques.
#include "common/view.glsl"
#include "common/eyes.glsl"
#include "common/instance.glsl"
#include "common/material_block.glsl"

#ifdef COLOURED
in vec4 in_colour;
#endif
#ifdef SECOND_UV
in vec2 in_second_uv;
out vec2 second_uv;
#endif

out vec3 position_eye;
out vec3 normal;
out vec2 uv;
#ifdef COLOURED
out vec4 tint;
#else
flat out vec4 tint;
#endif

void main() {
    position_eye = instance_position();
    normal = instance_normal();
    uv = in_uv;
#ifdef SECOND_UV
    second_uv = in_second_uv;
#endif
    // Per vertex, not per pixel: software renderers pay for each uniform that is read.
    tint = base_colour;
#ifdef COLOURED
    tint *= in_colour;
#endif
    put_at(position_eye);
}
