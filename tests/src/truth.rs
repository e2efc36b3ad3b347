//! Estimators against an image that is known to be right, in a quick and a long form.
#![allow(clippy::print_stdout)]

use estimator_checks::{BatchMeans, Suite};
use lichtwerk::program::RenderSettings;
use scene_core::ReferenceScene;

use crate::{Effort, block_means};

/// A scene with an image that is known to be right, such as that by path tracing.
#[derive(Debug)]
pub struct Truth {
    suite: &'static Suite,
    test: String,
    /// The scene.
    pub scene: ReferenceScene,
    /// Its image.
    pub means: BatchMeans,
    /// With what effort that was rendered, and others will be.
    pub effort: Effort,
}

impl Truth {
    /// Renders the scene with settings that are known to be right. All seeds follow from the name of the test.
    ///
    /// # Panics
    /// If it cannot be rendered.
    pub fn new(
        suite: &'static Suite,
        test: &str,
        scene: ReferenceScene,
        settings: &RenderSettings,
        effort: Effort,
    ) -> Self {
        let means = block_means(&format!("{test}: path"), &scene, settings, effort);
        Self { suite, test: test.to_owned(), scene, means, effort }
    }

    /// That other settings give the same image.
    ///
    /// # Panics
    /// If they do not.
    pub fn equals(&self, what: &str, settings: &RenderSettings) {
        let name = format!("{}: {what}", self.test);
        println!("{}", self.means.agrees_with(self.suite.check(&name), &self.render(&name, settings)).expect_pass());
    }

    /// That other settings, known to be wrong, do not.
    ///
    /// # Panics
    /// If they do.
    pub fn rejects(&self, what: &str, settings: &RenderSettings) {
        let name = format!("{}: {what}", self.test);
        println!("{}", self.means.agrees_with(self.suite.twin(&name), &self.render(&name, settings)).expect_reject());
    }

    fn render(&self, name: &str, settings: &RenderSettings) -> BatchMeans {
        block_means(name, &self.scene, settings, self.effort)
    }
}

/// Tests in a quick and a long form: functions of their name and of the [`Effort`].
///
/// `both_forms! { name_of_the_test => |test, effort| ..; .. }`
#[macro_export]
macro_rules! both_forms {
    ($($name:ident => $test:expr;)*) => {
        mod quick {
            use super::*;
            $(#[test]
            fn $name() {
                $test(concat!(stringify!($name)), $crate::Effort::QUICK);
            })*
        }
        mod long {
            use super::*;
            $(#[test]
            #[ignore = "long form: cargo test --release --workspace -- --ignored"]
            fn $name() {
                $test(concat!(stringify!($name), " (long)"), $crate::Effort::LONG);
            })*
        }
    };
}
