// A picture in space: cut out, or blended with its alpha multiplied in, so that covering and adding are one state.
#ifdef LIT
#define MATT
#endif
#include "common/view.glsl"
#include "common/output.glsl"
#ifdef LIT
#include "common/sky.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#endif

layout(binding = 0) uniform sampler2DArray pictures;    // display values

in vec3 position_eye;
in vec2 corner;
flat in vec4 sprite_tint;
flat in vec4 sprite_style;
out vec4 colour;

#ifdef LIT
// Rounded like a ball, as far as the sprite's roundness goes. Its axes are how the position changes from corner to corner.
vec3 sprite_normal(vec3 view) {
    mat2x3 axes = mat2x3(dFdx(position_eye), dFdy(position_eye)) * inverse(mat2(dFdx(corner), dFdy(corner)));
    vec3 right = normalize(axes[0]), up = normalize(axes[1]);
    vec3 flat_normal = cross(right, up);
    flat_normal *= dot(flat_normal, view) < 0.0 ? -1.0 : 1.0;
    vec3 ball = corner.x * right + corner.y * up + sqrt(max(1.0 - dot(corner, corner), 0.0)) * flat_normal;
    return normalize(mix(flat_normal, ball, sprite_style.z));
}
#endif

void main() {
    vec4 picture = texture(pictures, vec3(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y, sprite_style.x));
    float cover = picture.a * sprite_tint.a;
#ifdef MASKED
    if (cover < sprite_style.w) discard;
#endif
    vec3 light = decode_srgb(picture.rgb) * sprite_tint.rgb;
    vec3 sight = position_eye - eye_places[0].xyz;
    float distance = length(sight);
#ifdef LIT
    vec3 view = sight / -distance;
    vec3 normal = sprite_normal(view);
    vec2 sun = sun_and_tone(position_eye, normal);
    light = shine(make_surface(light, 0.0, 1.0, normal, view), 1.0, position_eye, sun.x, 1.0);
    float tone = sun.y;
#else
    const float tone = 1.0;
#endif
    // Haze covers what covers; of what only adds light it lets less through.
    float opacity = sprite_style.y;
    light = apply_fog(light, distance) - (1.0 - opacity) * apply_fog(vec3(0.0), distance);
#ifdef MASKED
    colour = vec4(tone * encode_output(light), 1.0);
#else
    colour = vec4(tone * encode_output(light) * cover, cover * opacity);
#endif
}
