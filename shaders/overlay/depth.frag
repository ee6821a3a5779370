// Depths of the shadow atlas as a relief lit from the upper left, since the sun's maps share one long depth range:
// level areas are grey, nearer ones a little brighter. Empty texels are dark blue.
layout(binding = 4) uniform sampler2D depths;
uniform float tiles;            // along a side
uniform float relief[16];       // by tile: depth range over texel width

in vec2 uv;
out vec4 colour;

void main() {
    ivec2 last = textureSize(depths, 0) - 1, texel = min(ivec2(uv * vec2(last + 1)), last);
    float depth = texelFetch(depths, texel, 0).r;
    ivec2 tile = min(ivec2(uv * tiles), ivec2(tiles) - 1);
    vec2 rise = vec2(
        depth - texelFetch(depths, min(texel + ivec2(1, 0), last), 0).r,
        depth - texelFetch(depths, max(texel - ivec2(0, 1), ivec2(0)), 0).r);
    float slope = (rise.x + rise.y) * relief[tile.y * int(tiles) + tile.x];
    float shade = 0.55 - 0.38 * slope / sqrt(1.0 + slope * slope) + 0.12 * (0.5 - depth);
    vec2 border = abs(fract(uv * tiles + 0.5) - 0.5) / fwidth(uv * tiles);
    bool edge = min(border.x, border.y) < 1.0;
    vec3 shown = depth < 1.0 ? vec3(shade) : vec3(0.05, 0.07, 0.16);
    colour = vec4(edge ? vec3(0.98, 0.76, 0.40) : shown, 0.94);
}
