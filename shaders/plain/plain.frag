// A texture times the interpolated light of the vertices, plus fog.
#ifdef TEXTURED
layout(binding = 0) uniform sampler2DArray pictures;
#endif

in vec3 at;
in vec3 shade;
#ifdef HAZE
in vec3 haze;
#else
const vec3 haze = vec3(0.0);
#endif
out vec4 colour;

void main() {
#ifdef TEXTURED
    colour = vec4(texture(pictures, at).rgb * shade + haze, 1.0);
#else
    colour = vec4(shade + haze, 1.0);
#endif
}
