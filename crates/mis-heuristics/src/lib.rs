//! Multiple importance sampling weights, evaluated lazily.
