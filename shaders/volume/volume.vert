// A shadow volume: corners at infinity have w = 0.
uniform mat4 clip_from_volume;

in vec4 in_corner;

void main() {
    gl_Position = clip_from_volume * in_corner;
}
