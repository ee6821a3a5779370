// Lines with antialiased edges.
uniform float strength;         // factor on the opacity

noperspective in float across;
noperspective in float half_width;
flat in vec4 ink;
out vec4 colour;

void main() {
    colour = vec4(ink.rgb, strength * ink.a * clamp(half_width + 0.5 - abs(across), 0.0, 1.0));
}
