//! What a light that is not a surface must fulfil.

use super::SceneError;
use super::description::Light;
use super::emitters::similarity_scale;

/// Refuses positions, directions, angles and transforms that make no sense. (Their radiance is checked elsewhere.)
pub(super) fn check_light(index: usize, light: &Light) -> Result<(), SceneError> {
    let refuse = |kind: &str, reason: String| Err(SceneError::Light { what: format!("{kind} light {index}"), reason });
    match light {
        Light::Point { position, .. } if !position.is_finite() => refuse("point", format!("is at {position}")),
        Light::Spot { position, .. } if !position.is_finite() => refuse("spot", format!("is at {position}")),
        Light::Spot { direction, .. } if direction.try_normalize().is_none() => {
            refuse("spot", format!("points in direction {direction}"))
        }
        Light::Spot { beam_width, cutoff, .. }
            if !(cutoff.is_finite() && beam_width.is_finite() && *cutoff > 0.0 && *beam_width >= 0.0) =>
        {
            refuse("spot", format!("has a beam width of {beam_width} and a cutoff of {cutoff} radians"))
        }
        Light::Directional { direction, .. } if direction.try_normalize().is_none() => {
            refuse("directional", format!("points in direction {direction}"))
        }
        Light::Environment { to_world, .. }
            if !similarity_scale(to_world).is_some_and(|s| s > 0.0 && s.is_finite()) =>
        {
            refuse("environment", format!("has the transform {:?}, which is no rotation", to_world.matrix3))
        }
        _ => Ok(()),
    }
}
