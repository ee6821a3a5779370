// The picture with a share of its light blurred.
#include "post/region.glsl"
#include "common/tone.glsl"

layout(binding = 21) uniform sampler2D wide;
uniform float share;
uniform float neutral;          // 1 where the picture is tone mapped

out vec4 colour;

void main() {
    vec3 light = decode_srgb(texelFetch(picture, ivec2(region_at), 0).rgb);
    light = neutral > 0.5 ? undo_tone_map_neutral(light) : light;
    light = mix(light, textureLod(wide, (region_at - region.xy) / region.zw, 0.0).rgb, share);
    colour = vec4(encode_srgb(neutral > 0.5 ? tone_map_neutral(light) : light), 1.0);
}
