// Edges of triangles, drawn as lines by the rasteriser.
out vec4 colour;

void main() {
    colour = vec4(0.86, 0.93, 1.0, 0.55);
}
