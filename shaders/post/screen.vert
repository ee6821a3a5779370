// One triangle over the whole viewport; values common to all pixels are computed here.
layout(binding = 20) uniform sampler2D picture;
uniform vec4 region;            // see post/region.glsl

out vec2 region_at;
out vec2 picture_at;            // position of the pixel in the texture, 0 to 1
flat out vec4 inside;

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    region_at = region.xy + (0.5 + 0.5 * corner) * region.zw;
    picture_at = region_at / vec2(textureSize(picture, 0));
    inside = vec4(region.xy + 0.5, region.xy + region.zw - 0.5);
    gl_Position = vec4(corner, 0.0, 1.0);
}
