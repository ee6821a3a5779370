// The interpolated light of the vertices, times the colour of a texture.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/output.glsl"

#ifdef TEXTURED
in vec4 scattered;
in vec4 added;
in vec2 uv;
#else
in vec4 shown;
#endif
out vec4 colour;

void main() {
#ifdef TEXTURED
    vec4 base = material_colour(vec4(vec3(1.0), scattered.a), uv);
#ifdef MASKED
    cover_samples(base.a);
#endif
    colour = vec4(added.w * encode_output(base.rgb * scattered.rgb + added.rgb), base.a);
#else
    colour = shown;
#endif
}
