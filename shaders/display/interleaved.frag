// Two pictures side by side to one of alternating rows: even rows, counted from the top, are the left eye's.
#include "post/region.glsl"

uniform float rows;             // of the finished picture

out vec4 colour;

void main() {
    ivec2 at = ivec2(region_at * vec2(0.5, 1.0));
    int from_top = int(rows) - 1 - at.y;
    int width = textureSize(picture, 0).x / 2;
    colour = vec4(texelFetch(picture, ivec2(at.x + (from_top & 1) * width, at.y), 0).rgb, 1.0);
}
