// Uniforms of one material, filled by rendering/visual/materials/look.py: same order, std140.

layout(std140, binding = 1) uniform MaterialBlock {
    vec4 base_colour;           // linear RGBA
    vec4 emission;              // linear; w: alpha cutoff of a masked material, -1 for no mask
    vec4 metallic_roughness;                // metallic, roughness, grid spacing [m], 1 for double-sided
    vec4 map_strength;          // normal scale, occlusion strength, softness
    vec4 uv_rows[10];           // rows of the 2 x 3 texture transform of each map: base, normal, surface, ...
};
