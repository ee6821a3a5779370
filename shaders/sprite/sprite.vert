// A vertex of a sprite, computed in rendering/visual/kernels/sprites.py, four per piece of a sprite.
#include "common/view.glsl"
#include "common/output.glsl"

in vec3 position;               // eye frame [m]
in vec4 tint;                   // linear RGBA
in uvec4 style;                 // layer; opacity (covering or additive), roundness and alpha cutoff as shares of 65535
in ivec2 at;                    // on the sprite, -1 to 1 as shares of 32767

out vec2 corner;
#ifdef LIT
out vec3 position_eye;
flat out vec4 sprite_tint;
#else
flat out vec4 sprite_white;     // shaded white of the texture; alpha of the sprite
#ifdef HAZE
flat out vec3 sprite_black;     // shaded black of the texture
#endif
#endif
flat out vec4 sprite_style;

#ifndef LIT
vec3 display_values(vec3 light) {
#ifdef TONED
    return encode_output(light);
#else
    return encode_srgb(light * sky_zenith.w);
#endif
}
#endif

void main() {
    corner = vec2(at) / 32767.0;
    sprite_style = vec4(style) / vec4(1.0, 65535.0, 65535.0, 65535.0);
    gl_Position = clip_from_eye * vec4(position, 1.0);
#ifdef LIT
    position_eye = position;
    sprite_tint = tint;
#elif defined(HAZE)
    // Fog covers a covering sprite and only attenuates an additive one.
    float seen = fog_share(length(position - eye_places[0].xyz));
    vec3 haze = sprite_style.y * (1.0 - seen) * fog_colour.rgb;
    sprite_white = vec4(display_values(tint.rgb * seen + haze), tint.a);
    sprite_black = display_values(haze);
#else
    sprite_white = vec4(display_values(tint.rgb), tint.a);
#endif
}
