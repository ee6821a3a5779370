// One triangle over the whole of a texture's level.
#include "common/triangle.glsl"

out vec2 at;                    // texture coordinates

void main() {
    vec2 corner = triangle_corner();
    at = 0.5 + 0.5 * corner;
    gl_Position = vec4(corner, 0.0, 1.0);
}
