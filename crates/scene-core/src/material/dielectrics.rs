//! Indices of refraction of transparent materials.

/// The index of refraction of a material by the name that Mitsuba 3 gives it (`int_ior`, `ext_ior`; upper and lower case are
/// the same), near 589 nm.
///
/// Source: mostly Hecht, "Optics", 4th edition; the list is that of Mitsuba 3.
///
/// ```
/// assert_eq!(scene_core::material::dielectrics::named("BK7"), Some(1.5046));
/// assert_eq!(scene_core::material::dielectrics::named("aether"), None);
/// ```
pub fn named(name: &str) -> Option<f32> {
    TABLE.iter().find(|row| row.0.eq_ignore_ascii_case(name)).map(|row| row.1)
}

const TABLE: [(&str, f32); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];
