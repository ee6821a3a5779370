// Sprites: alpha-tested, or blended with premultiplied alpha, so that covering and additive sprites share one state.
#ifdef ROUND
#define MATT
#endif
#include "common/view.glsl"
#include "common/output.glsl"
#ifdef ROUND
#include "common/sky.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#endif

#ifndef DOTS
layout(binding = 0) uniform sampler2DArray pictures;    // display values
#endif

in vec2 corner;
flat in vec4 sprite_style;
#ifdef ROUND
in vec3 position_eye;
flat in vec4 sprite_tint;
#else
SHADE in vec4 sprite_white;
#ifdef HAZE
SHADE in vec3 sprite_black;
#endif
#endif
out vec4 colour;

#ifdef ROUND
// Normal of a ball, mixed by the sprite's roundness; the sprite's axes come from screen-space derivatives.
vec3 sprite_normal(vec3 view) {
    mat2x3 axes = mat2x3(dFdx(position_eye), dFdy(position_eye)) * inverse(mat2(dFdx(corner), dFdy(corner)));
    vec3 right = normalize(axes[0]), up = normalize(axes[1]);
    vec3 flat_normal = cross(right, up);
    flat_normal *= dot(flat_normal, view) < 0.0 ? -1.0 : 1.0;
    vec3 ball = corner.x * right + corner.y * up + sqrt(max(1.0 - dot(corner, corner), 0.0)) * flat_normal;
    return normalize(mix(flat_normal, ball, sprite_style.z));
}

// Shaded colour in display values.
vec3 shown(vec3 picture) {
    vec3 base = decode_srgb(picture) * sprite_tint.rgb;
    vec3 sight = position_eye - eye_places[0].xyz;
    float distance = length(sight);
    vec3 view = sight / -distance;
    vec3 normal = sprite_normal(view);
    vec2 sun = sun_and_tone(position_eye, normal);
    vec3 light = shine(make_surface(base, 0.0, 1.0, normal, view), 1.0, position_eye, sun.x, 1.0);
    // Fog covers a covering sprite and only attenuates an additive one.
    light = apply_fog(light, distance) - (1.0 - sprite_style.y) * apply_fog(vec3(0.0), distance);
    return sun.y * encode_output(light);
}
#define OWN_ALPHA sprite_tint.a
#else
// Interpolates between the colours for black and white, which are computed per vertex: exact for these two.
vec3 shown(vec3 picture) {
#ifdef HAZE
    return mix(sprite_black, sprite_white.rgb, picture);
#else
    return sprite_white.rgb * picture;
#endif
}
#define OWN_ALPHA sprite_white.a
#endif

#ifdef DOTS
// The texture "dot" of world/content/materials/sprite_pictures.py as a formula: a spot with a soft edge. A dot no larger than a
// pixel has the mean of its square; in between, a mixture keeps the mean at any size.
const float MEAN = 0.3 * 3.14159265 / 4.0;
const float BLURRED = 0.35;

vec4 picture_at_corner() {
    vec2 across = vec2(dFdx(corner.x), dFdy(corner.x)), along = vec2(dFdx(corner.y), dFdy(corner.y));
    float pixel2 = 0.5 * (dot(across, across) + dot(along, along));
    float inside = clamp(1.0 - length(corner), 0.0, 1.0);
    return vec4(vec3(1.0), mix(inside * inside * (3.0 - 2.0 * inside), MEAN, min(BLURRED * pixel2, 1.0)));
}
#else
vec4 picture_at_corner() {
    return texture(pictures, vec3(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y, sprite_style.x));
}
#endif

void main() {
    vec4 picture = picture_at_corner();
    float cover = picture.a * OWN_ALPHA;
#ifdef MASKED
    if (cover < sprite_style.w) discard;
    colour = vec4(shown(picture.rgb), 1.0);
#else
    colour = vec4(shown(picture.rgb) * cover, cover * sprite_style.y);
#endif
}
