// Depth seen from the sun.
uniform mat4 clip_from_eye;

in vec3 in_position;
in vec2 in_uv;
in vec4 eye_row0;
in vec4 eye_row1;
in vec4 eye_row2;
out vec2 uv;

void main() {
    vec4 position = vec4(in_position, 1.0);
    uv = in_uv;
    gl_Position = clip_from_eye * vec4(dot(eye_row0, position), dot(eye_row1, position), dot(eye_row2, position), 1.0);
}
