// Radiance of the sky, and its irradiance of a surface.

vec3 sky_radiance(vec3 direction) {
    float up = clamp(direction.y, 0.0, 1.0);
    float down = clamp(-4.0 * direction.y, 0.0, 1.0);
    float low = 1.0 - up;
    vec3 above = mix(sky_zenith.rgb, sky_horizon.rgb, low * low * low);
    return mix(above, sky_ground.rgb, down * down * (3.0 - 2.0 * down));
}

// Irradiance over pi of a surface: a quadratic of its normal's height (Lighting.sky_light).
vec3 sky_irradiance(vec3 normal) {
    return sky_light[0].rgb + normal.y * (sky_light[1].rgb + normal.y * sky_light[2].rgb);
}
