// What common/mesh.vert says of a place on a surface.
in vec3 position_eye;
flat in vec3 eye_place;         // of the eye that sees it, frame "eye"
in vec3 normal;                 // not of unit length
in vec2 uv;
#ifdef COLOURED
in vec4 tint;                   // base colour of the material, times that of the vertex: linear RGBA
#else
flat in vec4 tint;
#endif

// From the eye to the place.
vec3 line_of_sight() {
    return position_eye - eye_place;
}
