// One tone over the whole picture, for blending by multiplication.
uniform float tone;

in vec2 place;
out vec4 colour;

void main() {
    colour = vec4(vec3(tone), 1.0);
}
