// One triangle over the whole viewport; values common to all pixels are computed here.
#include "common/triangle.glsl"

layout(binding = 20) uniform sampler2D picture;
uniform vec4 region;            // see post/region.glsl

out vec2 region_at;
out vec2 picture_at;            // position of the pixel in the texture, 0 to 1
flat out vec4 inside;

void main() {
    vec2 corner = triangle_corner();
    region_at = region.xy + (0.5 + 0.5 * corner) * region.zw;
    picture_at = region_at / vec2(textureSize(picture, 0));
    inside = vec4(region.xy + 0.5, region.xy + region.zw - 0.5);
    gl_Position = vec4(corner, 0.0, 1.0);
}
