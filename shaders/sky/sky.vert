// One triangle over the whole view, at the far plane.
#include "common/triangle.glsl"
#include "common/view.glsl"

out vec3 direction;

void main() {
    vec2 corner = triangle_corner();
    vec2 share = 0.5 + 0.5 * corner;
    vec2 slope = mix(tangents.xz, tangents.yw, share);
    direction = axis_right.xyz * slope.x + axis_up.xyz * slope.y - axis_back.xyz;
    gl_Position = vec4(corner, 1.0, 1.0);
}
