// A rectangle on the plane of the heads-up display, with its border.
uniform mat4 clip_from_hud;
uniform vec4 box;               // lower left corner, width, height [hud px]
uniform float border;           // [hud px]

out vec2 uv;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 position = mix(box.xy - border, box.xy + box.zw + border, corner);
    uv = (position - box.xy) / box.zw;
    gl_Position = clip_from_hud * vec4(position, 0.0, 1.0);
}
