//! Renderers composed from the Lichtwerk crates.
