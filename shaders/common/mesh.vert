// A mesh instance, from the object frame to the frame "eye"; shared by all techniques.
#include "common/view.glsl"
#include "common/eyes.glsl"
#include "common/material_block.glsl"

in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
in vec4 eye_row0;               // rows of eye_from_object
in vec4 eye_row1;
in vec4 eye_row2;
#ifdef COLOURED
in vec4 in_colour;
#endif

out vec3 position_eye;
out vec3 normal;
out vec2 uv;
#ifdef COLOURED
out vec4 tint;
#else
flat out vec4 tint;
#endif

void main() {
    mat3 axes = transpose(mat3(eye_row0.xyz, eye_row1.xyz, eye_row2.xyz));
    // The cofactor matrix transforms normals under any scale and shear, without a division.
    mat3 turn = mat3(cross(axes[1], axes[2]), cross(axes[2], axes[0]), cross(axes[0], axes[1]));
    vec4 position = vec4(in_position, 1.0);
    position_eye = vec3(dot(eye_row0, position), dot(eye_row1, position), dot(eye_row2, position));
    normal = turn * in_normal * (dot(axes[0], turn[0]) < 0.0 ? -1.0 : 1.0);
    uv = in_uv;
    // Per vertex, not per pixel: software renderers pay for each uniform that is read.
    tint = base_colour;
#ifdef COLOURED
    tint *= in_colour;
#endif
    put_at(position_eye);
}
