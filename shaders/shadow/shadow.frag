// Writes depth only. Translucent casters stop one texel in four: the filter of common/shadow.glsl makes that a quarter.
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
