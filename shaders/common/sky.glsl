// Radiance of the sky in a direction, and the light it sheds on a surface.

vec3 sky_radiance(vec3 direction) {
    float up = clamp(direction.y, 0.0, 1.0);
    float down = clamp(-4.0 * direction.y, 0.0, 1.0);
    float low = 1.0 - up;
    vec3 above = mix(sky_zenith.rgb, sky_horizon.rgb, low * low * low);
    return mix(above, sky_ground.rgb, down * down * (3.0 - 2.0 * down));
}

// Mean radiance a surface of this normal receives from the whole sky, times its albedo is what it gives back: from
// ground to zenith with its slope, and of that the horizon's the more the steeper it stands. A cubic of the height.
vec3 sky_irradiance(vec3 normal) {
    float square = normal.y * normal.y;
    return sky_light[0].rgb + normal.y * (1.0 + square) * sky_light[1].rgb + square * sky_light[2].rgb;
}
