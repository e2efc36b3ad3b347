//! Renderer-neutral scene traits, and a reference scene that implements them.
