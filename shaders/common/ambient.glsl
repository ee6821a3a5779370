// Ambient visibility of the sky, computed in screen space (shaders/ambient).

#ifdef AMBIENT_OCCLUSION
layout(binding = 23) uniform sampler2D ssao;    // visibility, distance along the view axis [m]; both eyes side by side
layout(std140, binding = 6) uniform OpennessBlock {
    vec4 ssao_place[2];                         // per eye: corner of its view [px], texels per pixel
    vec4 ssao_texels[2];                        // per eye: first and last column, last row
};

// Depth-aware bilinear upsampling from half resolution (Kopf et al. 2007).
float screen_visibility() {
    float away = 1.0 / gl_FragCoord.w;          // along the view axis of either eye
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
