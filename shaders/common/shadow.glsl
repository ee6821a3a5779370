// Share of the sun, or of a spot light, that reaches a point.

#if defined(SUN_SHADOW) || defined(SPOT_SHADOWS)
layout(binding = 1) uniform sampler2DShadow shadow_map;

// Four bilinear comparisons one texel apart weigh the 3 x 3 texels around a point (1-f, 1, f) each way. Each residue
// of the texel number modulo 2 gets the same total, so that the 2 x 2 pattern of translucent casters leaves no trace.
float filtered_shadow(vec3 at) {
    float half_texel = 0.5 * shadow.x;
    vec4 lit = vec4(
        texture(shadow_map, at + vec3(-half_texel, -half_texel, 0.0)),
        texture(shadow_map, at + vec3(half_texel, -half_texel, 0.0)),
        texture(shadow_map, at + vec3(-half_texel, half_texel, 0.0)),
        texture(shadow_map, at + vec3(half_texel, half_texel, 0.0)));
    return dot(lit, vec4(0.25));
}

// A place of a tile that the filter does not leave.
bool in_tile(vec2 at, float width) {
    vec2 edge = abs(at - 0.5);
    return max(edge.x, edge.y) < 0.5 - 2.0 * shadow.x / width;
}
#endif

#ifdef SUN_CASCADES
#define SUN_MAPS 4
#else
#define SUN_MAPS 1
#endif

float sun_visibility(vec3 position_eye, vec3 normal) {
#ifdef SUN_SHADOW
    // All maps look the same way and have texels of one size in the atlas: one projection serves them all. The count is
    // a constant: with one that is not, software renderers gather every number from memory pixel by pixel.
    vec3 first = (shadow_from_eye * vec4(position_eye, 1.0)).xyz;
    vec3 lift = mat3(shadow_from_eye) * normal;
    vec3 place = vec3(0.0);
    bool asked = false;
    for (int i = SUN_MAPS - 1; i >= 0; --i) {
        vec3 at = first * shadow_scale[i].xxy + shadow_offset[i].xyz;
        vec2 edge = abs(at.xy - shadow_tile[i].xy);
        at.z += lift.z * shadow_scale[i].z;
        bool inside = max(edge.x, edge.y) < shadow_scale[i].w;
        place = inside ? at : place;
        asked = asked || inside;
    }
    place.xy += lift.xy * shadow.z;
    return asked ? filtered_shadow(place) : 1.0;
#else
    return 1.0;
#endif
}

// Share of the sun that arrives, and the tone of the finished picture: modulative shadows darken that instead.
vec2 sun_and_tone(vec3 position_eye, vec3 normal) {
    float share = sun_visibility(position_eye, normal);
#ifdef SUN_SHADOW
    return shadow.y > 0.0 ? vec2(1.0, mix(shadow.y, 1.0, share)) : vec2(share, 1.0);
#else
    return vec2(share, 1.0);
#endif
}

#ifdef SPOT_SHADOWS
float spot_visibility(int light, vec3 position_eye, vec3 normal) {
    int i = int(light_shadow[light].x);
    if (i < 0) return 1.0;
    float away = length(light_position[light].xyz - position_eye);
    vec4 at = spot_from_eye[i] * vec4(position_eye + normal * (0.75 * away * spot_tile[i].w), 1.0);
    vec3 place = at.xyz / at.w;
    bool asked = at.w > 0.0 && in_tile(place.xy, spot_tile[i].z);
    return asked ? filtered_shadow(vec3(spot_tile[i].xy + place.xy * spot_tile[i].z, place.z)) : 1.0;
}
#endif
