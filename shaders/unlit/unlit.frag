// Surface that shows its own colour whatever shines on it.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/output.glsl"

in vec3 position_eye;
in vec3 normal;
in vec2 uv;
in vec4 vertex_colour;
out vec4 colour;

void main() {
    vec4 base = material_colour(vertex_colour, uv);
#ifdef MASKED
    if (base.a < emission.w) discard;
#endif
    colour = vec4(encode_output(apply_fog(base.rgb + emission.rgb, length(position_eye))), base.a);
}
