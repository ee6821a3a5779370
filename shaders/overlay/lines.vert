// Lines with a width in pixels, one instance each, which may taper, as arrow heads do.
uniform mat4 clip_from_eye;
uniform vec2 size_px;           // of the view

in vec3 begin;                  // frame "eye" [m]
in vec3 end;
in vec4 tint;                   // display values, straight alpha
in vec2 widths;                 // at begin and end [px]

noperspective out float across; // from the centre line [px]
noperspective out float half_width;
flat out vec4 ink;

const float MARGIN = 1.0;       // for the soft edge [px]

void main() {
    vec4 a = clip_from_eye * vec4(begin, 1.0), b = clip_from_eye * vec4(end, 1.0);
    float before_a = a.z + a.w, before_b = b.z + b.w;
    ink = tint;
    if (before_a <= 0.0 && before_b <= 0.0) {
        across = half_width = 0.0;
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    // Clip at the near plane, behind which screen positions are meaningless.
    if (before_a < 0.0) a = mix(a, b, before_a / (before_a - before_b));
    if (before_b < 0.0) b = mix(b, a, before_b / (before_b - before_a));
    vec2 along = (b.xy / b.w - a.xy / a.w) * size_px;
    vec2 direction = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
    bool at_end = gl_VertexID > 1;
    float side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
    half_width = 0.5 * (at_end ? widths.y : widths.x);
    across = side * (half_width + MARGIN);
    vec4 position = at_end ? b : a;
    position.xy += vec2(-direction.y, direction.x) * across * 2.0 / size_px * position.w;
    gl_Position = position;
}
