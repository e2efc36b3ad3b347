//! Densities of all techniques of a path.

use std::cell::OnceCell;

use glam::Vec3A;
use mis_heuristics::Densities;
use scene_core::{Emitter, EmitterId, Scene, SurfacePoint, TransportMode, Vertex};
use smallvec::SmallVec;

use super::density::{by_area, through_disk};
use super::light_paths::backward;
use super::path::{CENTRE, Joint, Path, Place, Samples};
use super::techniques::PathTechniques;
use crate::lights::LightKind;

/// Densities of some of the techniques of one path.
type Side = SmallVec<[f64; 12]>;

/// Densities over that of the technique that generated the path.
pub(super) struct PathDensities<'a, P> {
    path: &'a P,
    technique: usize,
    techniques: usize,
    fewer: OnceCell<Side>,
    more: OnceCell<Side>,
}

impl<'a, 'b, S, X, V> PathDensities<'a, Path<'b, S, X, V>>
where
    S: Scene,
    X: Vertex,
    V: Vertex,
{
    /// Nothing is computed yet.
    #[inline]
    pub(super) fn new(path: &'a Path<'b, S, X, V>) -> Self {
        let (technique, techniques) = (path.technique, path.techniques());
        Self { path, technique, techniques, fewer: OnceCell::new(), more: OnceCell::new() }
    }
}

impl<S, X, V> Densities<f64> for PathDensities<'_, Path<'_, S, X, V>>
where
    S: Scene,
    X: Vertex,
    V: Vertex,
{
    #[inline]
    fn len(&self) -> usize {
        self.techniques
    }

    #[inline]
    fn density(&self, technique: usize) -> f64 {
        if technique < self.technique {
            self.fewer.get_or_init(|| self.path.fewer_light_vertices())[self.technique - 1 - technique]
        } else if technique > self.technique {
            self.more.get_or_init(|| self.path.more_light_vertices())[technique - self.technique - 1]
        } else {
            1.0
        }
    }
}

/// Samples of the techniques of one path.
struct Counts {
    hit: f64,
    first: f64,
    others: f64,
    lens: f64,
    segments: usize,
}

impl Counts {
    #[inline]
    fn of(&self, technique: usize) -> f64 {
        match technique {
            0 => self.hit,
            1 => self.first,
            _ if technique == self.segments => self.lens,
            _ => self.others,
        }
    }
}

