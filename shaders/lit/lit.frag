// Opaque, masked or blended surface lit by sun, lights and sky.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#include "common/ambient.glsl"
#include "common/grid.glsl"

in vec3 position_eye;
in vec3 normal;
in vec2 uv;
in vec4 vertex_colour;
out vec4 colour;

void main() {
    vec4 base = material_colour(vertex_colour, uv);
#ifdef MASKED
    if (base.a < emission.w) discard;
#endif
#ifdef GRID
    vec2 cells = (position_eye + eye_position_world()).xz / finish.z;
    base.rgb = mix(base.rgb, sqrt(base.rgb), 0.5 * grid_coverage(cells));
#endif
    float distance = length(position_eye);
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    vec2 figures = material_finish(uv);
    float sun_share = sun_visibility(position_eye, n);
    float tone = 1.0;
#ifdef SUN_SHADOW
    // Modulative shadows darken the finished picture instead.
    tone = shadow.y > 0.0 ? mix(shadow.y, 1.0, sun_share) : 1.0;
    sun_share = shadow.y > 0.0 ? 1.0 : sun_share;
#endif
#ifdef NORMAL_MAP
    n = material_normal(n, position_eye, uv);
#endif
    Surface surface = make_surface(base.rgb, figures.x, figures.y, n, position_eye / -distance);
    float open = material_occlusion(uv) * screen_openness(position_eye);
    vec3 light = material_emission(uv) + shine(surface, figures.y, position_eye, sun_share, open);
    colour = vec4(tone * encode_output(apply_fog(light, distance)), base.a);
}
