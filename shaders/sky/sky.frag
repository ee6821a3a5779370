// Gradient of the sky with the sun's glow.
#include "common/view.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"

in vec3 direction;
out vec4 colour;

void main() {
    vec3 towards = normalize(direction);
    // Haze hides the ground below the horizon: what is far is the horizon's colour.
    towards.y = max(towards.y, 0.0);
    float glow = clamp(dot(towards, sun_direction.xyz), 0.0, 1.0);
    glow *= glow;
    glow *= glow;
    vec3 light = sky_radiance(towards) + 0.25 * glow * glow * sun_colour.rgb;
    colour = vec4(encode_output(light), 1.0);
}
