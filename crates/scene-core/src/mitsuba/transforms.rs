//! `<transform>`: a chain of operations, each multiplied from the left.

use super::property::Attributes;
use super::values;
use crate::Frame;
use glam::{Affine3A, DAffine3, DMat3, DMat4, DVec3, Vec3A};

/// Smallest ratio of a determinant to the product of the column lengths at which a matrix counts as invertible.
/// Matrices come as decimal fractions of single precision numbers.
const SMALLEST_RELATIVE_DETERMINANT: f64 = 1e-9;

/// One operation.
///
/// # Errors
/// A message without place.
pub(super) fn operation(step: &Attributes) -> Result<DAffine3, String> {
    let required = |name: &str| step.get(name).ok_or_else(|| format!("<{}> needs `{name}`", step.tag));
    let point = |text: &str| values::triple(text).map(DVec3::from);
    match step.tag.as_str() {
        "translate" => Ok(DAffine3::from_translation(step.vector(0.0)?.into())),
        "scale" => Ok(DAffine3::from_scale(step.vector(1.0)?.into())),
        "rotate" => {
            let axis =
                DVec3::from(step.vector(0.0)?).try_normalize().ok_or("the axis of a rotation must not be zero")?;
            Ok(DAffine3::from_axis_angle(axis, values::float(required("angle")?)?.to_radians()))
        }
        "lookat" | "lookAt" => {
            let up = step.get("up").map(point).transpose()?;
            look_at(point(required("origin")?)?, point(required("target")?)?, up)
        }
        "matrix" => matrix(&values::floats(required("value")?, 16)?),
        other => Err(format!("unexpected <{other}> inside <transform>")),
    }
}

/// The camera at `origin` that looks along +z to `target`, with +y up and +x to the left.
fn look_at(origin: DVec3, target: DVec3, up: Option<DVec3>) -> Result<DAffine3, String> {
    let direction = (target - origin).try_normalize().ok_or("`origin` and `target` of <lookat> are the same point")?;
    let up = match up {
        Some(up) => up,
        None => Frame::from_z(Vec3A::from(direction.as_vec3())).x.as_dvec3(),
    };
    let left = up.cross(direction);
    if left.length() <= 1e-9 * up.length() {
        return Err("`up` of <lookat> is zero or parallel to the view direction".into());
    }
    let left = left.normalize();
    Ok(DAffine3::from_mat3_translation(DMat3::from_cols(left, direction.cross(left), direction), origin))
}

/// Nine or sixteen numbers, row by row.
fn matrix(values: &[f64]) -> Result<DAffine3, String> {
    match *values {
        [a, b, c, d, e, f, g, h, i] => {
            Ok(DAffine3::from_mat3(DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]).transpose()))
        }
        _ => {
            let rows: &[f64; 16] =
                values.try_into().map_err(|_| format!("a matrix has 9 or 16 numbers, not {}", values.len()))?;
            if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
                return Err("the last row of a matrix must be 0 0 0 1: projective transforms are not supported".into());
            }
            Ok(DAffine3::from_mat4(DMat4::from_cols_array(rows).transpose()))
        }
    }
}

/// The transform in single precision, if it is finite there and has an inverse.
pub(super) fn invertible(transform: &DAffine3) -> Option<Affine3A> {
    let linear = transform.matrix3;
    let lengths = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
    let single = Affine3A::from_cols_array(&transform.to_cols_array().map(|value| value as f32));
    let usable = single.is_finite()
        && single.inverse().is_finite()
        && linear.determinant().abs() > SMALLEST_RELATIVE_DETERMINANT * lengths;
    usable.then_some(single)
}

/// Whether a transform keeps angles: rotations, reflections, translations, uniform scaling. Returns the scale.
pub(super) fn similarity_scale(transform: &Affine3A) -> Option<f32> {
    let m = transform.matrix3;
    let scale = m.determinant().abs().cbrt();
    let tolerance = 1e-3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c| c / scale);
    let close = columns.iter().all(|c| (c.length() - 1.0).abs() < tolerance)
        && [(0, 1), (0, 2), (1, 2)].iter().all(|&(i, j)| columns[i].dot(columns[j]).abs() < tolerance);
    (close && scale.is_finite()).then_some(scale)
}
