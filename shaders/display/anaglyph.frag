// Two pictures side by side to an anaglyph, mixed in linear light (Dubois 2001).
#include "post/region.glsl"
#include "common/tone.glsl"

uniform mat3 from_left;
uniform mat3 from_right;

out vec4 colour;

void main() {
    ivec2 at = ivec2(region_at * vec2(0.5, 1.0));
    int width = textureSize(picture, 0).x / 2;
    vec3 left = decode_srgb(texelFetch(picture, at, 0).rgb);
    vec3 right = decode_srgb(texelFetch(picture, at + ivec2(width, 0), 0).rgb);
    colour = vec4(encode_srgb(from_left * left + from_right * right), 1.0);
}
