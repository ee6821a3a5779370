// A picture in space, one instance each; its corners come from rendering/visual/kernels/sprites.py.
#include "common/view.glsl"

in vec3 middle;                 // eye frame [m]
in vec3 across;                 // half the width
in vec3 along;                  // half the height
in vec4 tint;                   // linear RGBA
in vec4 style;                  // layer, opacity (1: covers, 0: adds light), roundness, cutoff

out vec3 position_eye;
out vec2 corner;
flat out vec3 right;
flat out vec3 up;
flat out vec4 sprite_tint;
flat out vec4 sprite_style;

void main() {
    corner = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
    position_eye = middle + corner.x * across + corner.y * along;
    right = normalize(across);
    up = normalize(along);
    sprite_tint = tint;
    sprite_style = style;
    gl_Position = clip_from_eye * vec4(position_eye, 1.0);
}
