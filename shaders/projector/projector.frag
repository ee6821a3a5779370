// A texture projected onto a surface that is drawn again with depth test "equal" (Segal et al. 1992).
#define MATT
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#include "common/ambient.glsl"

layout(binding = 10) uniform sampler2D slide;

uniform mat4 slide_from_eye;    // to texture coordinates and depth, 0 to 1, before the division by w
uniform vec4 towards;           // xyz: unit, against parallel rays (w = 0), or their origin, eye frame [m] (w = 1)
uniform vec4 slide_tint;        // linear RGB, strength
uniform vec2 lean;              // cosines of incidence: full strength above the first, none below the second

out vec4 colour;

void main() {
    vec4 at = slide_from_eye * vec4(position_eye, 1.0);
    vec3 place = at.xyz / at.w;
    // Sampled before any discard: the mipmap level needs the neighbouring pixels.
    vec4 picture = texture(slide, vec2(place.x, 1.0 - place.y));
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    vec3 back = normalize(towards.xyz - towards.w * position_eye);
    float facing = dot(n, back);
    float cover = picture.a * slide_tint.a * smoothstep(lean.y, lean.x, facing);
    bool inside = at.w > 0.0 && all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)));
    if (!inside || cover <= 0.0) discard;
    vec3 shown = picture.rgb * slide_tint.rgb;
    vec3 sight = line_of_sight();
    float distance = length(sight);
    float seen = apply_fog(vec3(1.0), distance).r - apply_fog(vec3(0.0), distance).r;
#if defined(STAIN)
    colour = vec4(mix(vec3(1.0), encode_srgb(shown), cover * seen), 1.0);
#elif defined(LIGHT)
    vec3 albedo = material_colour(tint, uv).rgb;
    vec3 light = albedo * shown * cover * max(facing, 0.0) * seen;
    colour = vec4(encode_output(light), 1.0);
#else
    vec3 view = sight / -distance;
    Surface surface = make_surface(shown, 0.0, 1.0, n, view);
    vec2 sun = sun_and_tone(position_eye, n);
    vec3 light = shine(surface, 1.0, position_eye, sun.x, screen_visibility());
    colour = vec4(sun.y * encode_output(apply_fog(light, distance)) * cover, cover);
#endif
}
