// Share of the sky's light that near surfaces leave, as found in the depth of the picture (shaders/ambient).

#ifdef AMBIENT_OCCLUSION
layout(binding = 23) uniform sampler2D ssao;    // share, distance along the line of sight [m]; both eyes' side by side
layout(std140, binding = 6) uniform OpennessBlock {
    vec4 ssao_place[2];                         // of each eye: corner of its view [px], texels per pixel
    vec4 ssao_texels[2];                        // and what is its own: first and last texel across, last one along
};

// The four texels about a pixel, those at another distance left out: it was found at half the size.
float screen_visibility() {
    float away = 1.0 / gl_FragCoord.w;          // along the axis of whichever eye it is
    vec4 place = ssao_place[EYE_SEEN], texels = ssao_texels[EYE_SEEN];
    vec2 at = (gl_FragCoord.xy - place.xy) * place.zw - 0.5;
    vec2 share = at - floor(at);
    ivec2 first = ivec2(texels.x, 0), last = ivec2(texels.yz), low = first + ivec2(floor(at));
    vec2 sum = vec2(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 found = texelFetch(ssao, clamp(low + corner, first, last), 0).xy;
        vec2 near = mix(1.0 - share, share, vec2(corner));
        float weight = near.x * near.y * max(1.0 - 10.0 * abs(found.y - away) / away, 1e-3);
        sum += weight * vec2(found.x, 1.0);
    }
    return sum.x / max(sum.y, 1e-9);
}
#else
float screen_visibility() {
    return 1.0;
}
#endif
