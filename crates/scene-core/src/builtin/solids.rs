//! Solid forms: rounded boxes, surfaces of revolution, tubes and plates.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use glam::Vec3A;

use super::form::Form;

impl Form {
    /// The box with half sides `half` around `center` with edges rounded by `radius` in `steps` steps on either side
    /// of the diagonal; its flat parts are divided along the three axes, so that it can be warped.
    pub(crate) fn cushion(center: Vec3A, half: Vec3A, radius: f32, steps: u32, divisions: [u32; 3]) -> Self {
        // No flat part may vanish.
        let radius = radius.min(0.98 * half.min_element());
        let inner = half - radius;
        // Along an axis: the nearest point of the flat part, and the tangent of the angle beyond.
        let stops = |axis: usize| {
            let bend = |i: u32| if i == steps { 1.0 } else { (FRAC_PI_4 * i as f32 / steps as f32).tan() };
            let flat = divisions[axis];
            let before = (0..=steps).map(|i| (-inner[axis], -bend(steps - i)));
            let middle = (1..flat).map(|i| (inner[axis] * (2.0 * i as f32 / flat as f32 - 1.0), 0.0));
            let after = (0..=steps).map(|i| (inner[axis], bend(i)));
            before.chain(middle).chain(after).collect::<Vec<_>>()
        };
        let mut form = Self::default();
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let (a, b) = if sign > 0.0 { (a, b) } else { (b, a) };
            let (columns, rows) = (stops(a), stops(b));
            let first = form.len();
            for &(y, tan_y) in &rows {
                for &(x, tan_x) in &columns {
                    let (mut core, mut normal) = (Vec3A::ZERO, Vec3A::ZERO);
                    (core[axis], core[a], core[b]) = (sign * inner[axis], x, y);
                    (normal[axis], normal[a], normal[b]) = (sign, tan_x, tan_y);
                    let normal = normal.normalize();
                    let p = core + radius * normal;
                    form.vertex(center + p, normal, [0.5 + 0.5 * p[a] / half[a], 0.5 + 0.5 * p[b] / half[b]]);
                }
            }
            form.connect(first, columns.len() as u32, rows.len() as u32);
        }
        form
    }

    /// A box with rounded edges; see [`cushion`](Self::cushion).
    pub(crate) fn rounded_box(center: Vec3A, half: Vec3A, radius: f32, steps: u32) -> Self {
        Self::cushion(center, half, radius, steps, [1; 3])
    }

    /// A surface of revolution about the vertical axis: `profile` lists (radius, height), with the outside to the right
    /// of the way up. Corners sharper than 40 degrees stay sharp.
    pub(crate) fn lathe(profile: &[[f32; 2]], segments: u32) -> Self {
        let slopes: Vec<_> = profile.windows(2).map(|p| glam::Vec2::from(p[1]) - glam::Vec2::from(p[0])).collect();
        let slope = |k: usize, neighbour: Option<usize>| {
            let own = slopes[k].normalize_or_zero();
            match neighbour.and_then(|n| slopes.get(n)).map(|s| s.normalize_or_zero()) {
                Some(other) if own.dot(other) > 0.766 => own + other,
                _ => own,
            }
        };
        let mut form = Self::default();
        for (k, ends) in profile.windows(2).enumerate() {
            let first = form.len();
            // Columns run down the profile, rows around it.
            for i in 0..=segments {
                let (sin, cos) = (TAU * (i % segments) as f32 / segments as f32).sin_cos();
                let rows = [(0, slope(k, k.checked_sub(1))), (1, slope(k, Some(k + 1)))];
                for (end, s) in rows {
                    // Rounding must not turn a pole inside out.
                    let (radius, height) = (ends[end][0].max(0.0), ends[end][1]);
                    let v = (k + end) as f32 / slopes.len() as f32;
                    let normal = Vec3A::new(s.y * cos, -s.x, s.y * sin);
                    form.vertex(
                        Vec3A::new(radius * cos, height, radius * sin),
                        normal,
                        [i as f32 / segments as f32, v],
                    );
                }
            }
            form.connect(first, 2, segments + 1);
        }
        form
    }

    /// A tube around `path` with radii that go from `radii[0]` to `radii[1]`, closed by flat ends.
    pub(crate) fn tube(path: &[Vec3A], radii: [f32; 2], sides: u32) -> Self {
        let mut form = Self::default();
        let last = path.len() - 1;
        let tangent = |i: usize| (path[(i + 1).min(last)] - path[i.saturating_sub(1)]).normalize_or(Vec3A::Y);
        let mut x = tangent(0).any_orthonormal_vector();
        for (i, &center) in path.iter().enumerate() {
            // The frame follows without twisting.
            let z = tangent(i);
            x = (x - x.dot(z) * z).normalize_or(z.any_orthonormal_vector());
            let (y, t) = (z.cross(x), i as f32 / last as f32);
            let radius = radii[0] + (radii[1] - radii[0]) * t;
            for side in 0..=sides {
                let (sin, cos) = (TAU * (side % sides) as f32 / sides as f32).sin_cos();
                let normal = cos * x + sin * y;
                form.vertex(center + radius * normal, normal, [side as f32 / sides as f32, t]);
            }
        }
        form.connect(0, sides + 1, path.len() as u32);
        let start = form.end(0, sides, path[0], -tangent(0));
        let end = form.end((last as u32) * (sides + 1), sides, path[last], tangent(last));
        form.and(start).and(end)
    }

    /// The flat end of a tube at the ring that begins at `first`, so that it closes exactly.
    fn end(&self, first: u32, sides: u32, center: Vec3A, normal: Vec3A) -> Self {
        let mut cap = Self::default();
        cap.vertex(center, normal, [0.5; 2]);
        for side in 0..=sides {
            cap.vertex(self.position(first + side), normal, [0.5; 2]);
        }
        for side in 1..=sides {
            let (a, b) = (side, side + 1);
            let outwards = (cap.position(a) - center).cross(cap.position(b) - center).dot(normal) > 0.0;
            cap.triangle(if outwards { [0, a, b] } else { [0, b, a] });
        }
        cap
    }

    /// A plate between the heights `bottom` and `top` with a convex, smooth outline in the horizontal plane: `(x, z)`,
    /// counterclockwise seen from above; its edges are rounded by `radius`.
    pub(crate) fn plate(outline: &[[f32; 2]], bottom: f32, top: f32, radius: f32, steps: u32) -> Self {
        let count = outline.len();
        let point = |i: usize| Vec3A::new(outline[i % count][0], 0.0, outline[i % count][1]);
        let normal = |i: usize| (point(i + 1) - point(i + count - 1)).cross(Vec3A::Y).normalize_or(Vec3A::X);
        let mut form = Self::default();
        // From the centre of the lower side around the edge to that of the upper one.
        let quarter = |i: u32| (FRAC_PI_2 * i as f32 / steps as f32).sin_cos();
        let lower = (0..=steps)
            .map(|i| (1.0 - quarter(i).0, bottom + radius * (1.0 - quarter(i).1), quarter(i).0, -quarter(i).1));
        let upper =
            (0..=steps).map(|i| (1.0 - quarter(i).1, top - radius * (1.0 - quarter(i).0), quarter(i).1, quarter(i).0));
        let rings: Vec<_> = lower.chain(upper).collect();
        for &(inset, height, sideways, up) in &rings {
            for i in 0..=count {
                let p = point(i) - radius * inset * normal(i) + height * Vec3A::Y;
                form.vertex(p, sideways * normal(i) + up * Vec3A::Y, [p.x, p.z]);
            }
        }
        form.connect(0, count as u32 + 1, rings.len() as u32);
        let lower = form.end(0, count as u32, bottom * Vec3A::Y, -Vec3A::Y);
        let upper = form.end((rings.len() as u32 - 1) * (count as u32 + 1), count as u32, top * Vec3A::Y, Vec3A::Y);
        form.and(lower).and(upper)
    }

    /// Connects a grid of vertices, of which the first has index `first`; outside is that of columns x rows.
    fn connect(&mut self, first: u32, columns: u32, rows: u32) {
        for j in 1..rows {
            for i in 1..columns {
                let d = first + j * columns + i;
                let a = d - columns;
                self.quadrilateral([a - 1, a, d, d - 1]);
            }
        }
    }
}

