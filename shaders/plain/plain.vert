// The cheapest lit surface: light and fog per vertex, in display values. All looks share one state: what differs comes
// with each instance. Without a tone map light counts as display values, as in fixed-function pipelines.
#include "common/view.glsl"
#include "common/eyes.glsl"
#include "common/instance.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"

in vec4 instance_params;                  // rgb: base colour, display values; w: layer + 1, negative for unlit
#ifdef COLOURED
in vec4 in_colour;
#endif

out vec3 at;
out vec3 shade;                 // factor on the texture's display values
#ifdef HAZE
out vec3 haze;                  // fog added to them
#endif

void main() {
    vec3 position_eye = instance_position();
    put_at(position_eye);
    vec3 n = normalize(instance_normal());
    vec3 light = sky_irradiance(n) + sun_colour.rgb * max(dot(n, sun_direction.xyz), 0.0);
#ifdef TONED
    light = encode_output(light);
#endif
    shade = instance_params.rgb * (instance_params.w < 0.0 ? vec3(1.0) : light);
#ifdef COLOURED
    shade *= encode_srgb(in_colour.rgb);
#endif
#ifdef HAZE
    float seen = fog_share(length(position_eye));
    shade *= seen;
    haze = (1.0 - seen) * encode_output(fog_colour.rgb);
#endif
    vec2 scale = vec2(1.0);
#ifdef MIRROR_U
    scale.x = 0.5;
#endif
#ifdef MIRROR_V
    scale.y = 0.5;
#endif
    at = vec3(in_uv * scale, abs(instance_params.w) - 1.0);
}
