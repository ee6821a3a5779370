// The cheapest lit surface: light and fog per vertex, in display values. All looks share one state: what differs comes
// with each instance. Without a tone map light counts as display values, as in fixed-function pipelines.
#include "common/view.glsl"
#include "common/eyes.glsl"
#include "common/sky.glsl"
#include "common/output.glsl"

in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
in vec4 eye_row0;               // rows of eye_from_object
in vec4 eye_row1;
in vec4 eye_row2;
in vec4 paint;                  // rgb: base colour, display values; w: layer + 1, negative for unlit
#ifdef COLOURED
in vec4 in_colour;
#endif

out vec3 at;
out vec3 shade;                 // factor on the texture's display values
#ifdef HAZE
out vec3 haze;                  // fog added to them
#endif

void main() {
    mat3 axes = transpose(mat3(eye_row0.xyz, eye_row1.xyz, eye_row2.xyz));
    mat3 turn = mat3(cross(axes[1], axes[2]), cross(axes[2], axes[0]), cross(axes[0], axes[1]));
    vec4 position = vec4(in_position, 1.0);
    vec3 position_eye = vec3(dot(eye_row0, position), dot(eye_row1, position), dot(eye_row2, position));
    put_at(position_eye);
    vec3 n = normalize(turn * in_normal) * (dot(axes[0], turn[0]) < 0.0 ? -1.0 : 1.0);
    vec3 light = sky_irradiance(n) + sun_colour.rgb * max(dot(n, sun_direction.xyz), 0.0);
#ifdef TONED
    light = encode_output(light);
#endif
    shade = paint.rgb * (paint.w < 0.0 ? vec3(1.0) : light);
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
    at = vec3(in_uv * scale, abs(paint.w) - 1.0);
}
