// Test pattern for aligning walls: lines of one pixel along the edges and a cross at each corner.
#include "post/region.glsl"

out vec4 colour;

void main() {
    vec2 at = region_at - region.xy, far = region.zw - at;
    vec2 edge = min(at, far);
    bool frame = min(edge.x, edge.y) < 1.0;
    bool corner = max(edge.x, edge.y) < 0.08 * min(region.z, region.w) && abs(edge.x - edge.y) < 1.0;
    bool middle = min(abs(at.x - 0.5 * region.z), abs(at.y - 0.5 * region.w)) < 0.75 && max(edge.x, edge.y) > 0.0;
    vec3 line = frame ? vec3(1.0, 0.9, 0.0) : corner ? vec3(1.0, 0.0, 0.6) : vec3(0.0, 0.9, 1.0);
    colour = vec4(frame || corner || middle ? line : region_colour(region_at), 1.0);
}
