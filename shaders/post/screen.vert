// One triangle over the whole viewport; values common to all pixels are computed here.
uniform vec4 region;            // see post/region.glsl

out vec2 region_at;
flat out vec4 inside;

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    region_at = region.xy + (0.5 + 0.5 * corner) * region.zw;
    inside = vec4(region.xy + 0.5, region.xy + region.zw - 0.5);
    gl_Position = vec4(corner, 0.0, 1.0);
}
