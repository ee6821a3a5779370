// Share of the sun that reaches a point.

layout(binding = 1) uniform sampler2DShadow shadow_map;

// Four bilinear comparisons one texel apart weigh the 3 x 3 texels around a point (1-f, 1, f) each way. Each residue
// of the texel number modulo 2 gets the same total, so that the 2 x 2 pattern of translucent casters leaves no trace.
float sun_visibility(vec3 position_eye, vec3 normal) {
    vec3 lifted = position_eye + normal * (0.5 * shadow.y);
    vec3 at = (shadow_from_eye * vec4(lifted, 1.0)).xyz;
    float half_texel = 0.5 * shadow.x;
    vec4 lit = vec4(
        texture(shadow_map, at + vec3(-half_texel, -half_texel, 0.0)),
        texture(shadow_map, at + vec3(half_texel, -half_texel, 0.0)),
        texture(shadow_map, at + vec3(-half_texel, half_texel, 0.0)),
        texture(shadow_map, at + vec3(half_texel, half_texel, 0.0)));
    vec2 edge = abs(at.xy - 0.5);
    bool asked = sun_direction.w > 0.5 && max(edge.x, edge.y) < 0.5 - 2.0 * shadow.x;
    return asked ? dot(lit, vec4(0.25)) : 1.0;
}
