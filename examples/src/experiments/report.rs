//! The contents of `report.json`.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What an experiment found, under the very keys of `report.json`. Displays as two tables.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Name of the experiment.
    pub experiment: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether it was the quick form.
    pub quick: bool,
    /// What was measured.
    pub rows: Vec<Row>,
    /// What follows.
    pub claims: Vec<Claim>,
}

/// One setting of an experiment. Numbers are means over its trials, each of which is one rendering.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Name of the estimator.
    pub estimator: String,
    /// What sets this row apart from others: parameters by name.
    pub params: BTreeMap<String, Value>,
    /// Wall time of a rendering, in seconds.
    pub seconds: f64,
    /// Rays of a rendering, closest hits and visibility, rounded.
    pub rays: u64,
    /// Variance of a pixel's value from one rendering to another; mean over pixels and channels. Infinite for a single rendering, which
    /// is `null` in the file.
    #[serde(deserialize_with = "infinite_if_null")]
    pub variance: f64,
    /// Relative mean squared error against the reference.
    pub rel_mse: f64,
}

/// A claim, and whether it holds here.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Its name.
    pub id: String,
    /// What the source says: a number, or a bound such as `> 1`.
    pub paper: String,
    /// What was measured.
    pub measured: f64,
    /// The interval that contains the true value with a probability of 95 %.
    pub ci95: [f64; 2],
    /// Whether the claim holds.
    pub holds: bool,
    /// Why it does not, where that is known.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

impl Claim {
    /// Whether anything is claimed at all: other numbers are only measured.
    pub fn is_claimed(&self) -> bool {
        self.paper != "-"
    }

    /// With the reason why it does not hold, if it does not.
    #[must_use]
    pub fn because(mut self, reason: &str) -> Self {
        if !self.holds {
            reason.clone_into(&mut self.note);
        }
        self
    }
}

/// JSON has no infinity.
fn infinite_if_null<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

impl Row {
    /// A row that holds no measurement yet, with its parameters by name.
    pub fn new<const N: usize>(scene: &str, estimator: &str, params: [(&str, Value); N]) -> Self {
        let params = params.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        Self { scene: scene.to_owned(), estimator: estimator.to_owned(), params, ..Self::default() }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let form = if self.quick { ", quick form" } else { "" };
        writeln!(f, "{}, seed {}{form}\n", self.experiment, self.seed)?;
        let describe = |row: &Row| {
            let params = row.params.iter().map(|(name, value)| match value {
                Value::String(text) => format!("{name} {text}"),
                other => format!("{name} {other}"),
            });
            let words: Vec<String> = [row.scene.clone(), row.estimator.clone()].into_iter().chain(params).collect();
            words.join(", ")
        };
        let labels: Vec<String> = self.rows.iter().map(describe).collect();
        let width = labels.iter().map(String::len).max().unwrap_or(0);
        writeln!(f, "{:<width$} {:>9} {:>10} {:>10} {:>10}", "", "seconds", "rays", "variance", "rel. MSE")?;
        for (label, row) in labels.iter().zip(&self.rows) {
            let rays = row.rays as f64;
            writeln!(
                f,
                "{label:<width$} {:>9.3} {rays:>10.3e} {:>10.3e} {:>10.3e}",
                row.seconds, row.variance, row.rel_mse
            )?;
        }
        let width = self.claims.iter().map(|claim| claim.id.len()).max().unwrap_or(0);
        let paper = self.claims.iter().map(|claim| claim.paper.len()).max().unwrap_or(0).max("claimed".len());
        if !self.claims.is_empty() {
            writeln!(f, "\n{:<width$} {:>paper$} {:>9} {:>19}", "", "claimed", "measured", "95 % interval")?;
        }
        for claim in &self.claims {
            let [low, high] = claim.ci95;
            let interval = format!("{low:.4} .. {high:.4}");
            let verdict = match (claim.is_claimed(), claim.holds) {
                (false, _) => "measured",
                (true, true) => "holds",
                (true, false) => "does not hold",
            };
            writeln!(
                f,
                "{:<width$} {:>paper$} {:>9.4} {interval:>19}  {verdict}",
                claim.id, claim.paper, claim.measured
            )?;
            if !claim.note.is_empty() {
                writeln!(f, "{:<width$} {}", "", claim.note)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_written_and_read() {
        let claim = Claim { holds: false, ..Claim::default() }.because("shadow rays are cheap");
        let json = serde_json::to_value(&claim).unwrap();
        assert_eq!(json["note"], "shadow rays are cheap");
        assert_eq!(serde_json::from_value::<Claim>(json).unwrap(), claim);
        let report = Report { claims: vec![claim], ..Report::default() };
        assert!(report.to_string().contains("shadow rays are cheap"));
    }

    /// The format that other programs read.
    #[test]
    fn the_keys_are_the_documented_ones() {
        let row = Row::new("cornell-box", "path", [("spp", 64.into()), ("sampler", "sobol".into())]);
        let claim = Claim {
            id: "c".into(),
            paper: "0.70".into(),
            measured: 0.5,
            ci95: [0.25, 0.75],
            holds: true,
            ..Claim::default()
        };
        let report = Report { experiment: "e".into(), rows: vec![row], claims: vec![claim], ..Report::default() };
        let json = serde_json::to_value(&report).unwrap();
        let expected = serde_json::json!({
            "experiment": "e", "seed": 0, "quick": false,
            "rows": [{
                "scene": "cornell-box", "estimator": "path", "params": { "spp": 64, "sampler": "sobol" },
                "seconds": 0.0, "rays": 0, "variance": 0.0, "rel_mse": 0.0
            }],
            "claims": [{ "id": "c", "paper": "0.70", "measured": 0.5, "ci95": [0.25, 0.75], "holds": true }]
        });
        assert_eq!(json, expected);
        assert_eq!(serde_json::from_value::<Report>(json).unwrap(), report);
        let single = Row { variance: f64::INFINITY, ..report.rows[0].clone() };
        let json = serde_json::to_string(&single).unwrap();
        assert!(json.contains(r#""variance":null"#));
        assert_eq!(serde_json::from_str::<Row>(&json).unwrap(), single);
        let text = report.to_string();
        assert!(text.contains("cornell-box, path, sampler sobol, spp 64") && text.contains("0.2500 .. 0.7500  holds"));
    }
}
