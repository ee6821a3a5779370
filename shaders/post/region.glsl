// A part of a picture that a filter does not look out of, so that views beside each other stay apart.
layout(binding = 20) uniform sampler2D picture;
uniform vec4 region;            // lower left corner, width, height [texels]

in vec2 place;                  // 0 to 1 over what is drawn

vec2 region_texel() {
    return region.xy + place * region.zw;
}

// Linearly filtered; `at` in texels.
vec3 region_colour(vec2 at) {
    vec2 inside = clamp(at, region.xy + 0.5, region.xy + region.zw - 0.5);
    return textureLod(picture, inside / vec2(textureSize(picture, 0)), 0.0).rgb;
}
