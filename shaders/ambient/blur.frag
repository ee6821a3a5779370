// Depth-aware blur: mean over those of 4 x 4 texels that have the same depth.
#include "post/region.glsl"

uniform float radius;           // [m]

out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy), first = ivec2(region.xy), last = first + ivec2(region.zw) - 1;
    vec2 own = texelFetch(picture, texel, 0).xy;
    float tolerance = 0.3 * radius + 0.02 * own.y;
    vec2 sum = vec2(0.0);
    for (int i = 0; i < 16; ++i) {
        vec2 found = texelFetch(picture, clamp(texel + ivec2(i & 3, i >> 2) - 1, first, last), 0).xy;
        float weight = max(1.0 - abs(found.y - own.y) / tolerance, 0.0);
        sum += weight * vec2(found.x, 1.0);
    }
    colour = vec4(sum.x / sum.y, own.y, 0.0, 1.0);
}
