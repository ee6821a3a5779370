// The cord's surface in the light of the scene, with the shadow and the contact occlusion of a ball.
#include "common/view.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"
#include "common/shadow.glsl"
#include "common/brdf.glsl"
#include "common/lights.glsl"
#include "cord/cord_block.glsl"

in vec3 position_eye;
flat in vec4 eye_seen;          // position of the eye, frame "eye"
in vec3 normal;
in vec2 at;
out vec4 colour;

// Visibility of the light past the ball; the penumbra widens with the gap below the ball.
float past_ball(vec3 n) {
    if (ball.w <= 0.0) return 1.0;
    vec3 to_ball = ball.xyz - position_eye;
    float gap = dot(to_ball, ball_light.xyz);
    float off = length(to_ball - gap * ball_light.xyz);
    float soft = max(ball_light.w * max(gap, 0.0), 0.02 * ball.w);
    // Where the light appears larger than the ball, there is no umbra.
    float whole = min(1.0, ball.w * ball.w / (soft * soft));
    float covered = whole * (1.0 - smoothstep(ball.w - soft, ball.w + soft, off));
    return gap > 0.0 && dot(n, ball_light.xyz) > 0.0 ? 1.0 - covered : 1.0;
}

// Visibility of the sky beside the ball (Quilez): cosine-weighted occlusion by a sphere.
float beside_ball(vec3 n) {
    if (ball.w <= 0.0) return 1.0;
    vec3 to_ball = ball.xyz - position_eye;
    float d2 = dot(to_ball, to_ball);
    return 1.0 - clamp(dot(n, to_ball) * inversesqrt(d2), 0.0, 1.0) * clamp(ball.w * ball.w / d2, 0.0, 1.0);
}

// Share of a vessel below the surface: a strand that winds about the cord and wanders as it does.
float vessel(float first, float pitch, float broad) {
    float s = at.x / max(form.x, 1e-4);
    float off = at.y - first - pitch * s - 0.45 * sin(0.31 * s + 2.0 * first);
    off = abs(mod(off + 3.14159265, 6.2831853) - 3.14159265);
    return 1.0 - smoothstep(0.35 * broad, broad, off);
}

// Colour of translucent skin over a vein and two arteries, paler towards its outline; vessels show its motion.
vec3 flesh(vec3 skin, float facing) {
    vec3 base = mix(skin, mix(vec3(0.92, 0.78, 0.72), skin, 0.35), pow(1.0 - facing, 1.5));
    float mottled = 0.5 + 0.5 * sin(at.x / max(form.x, 1e-4) * 1.7 + 2.0 * sin(2.0 * at.y));
    base *= mix(0.93, 1.0, mottled);
    float depth = mix(0.30, 0.85, facing);
    base = mix(base, skin * vec3(0.52, 0.48, 0.86), 0.8 * depth * vessel(0.0, 0.17, 0.75));
    base = mix(base, skin * vec3(0.92, 0.36, 0.34), 0.7 * depth * vessel(2.2, 0.17, 0.34));
    return mix(base, skin * vec3(0.92, 0.36, 0.34), 0.7 * depth * vessel(4.1, 0.17, 0.34));
}

void main() {
    vec3 n = normalize(normal);
    vec3 sight = position_eye - eye_seen.xyz;
    float distance = length(sight);
    vec2 sun = sun_and_tone(position_eye, n);
    vec3 base = flesh(colour_roughness.rgb, abs(dot(n, sight)) / distance);
    Surface surface = make_surface(base, 0.0, colour_roughness.w, n, sight / -distance);
    float open = beside_ball(n);
    vec3 light = shine(surface, colour_roughness.w, position_eye, sun.x * past_ball(n), open);
    colour = vec4(sun.y * encode_output(apply_fog(light, distance)), 1.0);
}
