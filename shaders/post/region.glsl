// A region of a texture outside of which a filter does not sample, so that adjacent views do not mix.
layout(binding = 20) uniform sampler2D picture;
uniform vec4 region;            // lower left corner, width, height [texels]

in vec2 region_at;              // position of the pixel in the texture [texels]
flat in vec4 inside;            // centres of the outermost texels, lower left and upper right

// Bilinear sample; `at` in texels.
vec4 region_texel(vec2 at) {
    return textureLod(picture, clamp(at, inside.xy, inside.zw) / vec2(textureSize(picture, 0)), 0.0);
}

vec3 region_colour(vec2 at) {
    return region_texel(at).rgb;
}
