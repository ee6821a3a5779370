// A plane mirror, which shows its reflection; the sky where none was drawn, as within another mirror.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"

layout(std140, binding = 5) uniform MirrorBlock {
    vec4 texel_of_pixel[2];     // per eye: factors and offsets; x is flipped
    vec4 drawn[2];              // per eye: width and height of the reflection [texels], 0: none
};

#if defined(EYES_BY_VIEWPORT) || defined(EYES_BY_CLIPPING)
layout(binding = 25) uniform sampler2D other_texture;   // reflection for the right eye
#endif

out vec4 colour;

// Reflection for the present eye, display values.
vec3 picture_seen() {
#ifdef TEXTURED
    vec4 texel = texel_of_pixel[EYE_SEEN];
    vec2 at = clamp(gl_FragCoord.xy * texel.xy + texel.zw, vec2(0.5), max(drawn[EYE_SEEN].xy - 0.5, 0.5));
#if defined(EYES_BY_VIEWPORT) || defined(EYES_BY_CLIPPING)
    if (EYE_SEEN == 1) return textureLod(other_texture, at / vec2(textureSize(other_texture, 0)), 0.0).rgb;
#endif
    return textureLod(base_texture, at / vec2(textureSize(base_texture, 0)), 0.0).rgb;
#else
    return vec3(0.0);
#endif
}

void main() {
    vec3 seen = encode_srgb(decode_srgb(picture_seen()) * base_colour.rgb);
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    vec3 sight = line_of_sight();
    float distance = length(sight);
    vec3 sky = sky_radiance(reflect(sight / distance, n)) * base_colour.rgb;
    colour = vec4(drawn[EYE_SEEN].x > 0.0 ? seen : encode_output(apply_fog(sky, distance)), 1.0);
}
