// Depth only. Translucent casters are dithered, one texel in four, which the filter of common/shadow.glsl averages.
#ifdef TEXTURED
#include "common/material.glsl"
#endif

in vec2 uv;

void main() {
#ifdef TRANSLUCENT
    ivec2 texel = ivec2(gl_FragCoord.xy) & 1;
    if (texel.x + texel.y != 0) discard;
#endif
#ifdef TEXTURED
    if (material_colour(base_colour, uv).a < emission.w) discard;
#endif
}
