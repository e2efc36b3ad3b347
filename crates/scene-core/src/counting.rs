//! Exact counts of the rays that an estimator traces.

use core::cell::Cell;
use core::ops::{Add, AddAssign};

use glam::Vec3A;

use crate::ray::Ray;
use crate::traits::{EmitterId, Scene, Sharpness};

/// Numbers of rays traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Rays that asked for the closest hit.
    pub closest_hit: u64,
    /// Rays that asked whether there is any hit.
    pub visibility: u64,
}

impl RayCounts {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.closest_hit + self.visibility
    }
}

impl Add for RayCounts {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { closest_hit: self.closest_hit + other.closest_hit, visibility: self.visibility + other.visibility }
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl core::iter::Sum for RayCounts {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::default(), Add::add)
    }
}

/// A scene that counts the rays traced through it.
///
/// Each task wraps the shared scene for itself and returns its counts, whose sum does not depend on how the tasks were
/// scheduled: no atomics, and exact at any number of threads.
#[derive(Debug)]
pub struct Counting<'a, S> {
    scene: &'a S,
    closest_hit: Cell<u64>,
    visibility: Cell<u64>,
}

impl<'a, S> Counting<'a, S> {
    /// Counts from zero.
    pub fn new(scene: &'a S) -> Self {
        Self { scene, closest_hit: Cell::new(0), visibility: Cell::new(0) }
    }

    /// The rays so far.
    pub fn counts(&self) -> RayCounts {
        RayCounts { closest_hit: self.closest_hit.get(), visibility: self.visibility.get() }
    }
}

impl<'a, S: Scene> Scene for Counting<'a, S> {
    type Spectrum = S::Spectrum;
    /// Borrows from the scene, not from the counter: vertices may outlive the task that found them.
    type Vertex<'s>
        = S::Vertex<'a>
    where
        Self: 's;
    type Emitter = S::Emitter;
    type Sensor = S::Sensor;

    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<S::Vertex<'a>> {
        self.closest_hit.set(self.closest_hit.get() + 1);
        self.scene.intersect(ray)
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.visibility.set(self.visibility.get() + 1);
        self.scene.occluded(ray)
    }

    #[inline]
    fn emitters(&self) -> &[S::Emitter] {
        self.scene.emitters()
    }

    #[inline]
    fn environment(&self) -> Option<EmitterId> {
        self.scene.environment()
    }

    #[inline]
    fn sensor(&self) -> &S::Sensor {
        self.scene.sensor()
    }

    fn bounding_sphere(&self) -> (Vec3A, f32) {
        self.scene.bounding_sphere()
    }

    fn sharpness(&self) -> Sharpness {
        self.scene.sharpness()
    }
}
