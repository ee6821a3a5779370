// Edges of triangles, drawn as lines by the rasteriser.
out vec4 colour;

void main() {
    colour = vec4(0.10, 0.95, 0.80, 0.75);
}
