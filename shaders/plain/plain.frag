// A picture times the light of its corners.
#ifdef TEXTURED
layout(binding = 0) uniform sampler2DArray pictures;
#endif

in vec3 at;
in vec3 shade;
out vec4 colour;

void main() {
#ifdef TEXTURED
    colour = vec4(texture(pictures, at).rgb * shade, 1.0);
#else
    colour = vec4(shade, 1.0);
#endif
}
