// One material. Filled by rendering/visual/materials.py: same order, std140.

layout(std140, binding = 1) uniform MaterialBlock {
    vec4 base_colour;           // linear RGBA
    vec4 emission;              // linear; w: alpha below which a masked material draws nothing, -1 for no mask
    vec4 finish;                // metallic, roughness, grid spacing [m], 1 for double-sided
    vec4 uv_scale;              // on both texture coordinates
};

#ifdef TEXTURED
layout(binding = 0) uniform sampler2D base_texture;
#endif

vec4 material_colour(vec4 vertex_colour, vec2 uv) {
    vec4 colour = base_colour * vertex_colour;
#ifdef TEXTURED
    colour *= texture(base_texture, uv * uv_scale.xy);
#endif
    return colour;
}