/// The polygon through `corners` with its inner corners rounded in `steps` steps, beginning `radius` before them.
pub(crate) fn rounded_path(corners: &[Vec3A], radius: f32, steps: u32) -> Vec<Vec3A> {
    let mut path = vec![corners[0]];
    for c in corners.windows(3) {
        let before = c[1] + (c[0] - c[1]).normalize() * radius.min(0.49 * (c[0] - c[1]).length());
        let after = c[1] + (c[2] - c[1]).normalize() * radius.min(0.49 * (c[2] - c[1]).length());
        path.extend((0..=steps).map(|i| {
            let t = i as f32 / steps as f32;
            before.lerp(c[1], t).lerp(c[1].lerp(after, t), t)
        }));
    }
    path.push(corners[corners.len() - 1]);
    path
}

/// The curve `|x / a|^n + |z / b|^n = 1`, counterclockwise seen from above.
pub(crate) fn superellipse(a: f32, b: f32, exponent: f32, count: u32) -> Vec<[f32; 2]> {
    let power = |x: f32| x.signum() * x.abs().powf(2.0 / exponent);
    (0..count)
        .map(|i| {
            let (sin, cos) = (-TAU * i as f32 / count as f32).sin_cos();
            [a * power(cos), b * power(sin)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use core::f32::consts::PI;

    use super::super::form::tests::{normals_agree, volume};
    use super::*;

    fn near(a: f32, b: f32, relative: f32) {
        assert!((a / b - 1.0).abs() < relative, "{a} {b}");
    }

    #[test]
    fn solids_are_closed_and_face_outwards() {
        let (center, half) = (Vec3A::new(0.3, 1.0, -2.0), Vec3A::new(1.0, 2.0, 3.0));
        let sharp = Form::cushion(center, half, 1e-4, 2, [3, 2, 1]);
        near(volume(&sharp), 48.0, 1e-3);
        // A sphere, swept over the inner box.
        let soft = Form::rounded_box(center, half, 0.5, 12);
        let steiner = |[x, y, z]: [f32; 3], r: f32| {
            x * y * z + 2.0 * r * (x * y + y * z + z * x) + PI * r * r * (x + y + z) + 4.0 / 3.0 * PI * r.powi(3)
        };
        near(volume(&soft), steiner([1.0, 3.0, 5.0], 0.5), 1e-3);
        let tube = Form::tube(&rounded_path(&[Vec3A::X, Vec3A::ZERO, Vec3A::Y * 2.0], 0.2, 8), [0.1, 0.1], 64);
        near(volume(&tube), PI * 0.01 * 2.9, 0.02);
        let ball: Vec<_> = (0..=32).map(|i| (PI * i as f32 / 32.0).sin_cos()).map(|(s, c)| [s, -c]).collect();
        let lathe = Form::lathe(&ball, 64);
        near(volume(&lathe), 4.0 / 3.0 * PI, 0.01);
        let plate = Form::plate(&superellipse(2.0, 1.0, 2.0, 200), 0.7, 0.8, 0.02, 4);
        near(volume(&plate), 2.0 * PI * 0.1, 0.02);
        for form in [sharp, soft, tube, lathe, plate] {
            assert!(normals_agree(&form));
        }
    }

    #[test]
    fn edges_of_lathes_are_smooth_only_where_flat() {
        let cylinder = Form::lathe(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 64);
        near(volume(&cylinder), PI, 0.01);
        assert!(normals_agree(&cylinder));
    }
}
