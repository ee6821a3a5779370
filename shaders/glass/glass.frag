// Translucent wall: clear at normal incidence, opaque and reflecting towards its rim. Back faces are drawn first.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"
#include "common/brdf.glsl"
#include "common/grid.glsl"

out vec4 colour;

void main() {
    vec4 base = material_colour(tint, uv);
    vec3 sight = line_of_sight();
    float distance = length(sight);
    vec3 view = sight / -distance;
    vec3 n = normalize(normal);
    n = dot(n, view) < 0.0 ? -n : n;
    float facing = max(dot(n, view), 1e-3);
    float rim = 1.0 - facing;
    rim *= rim;
#ifdef GRID
    // Rings along the wall (v is in metres) show how it bends and narrows.
    float ring = line_coverage(uv.y / metallic_roughness.z, 1.2);
#else
    float ring = 0.0;
#endif
    Surface surface = make_surface(base.rgb, 0.0, metallic_roughness.y, n, view);
    float through = 0.35 + 0.65 * abs(dot(n, sun_direction.xyz));
    vec3 body = base.rgb * (sky_irradiance(n) + through * sun_colour.rgb) + emission.rgb;
    float incidence = clamp(dot(n, sun_direction.xyz), 0.0, 1.0);
    float glint = incidence * specular_lobe(surface, sun_direction.xyz, incidence) * 0.04;
    float mirror = 0.04 + 0.7 * rim * rim;
    vec3 gloss = glint * sun_colour.rgb + mirror * sky_radiance(reflect(-view, n)) * ambient.rgb;
    float fill = clamp(base.a + 0.55 * rim + 0.35 * ring, 0.0, 1.0);
    float cover = clamp(fill + max(gloss.r, max(gloss.g, gloss.b)), 0.0, 1.0);
    vec3 light = (body * fill + gloss) / cover;
    colour = vec4(encode_output(apply_fog(light, distance)), cover);
}
