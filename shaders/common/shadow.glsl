// Visibility of the sun, or of a spot light, from a point.

#if defined(SUN_SHADOW) || defined(SPOT_SHADOWS)
layout(binding = 1) uniform sampler2D shadow_map;

// Percentage-closer filter (Reeves et al. 1987) of 3 x 3 texels around a position in the atlas [texel], weights
// (1-f, 1, f) per axis: the mean of four bilinear comparisons one texel apart. All four have the same f, so that their
// texels are added before weighting. Even and odd texels have equal total weight: the 2 x 2 dither of translucent casters
// is not visible.
//
// Where the two diagonal blocks of 2 x 2 texels are alike, the other two count as such, too: all but two of the nine
// texels are known, each of which has a quarter of the weight at most. A uniform number of turns prevents unrolling.
float filtered_shadow(vec2 at, float depth) {
    vec2 low = floor(at), high = at - low, corner = low * shadow.y;
    float found = min(depth, 1.0);      // below the map counts as at its bottom
    vec4 lit = vec4(0.0);
    for (float turn = 0.0; turn < shadow.z; turn += 1.0) {
        vec2 first = vec2(turn * shadow.y, 0.0), second = shadow.y - first.xy;
        vec4 pair = step(found, textureGather(shadow_map, corner + first));
        pair += step(found, textureGather(shadow_map, corner + second));
        lit += pair;
        float sum = dot(pair, vec4(1.0));
        if (turn == 0.0 && (sum < 0.5 || sum > 7.5)) {
            lit += pair;
            break;
        }
    }
    vec2 rows = mix(lit.wx, lit.zy, high.x);
    return 0.25 * mix(rows.x, rows.y, high.y);
}
#endif

float sun_visibility(vec3 position_eye, vec3 normal) {
#ifdef SUN_SHADOW
    // SUN_SHADOW is the number of maps, a constant: with a variable, software renderers gather every uniform from memory
    // per pixel.
    mat3 sun_from_eye = transpose(mat3(sun_right.xyz, sun_up.xyz, sun_direction.xyz));
    vec3 at = sun_from_eye * position_eye, out_of_surface = sun_from_eye * normal;
    vec3 map = vec3(0.0);       // place in the innermost map that covers the point [texel], and its texels per metre
    for (int i = SUN_SHADOW - 1; i >= 0; --i) {
        vec2 centre = sun_up.w * (vec2(i & 1, i >> 1) + 0.5);
        vec2 place = at.xy * sun_map[i].z + sun_map[i].xy, away = abs(place - centre);
        map = max(away.x, away.y) < sun_right.w ? vec3(place, sun_map[i].z) : map;
    }
    // Half a texel along the normal, against self-shadowing.
    float depth = sun_colour.w + sun_direction.w * (at.z + 0.5 / map.z * out_of_surface.z);
    return map.z > 0.0 ? filtered_shadow(map.xy + 0.5 * out_of_surface.xy, depth) : 1.0;
#else
    return 1.0;
#endif
}

// Visibility of the sun, and the factor on display values: modulative shadows use the latter instead.
vec2 sun_and_tone(vec3 position_eye, vec3 normal) {
    float share = sun_visibility(position_eye, normal);
#ifdef SUN_SHADOW
    return shadow.x > 0.0 ? vec2(1.0, mix(shadow.x, 1.0, share)) : vec2(share, 1.0);
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
    vec2 edge = abs(place.xy - 0.5);
    bool inside = at.w > 0.0 && max(edge.x, edge.y) < 0.5 - 2.0 / spot_tile[i].z;
    return inside ? filtered_shadow(spot_tile[i].xy + place.xy * spot_tile[i].z, place.z) : 1.0;
}
#endif
