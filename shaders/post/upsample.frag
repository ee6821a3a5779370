// Twice the size by a tent filter; blended over the finer level by `share`.
#include "post/region.glsl"

uniform float share;

out vec4 colour;

void main() {
    vec2 at = region_at;
    vec3 wide = region_colour(at + vec2(-0.5, -0.5)) + region_colour(at + vec2(0.5, -0.5));
    wide += region_colour(at + vec2(-0.5, 0.5)) + region_colour(at + vec2(0.5, 0.5));
    colour = vec4(0.25 * wide, share);
}