impl<S, X, V> Path<'_, S, X, V>
where
    S: Scene,
    X: Vertex,
    V: Vertex,
{
    /// Samples of the techniques, times the probability of a Dirac emitter.
    #[inline]
    fn counts(&self) -> Counts {
        let Samples { per_eye_path, to_lens } = self.samples;
        let mut counts = Counts {
            hit: 1.0,
            first: per_eye_path,
            others: per_eye_path,
            lens: to_lens.unwrap_or(0.0),
            segments: self.segments(),
        };
        if let Some(light) = self.light()
            && self.start(light).at.is_delta()
        {
            let probability = self.start(light).forward;
            counts.hit = 0.0;
            counts.first = if self.lights.deltas_once() { 1.0 } else { counts.first * probability };
            counts.others *= probability;
            counts.lens *= probability;
        }
        counts
    }

    /// Densities with which an eye path would generate the last two light vertices.
    fn light_end(&self) -> [f64; 2] {
        let (light, towards_eye, last) = match &self.joint {
            Joint::Hit { .. } => return [0.0; 2],
            Joint::Connection { vertex, light, wi } => {
                let pdf = vertex.pdf_solid_angle(*wi, TransportMode::Radiance);
                let last = match self.lights.lights().as_slice()[*light].point() {
                    Some(point) => by_area(pdf, vertex.point().position, point),
                    // Only light that is distant, for Dirac emitters cannot be hit.
                    None => f64::from(pdf),
                };
                (*light, -*wi, last)
            }
            Joint::Lens { light, wi } => {
                let point = self.lights.lights().as_slice()[*light].point();
                let unit = point.map_or(0.0, |point| by_area(1.0, self.lens.origin, point));
                (*light, *wi, unit * self.lens.density)
            }
        };
        let LightKind::Surface(vertex) = &self.lights.lights().as_slice()[light].kind else { return [last, 0.0] };
        let pdf = backward(vertex, towards_eye, TransportMode::Radiance);
        let from = vertex.point().position;
        let before_last = match self.before(light) {
            Place::Point(point) => by_area(pdf, from, point),
            Place::Space(_) | Place::Infinity(_) => f64::from(pdf),
        };
        [last, before_last]
    }

    /// Densities with which a light path would generate the last two eye vertices.
    fn eye_end(&self) -> [f64; 2] {
        let before = self.eye.len().checked_sub(2).and_then(|k| self.eye[k].point.as_ref());
        match &self.joint {
            Joint::Lens { .. } => [0.0; 2],
            Joint::Hit { vertex, towards_eye, emitter, probability } => {
                let source = &self.scene.emitters()[emitter.index()];
                let (area, solid_angle) = source.pdf_emission(vertex.map(Vertex::point), *towards_eye);
                let choice = f64::from(*probability);
                match vertex {
                    Some(vertex) => {
                        let from = vertex.point().position;
                        [choice * f64::from(area), before.map_or(0.0, |point| by_area(solid_angle, from, point))]
                    }
                    None => [
                        choice * f64::from(solid_angle),
                        before.map_or(0.0, |point| through_disk(area, *towards_eye, point)),
                    ],
                }
            }
            Joint::Connection { vertex, light, wi } => {
                let point = vertex.point();
                let emitter = |id: EmitterId| &self.scene.emitters()[id.index()];
                let last = match &self.lights.lights().as_slice()[*light].kind {
                    LightKind::Surface(y) => {
                        by_area(y.pdf_solid_angle(-*wi, TransportMode::Importance), y.point().position, point)
                    }
                    LightKind::Emission { emitter: id, point: y } => {
                        by_area(emitter(*id).pdf_emission(Some(y), -*wi).1, y.position, point)
                    }
                    LightKind::Distant { emitter: id, .. } => {
                        through_disk(emitter(*id).pdf_emission(None, -*wi).0, *wi, point)
                    }
                    LightKind::Delta { emitter: id } => delta_density(emitter(*id), point, *wi),
                };
                let before_last = before.map_or(0.0, |before| {
                    by_area(backward(*vertex, *wi, TransportMode::Importance), point.position, before)
                });
                [last, before_last]
            }
        }
    }

    /// Densities of the techniques with fewer light vertices than this one, the next first.
    fn fewer_light_vertices(&self) -> Side {
        let mut densities = Side::new();
        let Some(light) = self.light() else { return densities };
        let (end, counts) = (self.light_end(), self.counts());
        let (start, last) = (self.start(light), self.technique - 1);
        let mut product = 1.0 / counts.of(self.technique);
        let mut is_specular = false;
        for j in (1..=last).rev() {
            // y_j goes over to the eye path.
            let (index, before_last) = (light + j - last, last - j);
            let vertex = self.lights.vertex(index);
            product *= if before_last < 2 { end[before_last] / vertex.forward } else { vertex.ratio };
            let next_is_specular = j > 1 && self.lights.vertex(index - 1).is_specular;
            let is_possible = !is_specular && !next_is_specular;
            densities.push(if is_possible { product * counts.of(j) } else { 0.0 });
            is_specular = next_is_specular;
        }
        product *= if last < 2 { end[last] / start.forward } else { start.ratio };
        densities.push(if start.at.is_delta() { 0.0 } else { product * counts.hit });
        densities
    }

    /// Densities of the techniques with more light vertices than this one, the next first.
    fn more_light_vertices(&self) -> Side {
        let mut densities = Side::new();
        let techniques = self.techniques();
        if self.technique + 1 >= techniques {
            return densities;
        }
        let (end, counts) = (self.eye_end(), self.counts());
        let mut product = 1.0 / counts.of(self.technique);
        let mut is_specular = false;
        let longest = self.lights.max_length() as usize;
        for i in self.technique + 1..techniques {
            // x_k goes over to the light path.
            let k = counts.segments + 1 - i;
            let (vertex, before_last) = (&self.eye[k - 1], self.eye.len() - k);
            product *= if before_last < 2 { end[before_last] / vertex.forward } else { vertex.ratio };
            let (next_is_specular, is_seen) = match k {
                1 => (false, self.lens.density > 0.0),
                _ => (self.eye[k - 2].is_specular, true),
            };
            let is_possible = !is_specular && !next_is_specular && is_seen && i <= longest + 1;
            densities.push(if is_possible { product * counts.of(i) } else { 0.0 });
            is_specular = next_is_specular;
        }
        densities
    }
}

/// Density by area with which light of a Dirac emitter arrives at `to`, in direction `-wi`.
fn delta_density<E: Emitter>(emitter: &E, to: &SurfacePoint, wi: Vec3A) -> f64 {
    if emitter.is_infinite() {
        return through_disk(emitter.pdf_emission(None, -wi).0, wi, to);
    }
    let Some((at, _)) = emitter.sample_direct(to.position, CENTRE).and_then(|direct| direct.at) else { return 0.0 };
    by_area(emitter.pdf_emission(Some(&at), -wi).1, at.position, to)
}
