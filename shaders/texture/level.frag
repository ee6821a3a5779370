// One level of a texture from the next finer one, the only one that can be sampled: a bilinear sample, in linear light
// where the texture stores display values.
#ifdef LAYERS
layout(binding = 20) uniform sampler2DArray finer;
uniform float layer;
#else
layout(binding = 20) uniform sampler2D finer;
#endif

in vec2 at;
out vec4 colour;

void main() {
#ifdef LAYERS
    colour = texture(finer, vec3(at, layer));
#else
    colour = texture(finer, at);
#endif
}
