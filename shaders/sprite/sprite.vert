// A corner of a picture in space; computed in rendering/visual/kernels/sprites.py, four a sprite.
#include "common/view.glsl"

in vec3 position;               // eye frame [m]
in vec4 tint;                   // linear RGBA
in uvec4 style;                 // layer; opacity (covers, or adds light), roundness and cutoff as shares of 65535

out vec3 position_eye;
out vec2 corner;
flat out vec4 sprite_tint;
flat out vec4 sprite_style;

void main() {
    corner = 2.0 * vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1) - 1.0;
    position_eye = position;
    sprite_tint = tint;
    sprite_style = vec4(style) / vec4(1.0, 65535.0, 65535.0, 65535.0);
    gl_Position = clip_from_eye * vec4(position, 1.0);
}
