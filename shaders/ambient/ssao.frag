// Ambient visibility from the depth buffer (Scalable Ambient Obscurance: McGuire et al. 2012, eq. 1-10). The normal
// comes from the neighbour of nearer depth on each axis, so that it does not cross edges.
#include "post/region.glsl"
#include "common/view.glsl"

uniform float radius;           // radius of the occluders [m]
uniform float strength;

out vec4 colour;

const int SAMPLES = 8;
const float FULL = 1.25;        // at the foot of a wall half of the light is occluded, as by an infinite one
const float GOLDEN_ANGLE = 2.3999632;
const float FARTHEST = 6e4;

// Distance along the view axis, from the depth of any projection along the camera's axes.
float distance_of(float depth) {
    float slope = dot(vec3(clip_from_eye[0].z, clip_from_eye[1].z, clip_from_eye[2].z), axis_back.xyz);
    return min(clip_from_eye[3].z / (2.0 * depth - 1.0 + slope), FARTHEST);
}

vec3 point_at(ivec2 texel) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(region.zw) - 1);
    float away = distance_of(texelFetch(picture, ivec2(region.xy) + inside, 0).r);
    vec2 slope = mix(tangents.xz, tangents.yw, (vec2(inside) + 0.5) / region.zw);
    return vec3(slope * away, -away);
}

vec3 nearer(vec3 a, vec3 b) {
    return abs(a.z) < abs(b.z) ? a : b;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy - region.xy);
    vec3 here = point_at(texel);
    vec3 across = nearer(point_at(texel + ivec2(1, 0)) - here, here - point_at(texel - ivec2(1, 0)));
    vec3 along = nearer(point_at(texel + ivec2(0, 1)) - here, here - point_at(texel - ivec2(0, 1)));
    vec3 normal = normalize(cross(across, along));
    float away = -here.z;
    float texels = min(radius * region.z / (away * (tangents.y - tangents.x)), 0.25 * region.w);
    // Sixteen rotations of the sampling pattern per 4 x 4 texels, which the blur averages.
    int turn = (5 * (texel.x & 3) + 7 * (texel.y & 3) + 4 * ((texel.x >> 1) & (texel.y & 1))) & 15;
    float closed = 0.0, r2 = radius * radius;
    for (int i = 0; i < SAMPLES; ++i) {
        float angle = GOLDEN_ANGLE * float(i) + 0.39269908 * float(turn);
        float reach = texels * (float(i) + 0.5) / float(SAMPLES);
        vec3 to = point_at(texel + ivec2(round(reach * vec2(cos(angle), sin(angle))))) - here;
        float d2 = dot(to, to), within = max(r2 - d2, 0.0);
        float rise = max(dot(to, normal) - 0.02 * radius - 0.002 * away, 0.0);
        closed += within * within * within * rise / (d2 + 1e-4 * r2);
    }
    closed *= FULL * strength / (float(SAMPLES) * r2 * r2 * r2);
    // The unit of the sum is 1/m: the radius makes it a share of the hemisphere.
    float open = texels < 1.0 || away >= FARTHEST ? 1.0 : clamp(1.0 - radius * closed, 0.0, 1.0);
    colour = vec4(open, away, 0.0, 1.0);
}
