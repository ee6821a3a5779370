// A vertex of a sprite, computed in rendering/visual/kernels/sprites.py, four per piece of a sprite. ROUND sprites
// are shaded per pixel; of others, the colours for a black and a white texture are computed here: unlit, or lit (FLAT).
#ifdef FLAT
#define MATT
#endif
#include "common/view.glsl"
#include "common/output.glsl"
#ifdef FLAT
#include "common/sky.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#endif

in vec3 position;               // eye frame [m]
in vec4 tint;                   // linear RGBA
in uvec4 style;                 // layer; opacity (covering or additive), roundness and alpha cutoff as shares of 65535
in ivec2 at;                    // on the sprite, -1 to 1 as shares of 32767
in ivec4 normal;                // unit, towards the camera, as shares of 127

out vec2 corner;
#ifdef ROUND
out vec3 position_eye;
flat out vec4 sprite_tint;
#else
SHADE out vec4 sprite_white;    // shaded white of the texture; alpha of the sprite
#ifdef HAZE
SHADE out vec3 sprite_black;    // shaded black of the texture
#endif
#endif
flat out vec4 sprite_style;

#ifndef ROUND
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
#ifdef ROUND
    position_eye = position;
    sprite_tint = tint;
#else
    vec3 light = tint.rgb;
    float shade = 1.0;
#ifdef FLAT
    vec3 n = normalize(vec3(normal.xyz));
    vec2 sun = sun_and_tone(position, n);
    Surface surface = make_surface(tint.rgb, 0.0, 1.0, n, normalize(eye_places[0].xyz - position));
    light = shine(surface, 1.0, position, sun.x, 1.0);
    shade = sun.y;
#endif
#ifdef HAZE
    // Fog covers a covering sprite and only attenuates an additive one.
    float seen = fog_share(length(position - eye_places[0].xyz));
    vec3 haze = sprite_style.y * (1.0 - seen) * fog_colour.rgb;
    sprite_white = vec4(shade * display_values(light * seen + haze), tint.a);
    sprite_black = shade * display_values(haze);
#else
    sprite_white = vec4(shade * display_values(light), tint.a);
#endif
#endif
}
