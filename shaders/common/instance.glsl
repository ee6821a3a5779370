// A vertex of a mesh instance, from the object frame to the frame "eye".

in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
in vec4 eye_row0;               // rows of eye_from_object
in vec4 eye_row1;
in vec4 eye_row2;

vec3 instance_position() {
    vec4 position = vec4(in_position, 1.0);
    return vec3(dot(eye_row0, position), dot(eye_row1, position), dot(eye_row2, position));
}

// Not normalised. The cofactor matrix transforms normals under any scale and shear, without a division.
vec3 instance_normal() {
    mat3 axes = transpose(mat3(eye_row0.xyz, eye_row1.xyz, eye_row2.xyz));
    mat3 cofactors = mat3(cross(axes[1], axes[2]), cross(axes[2], axes[0]), cross(axes[0], axes[1]));
    return cofactors * in_normal * (dot(axes[0], cofactors[0]) < 0.0 ? -1.0 : 1.0);
}
