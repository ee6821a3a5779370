// Opaque, masked or blended surface lit by sun, lights and sky.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#include "common/ambient.glsl"
#include "common/grid.glsl"

out vec4 colour;

void main() {
    vec3 sight = line_of_sight();
    float distance = length(sight);
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    // Before the textures are read: fewer values have to outlast the loop of the shadow's filter.
#ifdef SOFT
    vec2 sun = sun_and_tone(position_eye + CREEP_DEPTH * map_strength.z * sun_direction.xyz, n);
#else
    vec2 sun = sun_and_tone(position_eye, n);
#endif
    vec4 base = material_colour(tint, uv);
#ifdef MASKED
    cover_samples(base.a);
#endif
#ifdef GRID
    vec2 cells = (position_eye + eye_position_world()).xz / metallic_roughness.z;
    base.rgb = mix(base.rgb, sqrt(base.rgb), 0.5 * grid_coverage(cells));
#endif
    vec2 figures = material_finish(uv);
#ifdef NORMAL_MAP
    n = material_normal(n, position_eye, uv);
#endif
    Surface surface = make_surface(base.rgb, figures.x, figures.y, n, sight / -distance);
    float open = material_occlusion(uv) * screen_visibility();
    vec3 light = material_emission(uv) + shine(surface, figures.y, position_eye, sun.x, open);
    colour = vec4(sun.y * encode_output(apply_fog(light, distance)), base.a);
}
