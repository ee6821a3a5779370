// A smaller picture brought to full size; the texture filters linearly.
layout(binding = 4) uniform sampler2D picture;

in vec2 place;
out vec4 colour;

void main() {
    colour = texture(picture, place);
}
