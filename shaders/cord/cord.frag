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

void main() {
    vec3 n = normalize(normal);
    vec3 sight = position_eye - eye_seen.xyz;
    float distance = length(sight);
    vec2 sun = sun_and_tone(position_eye, n);
    // A twisted weave, which makes the motion of the surface visible.
    float weave = 0.5 + 0.5 * sin(3.0 * at.y + at.x / max(form.x, 1e-4) * 2.2);
    vec3 base = colour_roughness.rgb * mix(0.82, 1.0, smoothstep(0.1, 0.6, weave));
    Surface surface = make_surface(base, 0.0, colour_roughness.w, n, sight / -distance);
    float open = beside_ball(n);
    vec3 light = shine(surface, colour_roughness.w, position_eye, sun.x * past_ball(n), open);
    colour = vec4(sun.y * encode_output(apply_fog(light, distance)), 1.0);
}
