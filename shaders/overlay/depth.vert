// A rectangle of the screen.
uniform vec4 rectangle;         // lower left corner and size, in [-1, 1]

out vec2 uv;

void main() {
    uv = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(rectangle.xy + uv * rectangle.zw, 0.0, 1.0);
}
