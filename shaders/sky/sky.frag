// Sky gradient with the sun's glow, and a backdrop over it: a textured box, dome or plane.
#include "common/view.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"

#ifdef BOX
layout(binding = 9) uniform samplerCube backdrop;
#else
layout(binding = 9) uniform sampler2D backdrop;
#endif
#ifdef PLANE
uniform float height;           // of the plane over the width of a texture tile
#endif

in vec3 direction;
out vec4 colour;

// Linear light of the backdrop in a direction, and its coverage of the sky.
vec4 backdrop_light(vec3 towards) {
#if defined(BOX)
    return texture(backdrop, towards);
#elif defined(DOME)
    vec2 at = vec2(0.5 + 0.15915494 * atan(towards.x, -towards.z), 0.31830989 * acos(clamp(towards.y, -1.0, 1.0)));
    return textureLod(backdrop, at, 0.0);
#elif defined(PLANE)
    float up = max(towards.y, 1e-3);
    vec4 light = texture(backdrop, towards.xz * (height / up));
    return vec4(light.rgb, light.a * smoothstep(0.02, 0.25, towards.y));
#else
    return vec4(0.0);
#endif
}

void main() {
    vec3 towards = normalize(direction);
    vec4 over = backdrop_light(towards);
    // Below the horizon, fog hides the ground: the horizon's colour.
    towards.y = max(towards.y, 0.0);
    float glow = clamp(dot(towards, sun_direction.xyz), 0.0, 1.0);
    glow *= glow;
    glow *= glow;
    vec3 light = sky_radiance(towards) + 0.25 * glow * glow * sun_colour.rgb;
    colour = vec4(encode_output(mix(light, over.rgb, over.a)), 1.0);
}
