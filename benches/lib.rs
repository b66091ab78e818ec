//! Holds the benches; see `integrate.rs`.
