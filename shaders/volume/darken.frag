// One factor over the whole viewport, for multiplicative blending.
uniform float tone;

out vec4 colour;

void main() {
    colour = vec4(vec3(tone), 1.0);
}
