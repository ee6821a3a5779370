// One triangle over the whole viewport.

// Place of a vertex in clip space; the viewport is -1 to 1.
vec2 triangle_corner() {
    return vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
}
