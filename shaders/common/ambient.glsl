// Share of the sky's light that near surfaces leave, as found in the depth of the picture (shaders/ambient).

#ifdef AMBIENT_OCCLUSION
layout(binding = 23) uniform sampler2D ssao;    // share, distance along the line of sight [m]
layout(std140, binding = 6) uniform OpennessBlock {
    vec4 ssao_place;                            // corner of the view [px], texels per pixel
};

// The four texels about a pixel, those at another distance left out: it was found at half the size.
float screen_visibility(vec3 line_of_sight) {
    float away = -dot(line_of_sight, axis_back.xyz);
    vec2 at = (gl_FragCoord.xy - ssao_place.xy) * ssao_place.zw - 0.5;
    vec2 share = at - floor(at);
    ivec2 low = ivec2(floor(at)), most = textureSize(ssao, 0) - 1;
    vec2 sum = vec2(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 found = texelFetch(ssao, clamp(low + corner, ivec2(0), most), 0).xy;
        vec2 near = mix(1.0 - share, share, vec2(corner));
        float weight = near.x * near.y * max(1.0 - 10.0 * abs(found.y - away) / away, 1e-3);
        sum += weight * vec2(found.x, 1.0);
    }
    return sum.x / max(sum.y, 1e-9);
}
#else
float screen_visibility(vec3 line_of_sight) {
    return 1.0;
}
#endif
