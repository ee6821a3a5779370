// Linear light to display code values, written by hand so that every backend gives the same picture.

// Khronos PBR neutral tone mapper: colours below 0.76 keep their hue and, but for a small toe, their value.
vec3 tone_map_neutral(vec3 colour) {
    const float start = 0.76;
    const float desaturation = 0.15;
    float least = min(colour.r, min(colour.g, colour.b));
    float offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
    colour -= offset;
    float peak = max(colour.r, max(colour.g, colour.b));
    float room = 1.0 - start;
    float compressed = 1.0 - room * room / (peak + room - start);
    float grey = 1.0 - 1.0 / (desaturation * (peak - compressed) + 1.0);
    vec3 bright = mix(colour * (compressed / max(peak, 1e-6)), vec3(compressed), grey);
    return peak < start ? colour : bright;
}

vec3 encode_srgb(vec3 linear) {
    vec3 clamped = clamp(linear, 0.0, 1.0);
    vec3 curve = 1.055 * pow(clamped, vec3(1.0 / 2.4)) - 0.055;
    return mix(12.92 * clamped, curve, step(0.0031308, clamped));
}

vec3 encode_output(vec3 linear) {
    vec3 exposed = linear * sky_zenith.w;
    return encode_srgb(sky_ground.w > 0.5 ? tone_map_neutral(max(exposed, 0.0)) : exposed);
}

// Haze with distance.
vec3 apply_fog(vec3 linear, float distance) {
    float depth = fog_figures.x * max(distance - fog_figures.y, 0.0);
    float lost = fog_figures.z < 0.5 ? depth * depth : depth;
    float seen = fog_figures.z < 1.5 ? exp2(-1.4427 * lost) : 1.0 - min(depth, 1.0);
    return mix(fog_colour.rgb, linear, seen);
}
