//! Tests of the crate as its users see it, in one binary.

/// Broken study files: each with the message it must give.
mod bad_studies;
/// Independent second implementations of the models, and printed golden values.
mod second;
