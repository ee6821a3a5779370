// A part of a picture that a filter does not look out of, so that views beside each other stay apart.
layout(binding = 20) uniform sampler2D picture;
uniform vec4 region;            // lower left corner, width, height [texels]

in vec2 region_at;              // where a pixel lies in the picture [texels]
flat in vec4 inside;            // middles of the outermost texels, lower left and upper right

// Linearly filtered; `at` in texels.
vec3 region_colour(vec2 at) {
    return textureLod(picture, clamp(at, inside.xy, inside.zw) / vec2(textureSize(picture, 0)), 0.0).rgb;
}
