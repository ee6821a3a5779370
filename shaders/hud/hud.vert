// Rectangles of the heads-up display, one instance each, on a plane in front of the eyes.
uniform mat4 clip_from_hud;

in vec4 box;                    // x, y of the lower left corner, width, height [hud px]
in vec4 picture;                // rectangle in the atlas or the image [uv]
in vec4 tint;                   // display values, straight alpha
in vec4 style;                  // kind, corner radius [hud px], border width [hud px], image layer

out vec2 at;                    // from the centre [hud px]
out vec2 uv;
flat out vec2 half_size;
flat out vec4 box_tint;
flat out vec4 box_style;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 position = box.xy + corner * box.zw;
    half_size = 0.5 * box.zw;
    at = (corner - 0.5) * box.zw;
    uv = picture.xy + corner * picture.zw;
    box_tint = tint;
    box_style = style;
    gl_Position = clip_from_hud * vec4(position, 0.0, 1.0);
}
