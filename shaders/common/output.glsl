// Linear light to display values, computed here so that every backend gives the same picture.
#include "common/tone.glsl"

vec3 encode_output(vec3 linear) {
    vec3 exposed = linear * sky_zenith.w;
    return encode_srgb(sky_ground.w > 0.5 ? tone_map_neutral(max(exposed, 0.0)) : exposed);
}

// Transmittance of the fog.
float fog_share(float distance) {
    float depth = fog_figures.x * max(distance - fog_figures.y, 0.0);
    float lost = fog_figures.z < 0.5 ? depth * depth : depth;
    return fog_figures.z < 1.5 ? exp2(-1.4427 * lost) : 1.0 - min(depth, 1.0);
}

// Fog by distance.
vec3 apply_fog(vec3 linear, float distance) {
    return mix(fog_colour.rgb, linear, fog_share(distance));
}
