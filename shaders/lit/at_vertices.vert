// Opaque, masked or blended surface of small triangles, lit by sun, lights and sky at its vertices.
#include "common/view.glsl"
#include "common/eyes.glsl"
#include "common/instance.glsl"
#include "common/material_block.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"

#ifdef COLOURED
in vec4 in_colour;
#endif

#ifdef TEXTURED
out vec4 scattered;             // light per unit of the texture's colour, linear, through the fog; w: alpha
out vec4 added;                 // light that does not depend on it, linear, with the fog's; w: factor on display values
out vec2 uv;
#else
out vec4 shown;                 // display values; w: alpha
#endif

void main() {
    vec3 position_eye = instance_position();
    put_at(position_eye);
    vec3 sight = position_eye - eye_places[EYE].xyz;
    float distance = length(sight);
    vec3 n = normalize(instance_normal());
#ifdef SOFT
    vec2 sun = sun_and_tone(position_eye + CREEP_DEPTH * map_strength.z * sun_direction.xyz, n);
#else
    vec2 sun = sun_and_tone(position_eye, n);
#endif
    vec4 tint = base_colour;
#ifdef COLOURED
    tint *= in_colour;
#endif
    vec3 emitted = vec3(0.0);
#ifdef EMISSIVE
    emitted = emission.rgb;
#endif
    Surface surface = make_surface(tint.rgb, metallic_roughness.x, metallic_roughness.y, n, sight / -distance);
    vec3 light = shine(surface, metallic_roughness.y, position_eye, sun.x, 1.0);
#ifdef TEXTURED
    // The light of a dielectric is linear in its base colour: what a black one reflects, and what the colour adds.
    Surface black = make_surface(vec3(0.0), metallic_roughness.x, metallic_roughness.y, n, sight / -distance);
    vec3 mirrored = shine(black, metallic_roughness.y, position_eye, sun.x, 1.0);
    scattered = vec4(fog_share(distance) * (light - mirrored), tint.a);
    added = vec4(apply_fog(mirrored + emitted, distance), sun.y);
    uv = in_uv;
#else
    shown = vec4(sun.y * encode_output(apply_fog(light + emitted, distance)), tint.a);
#endif
}
