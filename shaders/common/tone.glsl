// Tone map and transfer function, and their inverses.

const float TONE_START = 0.76;
const float TONE_DESATURATION = 0.15;
const float TONE_TOE = 0.04;
const float TONE_TOE_HALF = 0.08;

// Khronos PBR neutral tone mapper: colours below 0.76 keep their hue and, but for a small toe, their value. The toe
// subtracts the specular reflection of white surroundings, 0.04, but at most half of a dark colour: Khronos' own leaves
// an eighth of 0.02, so that any shade becomes black with the hue of the sky.
vec3 tone_map_neutral(vec3 colour) {
    float smallest = min(colour.r, min(colour.g, colour.b));
    colour -= TONE_TOE * smallest / (smallest + TONE_TOE_HALF);
    float peak = max(colour.r, max(colour.g, colour.b));
    float headroom = 1.0 - TONE_START;
    float compressed = 1.0 - headroom * headroom / (peak + headroom - TONE_START);
    float grey = 1.0 - 1.0 / (TONE_DESATURATION * (peak - compressed) + 1.0);
    vec3 bright = mix(colour * (compressed / max(peak, 1e-6)), vec3(compressed), grey);
    return peak < TONE_START ? colour : bright;
}

// Inverse of `tone_map_neutral`; values saturate at about thirty times white.
vec3 undo_tone_map_neutral(vec3 colour) {
    float compressed = min(max(colour.r, max(colour.g, colour.b)), 0.998);
    float headroom = 1.0 - TONE_START;
    float peak = headroom * headroom / (1.0 - compressed) - headroom + TONE_START;
    float kept = 1.0 / (TONE_DESATURATION * (peak - compressed) + 1.0);
    vec3 hue = max((colour - compressed * (1.0 - kept)) / kept, 0.0);
    vec3 bright = hue * (peak / compressed);
    vec3 risen = compressed < TONE_START ? colour : bright;
    float smallest = min(risen.r, min(risen.g, risen.b));
    float half_sum = 0.5 * (smallest - TONE_TOE);     // smallest = x - TOE x / (x + HALF), solved for x
    return risen + (half_sum + sqrt(half_sum * half_sum + TONE_TOE_HALF * smallest) - smallest);
}

// IEC 61966-2-1. The power of 1 / 2.4 is a polynomial of the fourth root, with an error below 0.009 of 255 levels:
// software renderers compute a power by two series per colour, and a root by one instruction.
vec3 encode_srgb(vec3 linear) {
    vec3 clamped = clamp(linear, 0.0, 1.0);
    vec3 root = sqrt(sqrt(clamped));
    vec3 curve = (((0.08132962 * root - 0.33550068) * root + 1.12268086) * root + 0.19613613) * root - 0.06461157;
    return mix(12.92 * clamped, curve, step(0.0031308, clamped));
}

// Inverse, a polynomial with an error below 0.013 of 255 levels.
vec3 decode_srgb(vec3 display) {
    vec3 clamped = clamp(display, 0.0, 1.0);
    vec3 curve = ((0.08728385 * clamped - 0.30738132) * clamped + 0.66716393) * clamped + 0.51938075;
    curve = (curve * clamped + 0.03274626) * clamped + 0.00091688;
    return mix(clamped / 12.92, curve, step(0.04045, clamped));
}
