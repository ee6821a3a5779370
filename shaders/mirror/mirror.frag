// A plane that shows the picture drawn from behind it; where none was drawn, as in another mirror, the sky.
#include "common/view.glsl"
#include "common/material.glsl"
#include "common/surface.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"

layout(std140, binding = 5) uniform MirrorBlock {
    vec4 texel_of_pixel;        // factors and offsets; across the picture is turned over
    vec4 drawn;                 // width and height of what was drawn [texels], 0: nothing was
};

out vec4 colour;

void main() {
#ifdef TEXTURED
    vec2 at = clamp(gl_FragCoord.xy * texel_of_pixel.xy + texel_of_pixel.zw, vec2(0.5), max(drawn.xy - 0.5, 0.5));
    vec3 seen = textureLod(base_texture, at / vec2(textureSize(base_texture, 0)), 0.0).rgb;
    seen = encode_srgb(decode_srgb(seen) * base_colour.rgb);
#else
    vec3 seen = vec3(0.0);
#endif
    vec3 n = normalize(gl_FrontFacing ? normal : -normal);
    vec3 sight = line_of_sight();
    float distance = length(sight);
    vec3 sky = sky_radiance(reflect(sight / distance, n)) * base_colour.rgb;
    colour = vec4(drawn.x > 0.0 ? seen : encode_output(apply_fog(sky, distance)), 1.0);
}
