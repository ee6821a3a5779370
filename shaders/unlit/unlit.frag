// Surface in its own colour, independent of the light.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/output.glsl"

out vec4 colour;

void main() {
    vec4 base = material_colour(tint, uv);
#ifdef MASKED
    cover_samples(base.a);
#endif
    colour = vec4(encode_output(apply_fog(base.rgb + emission.rgb, length(line_of_sight()))), base.a);
}
