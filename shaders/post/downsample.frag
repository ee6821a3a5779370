// Half the size: mean light of 2 x 2 texels of display values, or of 4 x 4 texels of linear light.
#include "post/region.glsl"
#include "common/tone.glsl"

#ifdef FROM_DISPLAY
uniform float neutral;          // 1 where the picture is tone mapped

vec3 light_at(vec2 at) {
    vec3 light = decode_srgb(texelFetch(picture, ivec2(clamp(at, region.xy, region.xy + region.zw - 0.5)), 0).rgb);
    return neutral > 0.5 ? undo_tone_map_neutral(light) : light;
}
const float REACH = 0.5;
#else
vec3 light_at(vec2 at) {
    return region_colour(at);
}
const float REACH = 1.0;
#endif

out vec4 colour;

void main() {
    vec2 at = region_at;
    vec3 light = light_at(at + vec2(-REACH, -REACH)) + light_at(at + vec2(REACH, -REACH));
    light += light_at(at + vec2(-REACH, REACH)) + light_at(at + vec2(REACH, REACH));
    colour = vec4(0.25 * light, 1.0);
}
